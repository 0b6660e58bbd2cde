/* Corners of a complex, point by point, and their wedges; see `src/deltamesh/_shape/wedges.py`. */
#include <string.h>

#include "fuzz.h"

/* The kinds of corners, from `src/core/wedges.h`. */
enum { ACROSS, FAN, REPEAT, DEGENERATE };

static void exchange(int64_t *row)
{
    const int64_t b = row[1];
    row[1] = row[2], row[2] = b;
}

static int64_t *in_order(const int64_t *numbers, const int64_t *order, int64_t count)
{
    int64_t *const sorted = take_numbers(count);
    for (int64_t i = 0; i < count; i++)
        sorted[i] = numbers[order[i]];
    return sorted;
}

corner_rings corners_of(const structure *s)
{
    const int64_t own = 3 * s->m, again = 3 * s->repeats, length = 3 * s->triangles;
    corner_rings r = {.length = length, .rank = take_numbers(length), .of = take_numbers(length)};
    int64_t *const repeats = take_numbers(again);
    for (int64_t h = 0; h < length; h++)
        r.rank[h] = h;
    for (int64_t h = 0; h < own; h++)
        r.of[h] = s->points[s->faces[h]];
    for (int64_t f = 0; f < s->m; f++)
        if (s->reversed[f])
            exchange(r.rank + 3 * f);
    for (int64_t k = 0; k < s->repeats; k++) {
        memcpy(repeats + 3 * k, r.rank + 3 * s->repeated[k], 3 * sizeof(*repeats));
        if (s->against[k])
            exchange(repeats + 3 * k);
    }
    for (int64_t k = 0; k < again; k++)
        r.of[own + k] = r.of[repeats[k]];
    for (int64_t k = 0; k < s->degenerates; k++) {
        int64_t *const of = r.of + own + again + 3 * k;
        of[0] = of[1] = s->degenerate[2 * k], of[2] = s->degenerate[2 * k + 1];
    }

    int64_t *const ring = take_numbers(own), *const spoke = take_numbers(own);
    int64_t *const closing = take_numbers(own), *const extra = take_numbers(length - own);
    int64_t *const none = take_numbers(length - own);
    check(dm_fill_rings(s->opposite, s->faces, s->m, order_of(s->points, s->n), s->n, ring, spoke,
                        closing, take_numbers(s->n)), "dm_fill_rings");
    for (int64_t k = 0; k < length - own; k++)
        extra[k] = own + k, none[k] = -1;
    const int64_t *const rings = joined(ring, own, extra, length - own);
    const int64_t *const spokes = joined(spoke, own, none, length - own);
    const int64_t *const closed = joined(closing, own, none, length - own);
    int64_t *const kind = take_numbers(length), *const key = take_numbers(length);
    for (int64_t i = 0; i < length; i++) {
        kind[i] = i >= own + again ? DEGENERATE : i >= own ? REPEAT : spokes[i] < 0 ? FAN : ACROSS;
        key[i] = r.of[rings[i]];
    }
    const int64_t *const order = order_of(key, length);
    r.ring = in_order(rings, order, length), r.spoke = in_order(spokes, order, length);
    r.closing = in_order(closed, order, length), r.kind = in_order(kind, order, length);
    r.bounds = starts_of(r.of, length, s->count);
    r.like = take_numbers(length);
    for (int64_t p = 0; p < s->count; p++)
        for (int64_t i = r.bounds[p]; i < r.bounds[p + 1]; i++)
            r.like[i] = i > r.bounds[p] ? r.ring[i - 1] : -1;
    for (int64_t i = 0; i < length; i++)
        if (r.kind[i] == REPEAT)
            r.like[i] = repeats[r.ring[i] - own];
    return r;
}

int64_t decode_wedges(dm_coder *c, const structure *s, const corner_rings *r, int64_t *wedges)
{
    int64_t *const ranked = take_zeros(r->length), total = 0;
    check(dm_code_wedges(c, s->opposite, 3 * s->m, r->bounds, s->count, r->ring, r->spoke,
                         r->closing, r->like, r->kind, r->length, ranked, 0,
                         take_numbers(3 * s->m), take_numbers(0), take_numbers(0),
                         take_numbers(r->length), take_numbers(r->length), &total),
          "dm_code_wedges");
    for (int64_t i = 0; i < r->length; i++)
        wedges[i] = ranked[r->rank[i]];
    insist(largest_of(wedges, r->length) + 1 == total, "wedges without gaps");
    return total;
}
