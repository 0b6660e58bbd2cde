/* Graph distances, and the local maxima and updates of greedy anchors. */
#include "deltamesh_core.h"
#include "graphs.h"
#include "integers.h"

/* Lower `distance` (n,) to the distance from a new source, where that is less.

   A breadth-first search that goes on from the vertices it lowers only: where the new source is not
   nearer, neither is it beyond. A vertex enters the queue once, since the first distance that the
   search gives it is the final one. */
static void relax(const int32_t *indptr, const int32_t *indices, int64_t source, int64_t *distance,
                  int64_t *queue)
{
    int64_t head = 0, tail = 1;
    distance[source] = 0;
    queue[0] = source;
    for (; head < tail; head++) {
        const int64_t v = queue[head], next = distance[v] + 1;
        for (int64_t at = indptr[v]; at < indptr[v + 1]; at++) {
            const int64_t w = indices[at];
            if (distance[w] > next)
                distance[w] = next, queue[tail++] = w;
        }
    }
}

/* Fill `anchors` (count,): the points of `first`, then always the vertex farthest from them all.

   Every component has a point in `first`; first_count <= count <= n. Ties go to the lowest index.
   Distances only fall, so the vertices at the present maximum are taken in one ascending scan: a
   vertex joins that level never, and has left it if its distance is less by the time the scan comes
   to it. Scratch: distance, queue (n,). */
int dm_farthest_points(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                       const int64_t *first, int64_t first_count, int64_t *anchors, int64_t count,
                       int64_t *distance, int64_t *queue)
{
    if (!dm_is_graph(indptr, n, indices, entries) || !dm_all_in(first, first_count, 0, n) ||
        first_count > count || count > n)
        return DM_INVALID;
    int64_t found = 0;
    for (int64_t v = 0; v < n; v++)
        distance[v] = n;
    for (int64_t k = 0; k < first_count; k++) {
        anchors[found++] = first[k];
        relax(indptr, indices, first[k], distance, queue);
    }
    while (found < count) {
        int64_t level = 0;
        for (int64_t v = 0; v < n; v++)
            level = dm_max(level, distance[v]);
        for (int64_t v = 0; v < n && found < count; v++) {
            if (distance[v] == level) {
                anchors[found++] = v;
                relax(indptr, indices, v, distance, queue);
            }
        }
    }
    return DM_OK;
}

/* Set `nearest` (n,) to the source that is the fewest edges away, by its place among the sources;
   -1 where there is none.

   A breadth-first search from all sources at once, in their order: of equally near ones, the vertex
   takes that of the neighbour which the search came to first. Scratch: queue (n,). */
int dm_nearest(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
               const int64_t *sources, int64_t count, int64_t *nearest, int64_t *queue)
{
    if (!dm_is_graph(indptr, n, indices, entries) || !dm_all_in(sources, count, 0, n))
        return DM_INVALID;
    int64_t head = 0, tail = 0;
    for (int64_t v = 0; v < n; v++)
        nearest[v] = -1;
    for (int64_t k = 0; k < count; k++) {
        if (nearest[sources[k]] >= 0)
            return DM_INVALID;
        nearest[sources[k]] = k;
        queue[tail++] = sources[k];
    }
    for (; head < tail; head++) {
        const int64_t v = queue[head];
        for (int64_t at = indptr[v]; at < indptr[v + 1]; at++) {
            const int64_t w = indices[at];
            if (nearest[w] < 0)
                nearest[w] = nearest[v], queue[tail++] = w;
        }
    }
    return DM_OK;
}

/* Mark the vertices whose value no neighbour exceeds; of equal neighbours the lowest index. */
int dm_local_maxima(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                    const double *value, uint8_t *is_maximum)
{
    if (!dm_is_graph(indptr, n, indices, entries))
        return DM_INVALID;
    for (int64_t v = 0; v < n; v++) {
        is_maximum[v] = 1;
        for (int64_t at = indptr[v]; at < indptr[v + 1]; at++) {
            const int64_t w = indices[at];
            if (value[w] > value[v] || (value[w] == value[v] && w < v))
                is_maximum[v] = 0;
        }
    }
    return DM_OK;
}

/* Do block -= W[:, :count] @ W[rows, :count].T in place; block (n, width), W (n, row).

   In a fixed order of operations: a BLAS gives other last bits for another number of threads, and a
   greedy choice can hang on them. The inner loop runs over a row of the block. Scratch: columns
   (count, width). */
int dm_subtract_product(double *block, int64_t n, int64_t width, const double *W, int64_t row,
                        int64_t count, const int64_t *rows, double *columns)
{
    if (count > row || !dm_all_in(rows, width, 0, n))
        return DM_INVALID;
    for (int64_t j = 0; j < count; j++)
        for (int64_t c = 0; c < width; c++)
            columns[j * width + c] = W[rows[c] * row + j];
    for (int64_t i = 0; i < n; i++) {
        double *const out = block + i * width;
        for (int64_t j = 0; j < count; j++) {
            const double w = W[i * row + j];
            const double *const column = columns + j * width;
            for (int64_t c = 0; c < width; c++)
                out[c] -= w * column[c];
        }
    }
    return DM_OK;
}
