/* Graphs and parallelograms; see `src/deltamesh/_graph`. */
#include <string.h>

#include "fuzz.h"

int64_t after_in_face(int64_t h) { return h % 3 == 2 ? h - 2 : h + 1; }

static int64_t least(int64_t a, int64_t b) { return a < b ? a : b; }
static int64_t most(int64_t a, int64_t b) { return a > b ? a : b; }

graph graph_of_pairs(const int64_t *a, const int64_t *b, int64_t count, int64_t n)
{
    graph g = {n, 0, take_numbers(n + 1), take_numbers(2 * count)};
    int32_t *const indptr = take_shorts(n + 1), *const indices = take_shorts(2 * count);
    check(dm_gather_neighbours(a, b, count, n, indptr, indices, &g.entries, take_shorts(2 * count),
                               take_shorts(n)),
          "dm_gather_neighbours");
    for (int64_t v = 0; v <= n; v++)
        g.indptr[v] = indptr[v];
    for (int64_t k = 0; k < g.entries; k++)
        g.indices[k] = indices[k];
    return g;
}

static int64_t *ends_of(const int64_t *faces, int64_t m)
{
    int64_t *const ends = take_numbers(3 * m);
    for (int64_t h = 0; h < 3 * m; h++)
        ends[h] = faces[after_in_face(h)];
    return ends;
}

graph graph_of_faces(const int64_t *faces, int64_t m, int64_t n)
{
    return graph_of_pairs(faces, ends_of(faces, m), 3 * m, n);
}

int64_t *opposite_of(const int64_t *faces, int64_t m)
{
    const int64_t n = largest_of(faces, 3 * m) + 1, *const ends = ends_of(faces, m);
    int64_t *const keys = take_numbers(3 * m), *const opposite = take_numbers(3 * m);
    for (int64_t h = 0; h < 3 * m; h++) {
        keys[h] = least(faces[h], ends[h]) * n + most(faces[h], ends[h]);
        opposite[h] = -1;
    }
    const int64_t *const order = order_of(keys, 3 * m);
    for (int64_t k = 0; k + 1 < 3 * m; k++) {
        if (keys[order[k]] == keys[order[k + 1]] &&
            (k == 0 || keys[order[k]] != keys[order[k - 1]])) {
            opposite[order[k]] = order[k + 1];
            opposite[order[k + 1]] = order[k];
        }
    }
    return opposite;
}

elements without_parallelograms(graph near)
{
    return (elements){near, 0, take_zeros(near.n + 1), take_numbers(0), take_zeros(near.n)};
}

elements elements_of(graph near, const int64_t *faces, int64_t m, const int64_t *quads,
                     int64_t quad_count, const int64_t *opposite)
{
    const int64_t count = 4 * quad_count + 3 * m, n = near.n;
    int64_t *const rows = take_numbers(4 * count), *const apex = take_numbers(count);
    if (opposite == NULL)
        opposite = opposite_of(faces, m);
    int64_t known = 0;
    for (int64_t k = 0; k < count; k++) {
        int64_t a, b, o, i;
        if (k < 4 * quad_count) {
            const int64_t *const quad = quads + k / 4 * 4;
            a = quad[(k + 3) % 4], b = quad[(k + 1) % 4], o = quad[(k + 2) % 4], i = quad[k % 4];
        } else {
            const int64_t h = k - 4 * quad_count, g = opposite[h];
            a = faces[h], b = faces[after_in_face(h)], i = faces[after_in_face(after_in_face(h))];
            o = g < 0 ? n : faces[after_in_face(after_in_face(g))];
        }
        if (most(most(a, b), o) >= i)
            continue;
        apex[known] = i;
        memcpy(rows + 4 * known++, (int64_t[]){a, b, o, k < 4 * quad_count}, 4 * sizeof(a));
    }
    const int64_t *const order = order_of(apex, known);
    elements e = {near, known, starts_of(apex, known, n), take_numbers(3 * known), take_zeros(n)};
    for (int64_t k = 0; k < known; k++) {
        memcpy(e.corners + 3 * k, rows + 4 * order[k], 3 * sizeof(*rows));
        e.within[apex[order[k]]] += rows[4 * order[k] + 3];
    }
    return e;
}

elements among(elements all, const int64_t *keep)
{
    int64_t n = 0, entries = 0, known = 0;
    int64_t *const number = take_numbers(all.near.n);
    for (int64_t i = 0; i < all.near.n; i++) {
        number[i] = n;
        n += keep[i];
    }
    if (n == all.near.n)
        return all;
    elements e = {{n, 0, take_zeros(n + 1), take_numbers(all.near.entries)},
                  0, take_zeros(n + 1), take_numbers(3 * all.count), take_zeros(n)};
    for (int64_t i = 0; i < all.near.n; i++) {
        if (!keep[i])
            continue;
        for (int64_t at = all.near.indptr[i]; at < all.near.indptr[i + 1]; at++)
            if (keep[all.near.indices[at]])
                e.near.indices[entries++] = number[all.near.indices[at]];
        for (int64_t at = all.first[i]; at < all.first[i + 1]; at++) {
            const int64_t *const corner = all.corners + 3 * at;
            if (!keep[corner[0]] || !keep[corner[1]] || !keep[corner[2]])
                continue;
            for (int k = 0; k < 3; k++)
                e.corners[3 * known + k] = number[corner[k]];
            known++;
        }
        e.near.indptr[number[i] + 1] = entries;
        e.first[number[i] + 1] = known;
    }
    e.near.entries = entries, e.count = known;
    /* As long as they say, so that reading beyond them shows. */
    e.near.indices = copy_of(e.near.indices, entries);
    e.corners = copy_of(e.corners, 3 * known);
    return e;
}
