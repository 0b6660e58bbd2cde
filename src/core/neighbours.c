/* Neighbours of vertices, and connected components. */
#include "deltamesh_core.h"
#include "graphs.h"

/* Set the rows of neighbours, indptr (n + 1,) and indices (2 count,), of half-edges from a to b
   (count,), in any order: each row ascends, has every neighbour once, and not the vertex itself.
   `entries` counts them. Scratch: rows (2 count,), place (n,).

   Two passes sort without comparing: in the second one, vertices come to the rows of their
   neighbours in ascending order. */
int dm_gather_neighbours(const int64_t *a, const int64_t *b, int64_t count, int64_t n,
                         int32_t *indptr, int32_t *indices, int64_t *entries, int32_t *rows,
                         int32_t *place)
{
    if (n < 0 || n >= INT32_MAX || count > INT32_MAX / 2 || !dm_all_in(a, count, 0, n) ||
        !dm_all_in(b, count, 0, n))
        return DM_INVALID;
    for (int64_t v = 0; v <= n; v++)
        indptr[v] = 0;
    for (int64_t h = 0; h < count; h++)
        if (a[h] != b[h])
            indptr[a[h]]++, indptr[b[h]]++;
    int32_t begin = 0;
    for (int64_t v = 0; v <= n; v++) {
        const int32_t size = indptr[v];
        indptr[v] = begin;
        begin += size;
    }
    for (int64_t v = 0; v < n; v++)
        place[v] = indptr[v];
    for (int64_t h = 0; h < count; h++)
        if (a[h] != b[h]) {
            rows[place[a[h]]++] = (int32_t)b[h];
            rows[place[b[h]]++] = (int32_t)a[h];
        }
    for (int64_t v = 0; v < n; v++)
        place[v] = indptr[v];
    for (int64_t v = 0; v < n; v++)
        for (int64_t k = indptr[v]; k < indptr[v + 1]; k++) {
            const int64_t w = rows[k];
            if (place[w] == indptr[w] || indices[place[w] - 1] != v)
                indices[place[w]++] = (int32_t)v;
        }
    int32_t end = 0;
    for (int64_t v = 0; v < n; v++) {
        const int32_t first = indptr[v];
        indptr[v] = end;
        for (int32_t k = first; k < place[v]; k++)
            indices[end++] = indices[k];
    }
    indptr[n] = end;
    *entries = end;
    return DM_OK;
}

/* Label the connected components (n,) in the order of their lowest vertices; set how many there are.

   Scratch: queue (n,). */
int dm_label_components(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
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
