/* Merged half-edges that are no candidates of each other, coded as explicit pairs. */
#include "coder.h"
#include "graphs.h"
#include "hidden_edges.h"

/* Bounds on the work at an edge with many triangles: half-edges that are looked at, and half-edges
   that fit. */
enum { SCANNED = 64, FITTING = 16 };

/* Half-edges by their ends, with lists of those that are not merged, ascending. */
typedef struct {
    const int64_t *order, *group, *across, *bounds;
    int64_t *first, *after, *before;
} pair_lists;

/* Whether `order` has the half-edges of each group, ascending. */
static int are_grouped(const pair_lists *l, int64_t groups)
{
    int good = 1;
    for (int64_t i = 0; i < groups; i++)
        for (int64_t at = l->bounds[i]; at < l->bounds[i + 1]; at++)
            good &= l->group[l->order[at]] == i &&
                    (at == l->bounds[i] || l->order[at - 1] < l->order[at]);
    return good;
}

static void fill_lists(const pair_lists *l, const int64_t *merged, int64_t groups)
{
    for (int64_t i = 0; i < groups; i++) {
        int64_t last = -1;
        l->first[i] = -1;
        for (int64_t at = l->bounds[i]; at < l->bounds[i + 1]; at++) {
            const int64_t h = l->order[at];
            l->before[h] = l->after[h] = -1;
            if (merged[h] >= 0)
                continue;
            l->before[h] = last;
            if (last < 0)
                l->first[i] = h;
            else
                l->after[last] = h;
            last = h;
        }
    }
}

/* Take a half-edge out of its list, unless the list begins beyond it already. */
static void take_out(const pair_lists *l, int64_t h)
{
    const int64_t group = l->group[h];
    if (l->first[group] == h)
        l->first[group] = l->after[h];
    if (l->before[h] >= 0)
        l->after[l->before[h]] = l->after[h];
    if (l->after[h] >= 0)
        l->before[l->after[h]] = l->before[h];
}

/* Find the half-edges in a list from g on that polygon r may merge with; return how many. */
static int64_t find_fitting(dm_polygons *p, const pair_lists *l, int64_t g, int64_t r, int64_t most,
                            int64_t *found)
{
    int64_t number = 0;
    for (int i = 0; i < SCANNED && g >= 0 && number < FITTING; i++) {
        const int64_t s = dm_root_of(p, g / 3);
        if (r != s && p->size[r] + p->size[s] - 2 <= most)
            found[number++] = g;
        g = l->after[g];
    }
    return number;
}

/* Code which of the half-edges found is meant, one bit for each; -1 for none. */
static int64_t choose(dm_coder *c, dm_polygons *p, int64_t h, int64_t actual, const int64_t *found,
                      int64_t number)
{
    for (int64_t i = 0; i < number; i++) {
        const int64_t y = dm_corners_class(p->size[dm_root_of(p, found[i] / 3)]);
        const int64_t at[] = {CHOOSE_BY_RANK + 4 * dm_min(i, 7) + dm_min(number - 1 - i, 3),
                              CHOOSE_BY_SIZE + 9 * y + 3 * (h % 3) + found[i] % 3};
        if (dm_code_bit(c, found[i] == actual, DM_CHOOSE_MIXER, at))
            return found[i];
    }
    return -1;
}

/* Code a half-edge of a group by its rank. */
static int64_t code_any(dm_coder *c, const pair_lists *l, int64_t group, int64_t actual)
{
    const int64_t first = l->bounds[group], count = l->bounds[group + 1] - first;
    int64_t rank = 0;
    for (int64_t end = c->decoding ? 0 : count - 1; rank < end;) {
        const int64_t middle = (rank + end) / 2;
        if (l->order[first + middle] < actual)
            rank = middle + 1;
        else
            end = middle;
    }
    return l->order[first + dm_code_below(c, rank, count)];
}

/* Code the explicit pairs, of which there have to be `total`.

   pairs (3 faces,): the half-edge that each is to be merged with, -1 for none; ignored when
   decoding. candidate, merged, parent, size: see `dm_code_hidden`; the last three are updated. order
   (3 faces,): half-edges by start, end and index: group i has those from bounds[i] on. group
   (3 faces,), of each half-edge. across (groups,): the group of the half-edges that run back, -1 for
   none. Scratch: first (groups,), after and before (3 faces,). */
int dm_code_explicit_pairs(dm_coder *c, const int64_t *candidate, int64_t faces,
                           const int64_t *pairs, int64_t *merged, int64_t *parent, int64_t *size,
                           int64_t most, int64_t total, const int64_t *order, const int64_t *group,
                           const int64_t *across, const int64_t *bounds, int64_t groups,
                           int64_t *first, int64_t *after, int64_t *before)
{
    const int64_t halfedges = 3 * faces;
    const pair_lists lists = {order, group, across, bounds, first, after, before};
    if (!dm_has_memory(c, HIDDEN_SLOTS, DM_HIDDEN_MIXERS) ||
        !dm_are_bounds(bounds, groups, halfedges) || !dm_all_in(order, halfedges, 0, halfedges) ||
        !dm_all_in(group, halfedges, 0, groups) || !dm_all_in(across, groups, -1, groups) ||
        !dm_all_in(merged, halfedges, -1, halfedges) || !dm_all_in(parent, faces, 0, faces) ||
        !are_grouped(&lists, groups))
        return DM_INVALID;
    dm_polygons p = {faces, merged, parent, size};
    fill_lists(&lists, merged, groups);
    int64_t history = 0, found[FITTING];
    for (int64_t h = 0; h < halfedges; h++) {
        const int64_t r = dm_root_of(&p, h / 3), other = across[group[h]];
        if (total == 0 || merged[h] >= 0 || size[r] >= most || other < 0)
            continue;
        while (first[other] >= 0 && first[other] <= h)
            first[other] = after[first[other]];
        if (first[other] < 0)
            continue;
        const int64_t actual = c->decoding ? -1 : pairs[h];
        const int64_t number = find_fitting(&p, &lists, first[other], r, most, found);
        const int64_t x = dm_corners_class(size[r]), rich = dm_min(number, 3);
        const int64_t at[] = {
            PAIR_BY_SIZE + (4 * x + rich) * 3 + h % 3,
            PAIR_BY_HISTORY + 16 * x + history,
            PAIR_BY_CANDIDATE + (4 * x + rich) * 2 + (candidate[h] < 0),
        };
        const int64_t bit = dm_code_bit(c, actual >= 0, DM_PAIR_MIXER, at);
        history = (2 * history + bit) & 15;
        if (!bit)
            continue;
        int64_t g = choose(c, &p, h, actual, found, number);
        if (g < 0) {
            g = code_any(c, &lists, other, actual);
            const int64_t s = dm_root_of(&p, g / 3);
            if (g <= h || merged[g] >= 0 || r == s || size[r] + size[s] - 2 > most)
                return DM_CORRUPT;
            for (int64_t k = 0; k < number; k++)
                if (found[k] == g)
                    return DM_CORRUPT;
        }
        take_out(&lists, h);
        take_out(&lists, g);
        dm_join(&p, h, g, r, dm_root_of(&p, g / 3));
        total--;
    }
    return total == 0 ? DM_OK : DM_CORRUPT;
}
