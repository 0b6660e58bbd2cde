/* Neighbours of vertices, and connected components. */
#include "deltamesh_core.h"
#include "graphs.h"

/* Fill in the rows of neighbours, indptr (n + 1,) and indices (2 edges,), which ascend.

   pairs (edges, 2): the edges (i, j), i < j < n, each once, in lexicographic order. */
int dm_fill_neighbours(const int64_t *pairs, int64_t edges, int64_t n, int64_t *indptr,
                       int64_t *indices)
{
    for (int64_t e = 0; e < edges; e++) {
        const int64_t i = pairs[2 * e], j = pairs[2 * e + 1];
        const int64_t *const before = pairs + 2 * e - 2;
        if (i < 0 || i >= j || j >= n)
            return DM_INVALID;
        if (e > 0 && (before[0] > i || (before[0] == i && before[1] >= j)))
            return DM_INVALID;
    }
    for (int64_t v = 0; v <= n; v++)
        indptr[v] = 0;
    /* indptr[v + 1] counts, then is where the next neighbour of v belongs, then where v ends. */
    for (int64_t k = 0; k < 2 * edges; k++)
        indptr[pairs[k] + 1]++;
    int64_t begin = 0;
    for (int64_t v = 0; v < n; v++) {
        const int64_t count = indptr[v + 1];
        indptr[v + 1] = begin;
        begin += count;
    }
    /* A vertex is the second one of all its edges to lower vertices before it is the first one. */
    for (int64_t e = 0; e < edges; e++) {
        const int64_t i = pairs[2 * e], j = pairs[2 * e + 1];
        indices[indptr[i + 1]++] = j;
        indices[indptr[j + 1]++] = i;
    }
    return DM_OK;
}

/* Label the connected components (n,) in the order of their lowest vertices; set how many there are.

   Scratch: queue (n,). */
int dm_label_components(const int64_t *indptr, int64_t n, const int64_t *indices, int64_t entries,
                        int64_t *label, int64_t *queue, int64_t *count)
{
    if (!dm_is_graph(indptr, n, indices, entries))
        return DM_INVALID;
    for (int64_t v = 0; v < n; v++)
        label[v] = -1;
    *count = 0;
    for (int64_t v = 0; v < n; v++) {
        if (label[v] >= 0)
            continue;
        int64_t head = 0, tail = 0;
        label[v] = *count;
        queue[tail++] = v;
        for (; head < tail; head++) {
            const int64_t u = queue[head];
            for (int64_t at = indptr[u]; at < indptr[u + 1]; at++) {
                const int64_t w = indices[at];
                if (label[w] < 0)
                    label[w] = *count, queue[tail++] = w;
            }
        }
        (*count)++;
    }
    return DM_OK;
}
