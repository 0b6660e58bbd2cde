/* Half-edges of triangles, for those who do not compile `halfedges.h` themselves, and by edge. */
#include "halfedges.h"

#include "deltamesh_core.h"
#include "graphs.h"

int64_t dm_halfedge_after(int64_t h) { return dm_next(h); }

int64_t dm_halfedge_before(int64_t h) { return dm_previous(h); }

static int64_t lower(int64_t a, int64_t b) { return a < b ? a : b; }
static int64_t higher(int64_t a, int64_t b) { return a > b ? a : b; }

/* Set where the groups of a counting sort begin, from the size of group k at place[k + 1]. */
static void accumulate(int64_t *place, int64_t n)
{
    for (int64_t k = 0; k < n; k++)
        place[k + 1] += place[k];
}

/* Set `order` (count,) to the half-edges from `start` to `end` (count,), edge after edge in
   lexicographic order and ascending within one, and `bounds` (edges + 1,) to where each edge begins
   and the last ends; there is room for (count + 1,).

   Two counting sorts, by the higher and then by the lower end: n vertices in rows that are mostly
   near each other are fast, and nothing is compared. Scratch: by_higher (count,), place (n + 1,). */
int dm_group_by_edge(const int64_t *start, const int64_t *end, int64_t count, int64_t n,
                     int64_t *order, int64_t *bounds, int64_t *edges, int32_t *by_higher,
                     int64_t *place)
{
    if (n < 0 || count > INT32_MAX || !dm_all_in(start, count, 0, n) ||
        !dm_all_in(end, count, 0, n))
        return DM_INVALID;
    for (int64_t v = 0; v <= n; v++)
        place[v] = 0;
    for (int64_t h = 0; h < count; h++)
        place[higher(start[h], end[h]) + 1]++;
    accumulate(place, n);
    for (int64_t h = 0; h < count; h++)
        by_higher[place[higher(start[h], end[h])]++] = (int32_t)h;
    for (int64_t v = 0; v <= n; v++)
        place[v] = 0;
    for (int64_t h = 0; h < count; h++)
        place[lower(start[h], end[h]) + 1]++;
    accumulate(place, n);
    for (int64_t k = 0; k < count; k++) {
        const int64_t h = by_higher[k];
        order[place[lower(start[h], end[h])]++] = h;
    }
    int64_t found = 0;
    for (int64_t k = 0; k < count; k++) {
        const int64_t h = order[k], g = k ? order[k - 1] : h;
        if (k == 0 || lower(start[h], end[h]) != lower(start[g], end[g]) ||
            higher(start[h], end[h]) != higher(start[g], end[g]))
            bounds[found++] = k;
    }
    bounds[found] = count;
    *edges = found;
    return DM_OK;
}
