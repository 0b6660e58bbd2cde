/* Levels of multigrid for the graph Laplacian with some vertices fixed.

   A is the Laplacian L = D - A of a graph without the rows and columns of its fixed vertices: an
   M-matrix, symmetric and positive definite where each component has a fixed vertex. Coarse levels
   are those of plain aggregates, whose matrices are P^T A P for the indicators P of the aggregates;
   `cycle.c` goes through them, and `poisson.c` solves the problem.

   Sources: D. Braess, "Towards algebraic multigrid for elliptic problems of second order",
   Computing 55, 1995; Y. Notay, "An aggregation-based algebraic multigrid method", ETNA 37, 2010. */
#include <math.h>
#include <stddef.h>

#include "deltamesh_core.h"
#include "graphs.h"
#include "multigrid.h"

enum { MOST_CROSSING = 8 };

/* Choose the rows of a block of the finest level: `DM_BLOCK` or, where more than one entry in
   `MOST_CROSSING` goes from one block to another, as around hubs, all rows. */
int dm_choose_block(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                    int64_t *block)
{
    if (!dm_is_graph(indptr, n, indices, entries))
        return DM_INVALID;
    int64_t crossing = 0;
    for (int64_t i = 0; i < n; i++)
        for (int32_t at = indptr[i]; at < indptr[i + 1]; at++)
            crossing += indices[at] / DM_BLOCK != i / DM_BLOCK;
    *block = crossing > entries / MOST_CROSSING && n > 0 ? n : DM_BLOCK;
    return DM_OK;
}

/* Put the free nodes into aggregates, each a node with all of its neighbours, or what such ones
   left of them beside the aggregate of a neighbour: -1 for fixed nodes and for those without free
   neighbours, which a sweep solves exactly. Each aggregate has two nodes or more, all within one
   block of `block` nodes: other blocks are as if there were none.

   `inverse` (n,) is 1 over the diagonal, 0 for fixed nodes. */
int dm_aggregate(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                 const float *inverse, int64_t block, int32_t *aggregate, int64_t *count)
{
    if (!dm_is_graph(indptr, n, indices, entries) || block < 1)
        return DM_INVALID;
    int32_t found = 0;
    for (int64_t i = 0; i < n; i++)
        aggregate[i] = -1;
    for (int64_t i = 0; i < n; i++) {
        if (aggregate[i] >= 0 || inverse[i] == 0.0f)
            continue;
        const int64_t begin = i - i % block, end = begin + block;
        int untouched = 1, some = 0;
        for (int32_t at = indptr[i]; at < indptr[i + 1]; at++) {
            const int32_t j = indices[at];
            if (j < begin || j >= end)
                continue;
            untouched &= aggregate[j] < 0;
            some |= inverse[j] != 0.0f;
        }
        if (!untouched || !some)
            continue;
        aggregate[i] = found;
        for (int32_t at = indptr[i]; at < indptr[i + 1]; at++) {
            const int32_t j = indices[at];
            if (j >= begin && j < end && inverse[j] != 0.0f)
                aggregate[j] = found;
        }
        found++;
    }
    /* Those left have a neighbour in an aggregate of the first pass, which are numbered below
       `found`; those that join one now do not count as such, or the aggregates would grow long. */
    for (int64_t i = 0; i < n; i++) {
        if (aggregate[i] >= 0 || inverse[i] == 0.0f)
            continue;
        const int64_t begin = i - i % block, end = begin + block;
        for (int32_t at = indptr[i]; at < indptr[i + 1]; at++) {
            const int32_t j = indices[at];
            if (j >= begin && j < end && aggregate[j] >= 0) {
                aggregate[i] = -2 - aggregate[j];
                break;
            }
        }
    }
    for (int64_t i = 0; i < n; i++)
        if (aggregate[i] < -1)
            aggregate[i] = -2 - aggregate[i];
    *count = found;
    return DM_OK;
}

/* Set the matrix of a coarse level: P^T A P. Off the diagonal are the negative `weights` (entries,),
   all 1 where there is no such array; the coarse ones are written without gaps, and `coarse_entries`
   counts them. Scratch: members (n,), starts, place (m + 1,). */
int dm_coarsen(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
               const float *weights, const float *diagonal, const int32_t *aggregate, int64_t m,
               int32_t *coarse_indptr, int32_t *coarse_indices, float *coarse_weights,
               float *coarse_diagonal, int64_t *coarse_entries, int32_t *members, int32_t *starts,
               int32_t *place)
{
    if (!dm_is_graph(indptr, n, indices, entries) || m < 0 || m > n)
        return DM_INVALID;
    for (int64_t c = 0; c <= m; c++)
        starts[c] = 0, place[c] = -1;
    for (int64_t i = 0; i < n; i++) {
        if (aggregate[i] >= m)
            return DM_INVALID;
        if (aggregate[i] >= 0)
            starts[aggregate[i]]++;
    }
    int32_t sum = 0;
    for (int64_t c = 0; c <= m; c++) {
        const int32_t size = starts[c];
        starts[c] = sum;
        sum += size;
    }
    for (int64_t i = 0; i < n; i++)
        if (aggregate[i] >= 0)
            members[starts[aggregate[i]]++] = (int32_t)i;
    int32_t end = 0, next = 0;
    for (int32_t c = 0; c < m; c++) {
        const int32_t begin = end;
        double sum_of_diagonal = 0.0;
        coarse_indptr[c] = begin;
        for (; next < starts[c]; next++) {
            const int32_t i = members[next];
            sum_of_diagonal += (double)diagonal[i];
            for (int32_t at = indptr[i]; at < indptr[i + 1]; at++) {
                const int32_t other = aggregate[indices[at]];
                const float weight = weights == NULL ? 1.0f : weights[at];
                if (other < 0)
                    continue;
                if (other == c) {
                    sum_of_diagonal -= (double)weight;
                } else if (place[other] < begin) {
                    place[other] = end;
                    coarse_indices[end] = other;
                    coarse_weights[end++] = weight;
                } else {
                    coarse_weights[place[other]] += weight;
                }
            }
        }
        coarse_diagonal[c] = (float)sum_of_diagonal;
    }
    coarse_indptr[m] = end;
    *coarse_entries = end;
    return DM_OK;
}

/* Factor a small matrix by Cholesky's method: the lower triangle of `factor` (n, n), in place.
   Pivots that rounding has made too small are kept above 0. */
int dm_factor_dense(double *factor, int64_t n)
{
    for (int64_t j = 0; j < n; j++) {
        double *const row = factor + j * n;
        const double before = row[j];
        for (int64_t k = 0; k < j; k++)
            row[j] -= row[k] * row[k];
        row[j] = sqrt(row[j] > 1e-14 * before ? row[j] : 1e-14 * before);
        if (!(row[j] > 0.0))
            return DM_INVALID;
        for (int64_t i = j + 1; i < n; i++) {
            double *const other = factor + i * n;
            for (int64_t k = 0; k < j; k++)
                other[j] -= other[k] * row[k];
            other[j] /= row[j];
        }
    }
    return DM_OK;
}
