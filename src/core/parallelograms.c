/* Parallelograms of two triangles, or of a quad, each of which predicts its last vertex. */
#include "deltamesh_core.h"
#include "graphs.h"
#include "halfedges.h"

/* The sides of quads, and then of triangles, that a vertex may be predicted across. */
typedef struct {
    const int64_t *faces, *opposite, *quads;
    int64_t of_quads; /* sides */
} sides;

/* Set the vertices (a, b, o) that predict the vertex which is returned, -1 where one of them comes
   after it: (a, it, b, o) is a quad; or (a, b, it) a triangle and (b, a, o) another. */
static int64_t look_across(const sides *s, int64_t side, int64_t *around)
{
    int64_t apex;
    if (side < s->of_quads) {
        const int64_t *const quad = s->quads + side / 4 * 4;
        around[0] = quad[(side + 3) % 4], around[1] = quad[(side + 1) % 4];
        around[2] = quad[(side + 2) % 4], apex = quad[side % 4];
    } else {
        const int64_t h = side - s->of_quads, g = s->opposite[h];
        if (g < 0)
            return -1;
        around[0] = s->faces[h], around[1] = s->faces[dm_next(h)];
        around[2] = s->faces[dm_previous(g)], apex = s->faces[dm_previous(h)];
    }
    return around[0] < apex && around[1] < apex && around[2] < apex ? apex : -1;
}

static int are_sides(const sides *s, int64_t m, int64_t n)
{
    return n >= 0 && m >= 0 && 3 * m + s->of_quads <= INT32_MAX &&
           dm_all_in(s->faces, 3 * m, 0, n) && dm_all_in(s->opposite, 3 * m, -1, 3 * m) &&
           dm_all_in(s->quads, s->of_quads, 0, n);
}

/* Set where the parallelograms of each vertex begin, `first` (n + 1,), and how many of them are
   quads, `within` (n,), for triangles (m, 3) with their opposite half-edges and for quads. */
int dm_count_parallelograms(const int64_t *faces, int64_t m, int64_t n, const int64_t *opposite,
                            const int64_t *quads, int64_t quad_count, int32_t *first,
                            int32_t *within)
{
    const sides s = {faces, opposite, quads, 4 * quad_count};
    if (!are_sides(&s, m, n))
        return DM_INVALID;
    for (int64_t v = 0; v < n; v++)
        first[v + 1] = within[v] = 0;
    first[0] = 0;
    for (int64_t side = 0; side < s.of_quads + 3 * m; side++) {
        int64_t around[3];
        const int64_t apex = look_across(&s, side, around);
        if (apex < 0)
            continue;
        first[apex + 1]++;
        within[apex] += side < s.of_quads;
    }
    for (int64_t v = 0; v < n; v++)
        first[v + 1] += first[v];
    return DM_OK;
}

/* List the parallelograms that dm_count_parallelograms has counted, `corners` (count, 3).
   Scratch: place (n,). */
int dm_list_parallelograms(const int64_t *faces, int64_t m, int64_t n, const int64_t *opposite,
                           const int64_t *quads, int64_t quad_count, const int32_t *first,
                           int64_t count, int32_t *corners, int32_t *place)
{
    const sides s = {faces, opposite, quads, 4 * quad_count};
    if (!are_sides(&s, m, n) || !dm_are_short_bounds(first, n, count))
        return DM_INVALID;
    for (int64_t v = 0; v < n; v++)
        place[v] = first[v];
    for (int64_t side = 0; side < s.of_quads + 3 * m; side++) {
        int64_t around[3];
        const int64_t apex = look_across(&s, side, around);
        if (apex < 0)
            continue;
        if (place[apex] == first[apex + 1])
            return DM_INVALID;
        int32_t *const row = corners + INT64_C(3) * place[apex]++;
        for (int k = 0; k < 3; k++)
            row[k] = (int32_t)around[k];
    }
    return DM_OK;
}
