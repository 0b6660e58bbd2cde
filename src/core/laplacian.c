/* Graph Laplacian L = D - A: its products, and the normal equations of the decoder.

   Rows of neighbours are ascending and symmetric.

   Source: O. Sorkine, D. Cohen-Or, S. Toledo, "High-Pass Quantization for Mesh Encoding", SGP 2003,
   section 3. */
#include "deltamesh_core.h"
#include "graphs.h"

/* Set out (n, columns) to L x, each sum in the order of the indices: bytes depend on it. */
int dm_apply_laplacian(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                       const double *x, int64_t columns, double *out)
{
    if (!dm_is_graph(indptr, n, indices, entries))
        return DM_INVALID;
    for (int64_t i = 0; i < n; i++) {
        const int64_t end = indptr[i + 1];
        const double degree = (double)(end - indptr[i]);
        double *sums = out + i * columns;
        for (int64_t k = 0; k < columns; k++)
            sums[k] = 0.0;
        int64_t at = indptr[i];
        for (; at < end && indices[at] < i; at++)
            for (int64_t k = 0; k < columns; k++)
                sums[k] -= x[indices[at] * columns + k];
        for (int64_t k = 0; k < columns; k++)
            sums[k] += degree * x[i * columns + k];
        for (; at < end; at++)
            for (int64_t k = 0; k < columns; k++)
                sums[k] -= x[indices[at] * columns + k];
    }
    return DM_OK;
}

/* Smooth x (n, columns) in place, keeping the sum of each column over a component: in every round a
   vertex keeps half of its value and hands the rest on to its neighbours, in equal parts.
   Scratch: shares (n, columns). */
int dm_smooth(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries, double *x,
              int64_t columns, int64_t rounds, double *shares)
{
    if (!dm_is_graph(indptr, n, indices, entries) || columns < 0)
        return DM_INVALID;
    for (int64_t round = 0; round < rounds; round++) {
        for (int64_t i = 0; i < n; i++) {
            const int64_t valence = indptr[i + 1] - indptr[i];
            const double share = valence ? 0.5 / (double)valence : 0.0;
            for (int64_t k = 0; k < columns; k++) {
                shares[i * columns + k] = share * x[i * columns + k];
                x[i * columns + k] *= valence ? 0.5 : 1.0;
            }
        }
        for (int64_t i = 0; i < n; i++)
            for (int64_t at = indptr[i]; at < indptr[i + 1]; at++)
                for (int64_t k = 0; k < columns; k++)
                    x[i * columns + k] += shares[indices[at] * columns + k];
    }
    return DM_OK;
}

/* Set the bounds (n + 1,) of the rows of L^T L. Scratch: seen (n,). */
int dm_normal_bounds(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                     int64_t *bounds, int64_t *seen)
{
    if (!dm_is_graph(indptr, n, indices, entries))
        return DM_INVALID;
    for (int64_t i = 0; i < n; i++)
        seen[i] = -1;
    bounds[0] = 0;
    for (int64_t i = 0; i < n; i++) {
        int64_t count = 1;
        seen[i] = i;
        for (int64_t at = indptr[i]; at < indptr[i + 1]; at++) {
            const int64_t k = indices[at];
            if (seen[k] != i)
                seen[k] = i, count++;
            for (int64_t there = indptr[k]; there < indptr[k + 1]; there++)
                if (seen[indices[there]] != i)
                    seen[indices[there]] = i, count++;
        }
        bounds[i + 1] = bounds[i] + count;
    }
    return DM_OK;
}

/* The row that is being filled in: where each column is, and what is there. */
typedef struct {
    int64_t *place, *columns, begin, end, most;
    double *values;
} row;

/* Add to an entry of the row; return whether there is room for it. */
static int add(row *r, int64_t column, double value)
{
    int64_t at = r->place[column];
    if (at < r->begin) {
        if (r->end >= r->most)
            return 0;
        at = r->place[column] = r->end++;
        r->columns[at] = column;
        r->values[at] = 0.0;
    }
    r->values[at] += value;
    return 1;
}

/* Fill in L^T L + S^T W S by rows, the columns of each in no order: without W, exact integers.

   `bounds` are those of dm_normal_bounds; S selects the anchors, which have `weights`. Scratch:
   place (n,). */
int dm_normal_matrix(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                     const int64_t *anchors, const double *weights, int64_t anchor_count,
                     const int64_t *bounds, int64_t *columns, double *values, int64_t filled,
                     int64_t *place)
{
    if (!dm_is_graph(indptr, n, indices, entries) || !dm_all_in(anchors, anchor_count, 0, n) ||
        !dm_are_bounds(bounds, n, filled))
        return DM_INVALID;
    for (int64_t i = 0; i < n; i++)
        place[i] = -1;
    row r = {place, columns, 0, 0, 0, values};
    int good = 1;
    for (int64_t i = 0; i < n && good; i++) {
        const double degree = (double)(indptr[i + 1] - indptr[i]);
        r.begin = r.end = bounds[i];
        r.most = bounds[i + 1];
        good &= add(&r, i, degree * degree);
        for (int64_t at = indptr[i]; at < indptr[i + 1]; at++) {
            const int64_t k = indices[at];
            good &= add(&r, k, -degree - (double)(indptr[k + 1] - indptr[k]));
            for (int64_t there = indptr[k]; there < indptr[k + 1]; there++)
                good &= add(&r, indices[there], 1.0);
        }
        good &= r.end == r.most;
    }
    if (!good)
        return DM_INVALID;
    for (int64_t a = 0; a < anchor_count; a++)
        values[bounds[anchors[a]]] += weights[a];
    return DM_OK;
}
