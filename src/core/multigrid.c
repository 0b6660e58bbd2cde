/* Poisson problem of the decoder: the graph Laplacian with some vertices fixed.

   A is the Laplacian L = D - A of a graph without the rows and columns of its fixed vertices: an
   M-matrix, symmetric and positive definite where each component has a fixed vertex. Conjugate
   gradients, preconditioned by a multigrid cycle: coarse levels of plain aggregates, whose matrices
   are P^T A P for the indicators P of the aggregates; a W-cycle, whose smoother is a sweep of Gauss
   and Seidel, forward before the correction and backward after it, so that the cycle is symmetric.
   The cycle works in single precision and the gradients in double; four right-hand sides go side
   by side.

   Sources: D. Braess, "Towards algebraic multigrid for elliptic problems of second order",
   Computing 55, 1995; Y. Notay, "An aggregation-based algebraic multigrid method", ETNA 37, 2010;
   of the bound on the error, the maximum principle: R. S. Varga, "Matrix Iterative Analysis", 1962,
   section 3.5. */
#include <math.h>
#include <stddef.h>

#include "deltamesh_core.h"
#include "graphs.h"
#include "multigrid.h"

enum { COORDINATES = DM_COORDINATES, LANES = DM_LANES, BARRIER = LANES - 1 };

/* Plain aggregates correct too little (Braess). Below 2, the cycle stays positive definite; at 1.7
   it needs 28 % fewer iterations on surfaces than at 1. */
#define OVERCORRECTION 1.7f

/* More of them gain nothing: the residual is as small as rounding lets it be. */
enum { RESTARTS = 3 };

/* The bound where a number is infinite or none: no iteration mends that. */
#define OVERFLOWN (-1.0)

/* Put the free nodes into aggregates, each a node with all of its neighbours, or what such ones
   left of them beside the aggregate of a neighbour: -1 for fixed nodes and for those without free
   neighbours, which a sweep solves exactly. Each aggregate has two nodes or more.

   `inverse` (n,) is 1 over the diagonal, 0 for fixed nodes. */
int dm_aggregate(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                 const float *inverse, int32_t *aggregate, int64_t *count)
{
    if (!dm_is_graph(indptr, n, indices, entries))
        return DM_INVALID;
    int32_t found = 0;
    for (int64_t i = 0; i < n; i++)
        aggregate[i] = -1;
    for (int64_t i = 0; i < n; i++) {
        if (aggregate[i] >= 0 || inverse[i] == 0.0f)
            continue;
        int untouched = 1, some = 0;
        for (int32_t at = indptr[i]; at < indptr[i + 1]; at++) {
            untouched &= aggregate[indices[at]] < 0;
            some |= inverse[indices[at]] != 0.0f;
        }
        if (!untouched || !some)
            continue;
        aggregate[i] = found;
        for (int32_t at = indptr[i]; at < indptr[i + 1]; at++)
            if (inverse[indices[at]] != 0.0f)
                aggregate[indices[at]] = found;
        found++;
    }
    /* Those left have a neighbour in an aggregate of the first pass, which are numbered below
       `found`; those that join one now do not count as such, or the aggregates would grow long. */
    for (int64_t i = 0; i < n; i++) {
        if (aggregate[i] >= 0 || inverse[i] == 0.0f)
            continue;
        for (int32_t at = indptr[i]; at < indptr[i + 1]; at++) {
            if (aggregate[indices[at]] >= 0) {
                aggregate[i] = -2 - aggregate[indices[at]];
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

/* One level of the hierarchy. */
typedef struct {
    int64_t n;
    const int32_t *indptr, *indices, *aggregate;
    const float *weights, *diagonal, *inverse;
    float *b, *x;
} level;

typedef struct {
    level levels[DM_MAX_LEVELS];
    int64_t count, dense;
    const double *factor;
} hierarchy;

/* One sweep of Gauss and Seidel over a level, from x = 0 where that is said. */
static void sweep(const level *l, int backward, int from_zero)
{
    const float *const weights = l->weights;
    for (int64_t t = 0; t < l->n; t++) {
        const int64_t i = backward ? l->n - 1 - t : t;
        float sum[LANES];
        for (int k = 0; k < LANES; k++)
            sum[k] = l->b[i * LANES + k];
        for (int32_t at = l->indptr[i]; at < l->indptr[i + 1]; at++) {
            const int32_t j = l->indices[at];
            if (from_zero && j > i)
                continue;
            const float *const x = l->x + (ptrdiff_t)j * LANES;
            const float weight = weights == NULL ? 1.0f : weights[at];
            for (int k = 0; k < LANES; k++)
                sum[k] += weight * x[k];
        }
        for (int k = 0; k < LANES; k++)
            l->x[i * LANES + k] = sum[k] * l->inverse[i];
    }
}

/* Set the right-hand side of the coarse level to the sums of the residual over aggregates. */
static void restrict_residual(const level *l, level *coarse)
{
    const float *const weights = l->weights;
    for (int64_t i = 0; i < coarse->n * LANES; i++)
        coarse->b[i] = 0.0f;
    for (int64_t i = 0; i < l->n; i++) {
        if (l->aggregate[i] < 0)
            continue;
        float sum[LANES];
        for (int k = 0; k < LANES; k++)
            sum[k] = l->b[i * LANES + k] - l->diagonal[i] * l->x[i * LANES + k];
        for (int32_t at = l->indptr[i]; at < l->indptr[i + 1]; at++) {
            const float *const x = l->x + (ptrdiff_t)l->indices[at] * LANES;
            const float weight = weights == NULL ? 1.0f : weights[at];
            for (int k = 0; k < LANES; k++)
                sum[k] += weight * x[k];
        }
        float *const out = coarse->b + (ptrdiff_t)l->aggregate[i] * LANES;
        for (int k = 0; k < LANES; k++)
            out[k] += sum[k];
    }
}

/* Solve the coarsest level exactly. */
static void solve_dense(const hierarchy *h, const level *l)
{
    const int64_t n = h->dense;
    for (int k = 0; k < LANES; k++) {
        double x[DM_MAX_DENSE];
        for (int64_t i = 0; i < n; i++) {
            x[i] = (double)l->b[i * LANES + k];
            for (int64_t j = 0; j < i; j++)
                x[i] -= h->factor[i * n + j] * x[j];
            x[i] /= h->factor[i * n + i];
        }
        for (int64_t i = n - 1; i >= 0; i--) {
            x[i] /= h->factor[i * n + i];
            for (int64_t j = 0; j < i; j++)
                x[j] -= h->factor[i * n + j] * x[i];
            l->x[i * LANES + k] = (float)x[i];
        }
    }
}

/* One W-cycle: x of a level for its b, from x = 0 or from what x is. */
static void cycle(hierarchy *h, int64_t at, int from_zero)
{
    level *const l = &h->levels[at];
    if (at == h->count - 1 && h->dense == l->n && l->n > 0) {
        solve_dense(h, l);
        return;
    }
    sweep(l, 0, from_zero);
    if (at + 1 < h->count) {
        level *const coarse = &h->levels[at + 1];
        restrict_residual(l, coarse);
        cycle(h, at + 1, 1);
        if (at + 2 < h->count)
            cycle(h, at + 1, 0);
        for (int64_t i = 0; i < l->n; i++) {
            if (l->aggregate[i] < 0)
                continue;
            const float *const x = coarse->x + (ptrdiff_t)l->aggregate[i] * LANES;
            for (int k = 0; k < LANES; k++)
                l->x[i * LANES + k] += OVERCORRECTION * x[k];
        }
    }
    sweep(l, 1, 0);
}

/* Set out to b - A x on the free vertices, 0 elsewhere; the last lane of b is `one`, that of x the
   barrier w. */
static void residual(const level *l, const double *b, double one, const double *x, const double *w,
                     double *out)
{
    for (int64_t i = 0; i < l->n; i++) {
        const double degree = (double)(l->indptr[i + 1] - l->indptr[i]);
        double sum[LANES];
        for (int k = 0; k < COORDINATES; k++)
            sum[k] = b[i * COORDINATES + k] - degree * x[i * COORDINATES + k];
        sum[BARRIER] = one - degree * w[i];
        for (int32_t at = l->indptr[i]; at < l->indptr[i + 1]; at++) {
            const ptrdiff_t j = l->indices[at];
            for (int k = 0; k < COORDINATES; k++)
                sum[k] += x[j * COORDINATES + k];
            sum[BARRIER] += w[j];
        }
        for (int k = 0; k < LANES; k++)
            out[i * LANES + k] = l->inverse[i] == 0.0f ? 0.0 : sum[k];
    }
}

/* Set q to A p on the free vertices, and `product` to their scalar products, lane by lane. */
static void multiply(const level *l, const double *p, double *q, double *product)
{
    for (int k = 0; k < LANES; k++)
        product[k] = 0.0;
    for (int64_t i = 0; i < l->n; i++) {
        const double degree = (double)(l->indptr[i + 1] - l->indptr[i]);
        double sum[LANES];
        for (int k = 0; k < LANES; k++)
            sum[k] = degree * p[i * LANES + k];
        for (int32_t at = l->indptr[i]; at < l->indptr[i + 1]; at++) {
            const double *const other = p + (ptrdiff_t)l->indices[at] * LANES;
            for (int k = 0; k < LANES; k++)
                sum[k] -= other[k];
        }
        if (l->inverse[i] == 0.0f)
            for (int k = 0; k < LANES; k++)
                sum[k] = 0.0;
        for (int k = 0; k < LANES; k++) {
            q[i * LANES + k] = sum[k];
            product[k] += sum[k] * p[i * LANES + k];
        }
    }
}

/* Return a bound on the error of a solution, from its residual r and the barrier so far; infinite
   where it proves nothing yet, OVERFLOWN where it never will.

   The barrier w has A w >= (1 - s) 1, s being the largest |1 - A w|. A is an M-matrix, so A^-1 >= 0
   and no row of A^-1 sums up to more than max w / (1 - s). */
static double bound_of(const level *l, const double *w, const double *r, double *barrier)
{
    double largest = 0.0, slack = 0.0, most = 0.0;
    int defined = 1;
    for (int64_t i = 0; i < l->n; i++) {
        for (int k = 0; k < LANES; k++)
            defined &= isfinite(r[i * LANES + k]) != 0;
        for (int k = 0; k < COORDINATES; k++)
            largest = fmax(largest, fabs(r[i * LANES + k]));
        slack = fmax(slack, fabs(r[i * LANES + BARRIER]));
        if (l->inverse[i] != 0.0f)
            most = fmax(most, w[i]);
    }
    if (!defined)
        return OVERFLOWN;
    if (*barrier == 0.0 && slack <= 0.5)
        *barrier = most / (1.0 - slack);
    return *barrier > 0.0 ? *barrier * largest : (largest == 0.0 && slack == 0.0 ? 0.0 : HUGE_VAL);
}

/* Let the gradients go from x until the bound is kept, or `most` iterations are done. */
static int64_t descend(hierarchy *h, double *x, double *w, double *r, double *p, double *q,
                       double tolerance, int64_t most, double *barrier, double *bound)
{
    level *const l = &h->levels[0];
    const int64_t n = l->n;
    double before[LANES] = {0.0};
    int64_t done = 0;
    while (done < most && !(*bound <= tolerance)) {
        double now[LANES] = {0.0}, product[LANES], step[LANES], share[LANES];
        for (int64_t i = 0; i < n * LANES; i++)
            l->b[i] = (float)r[i];
        cycle(h, 0, 1);
        for (int64_t i = 0; i < n; i++)
            for (int k = 0; k < LANES; k++)
                now[k] += r[i * LANES + k] * (double)l->x[i * LANES + k];
        for (int k = 0; k < LANES; k++)
            share[k] = before[k] > 0.0 && now[k] > 0.0 ? now[k] / before[k] : 0.0;
        for (int64_t i = 0; i < n; i++)
            for (int k = 0; k < LANES; k++)
                p[i * LANES + k] = (double)l->x[i * LANES + k] + share[k] * p[i * LANES + k];
        multiply(l, p, q, product);
        for (int k = 0; k < LANES; k++) {
            step[k] = product[k] > 0.0 && now[k] > 0.0 ? now[k] / product[k] : 0.0;
            before[k] = now[k];
        }
        for (int64_t i = 0; i < n; i++) {
            for (int k = 0; k < COORDINATES; k++)
                x[i * COORDINATES + k] += step[k] * p[i * LANES + k];
            w[i] += step[BARRIER] * p[i * LANES + BARRIER];
            for (int k = 0; k < LANES; k++)
                r[i * LANES + k] -= step[k] * q[i * LANES + k];
        }
        done++;
        *bound = bound_of(l, w, r, barrier);
    }
    return done;
}

/* Solve A x = b for the free vertices, in place from where x (n, 3) starts; fixed vertices keep
   their x. Without `barrier`, the first solve with a tolerance finds it.

   It ends when `bound`, on the error of each coordinate, is at most the tolerance, or after `most`
   iterations, which it counts. The rows of the finest level, `near` and `neighbours`, are those of a
   graph; the other levels follow each other in each array, and in those of numbers all do. Sizes and
   entries (levels,) count their nodes and entries. `factor` (dense, dense) is of the coarsest level, where
   that has so few nodes. Scratch: w (n,); r, p, q (n, LANES); the cycle's b and x of all levels but
   the finest, which has them in q: nothing needs both at once. */
int dm_solve_poisson(const int64_t *sizes, const int64_t *entries, int64_t levels,
                     const int32_t *near, const int32_t *neighbours, const int32_t *indptr,
                     const int32_t *indices, const float *weights,
                     const float *diagonal, const float *inverse, const int32_t *aggregate,
                     const double *factor, int64_t dense, const double *b, double *x,
                     double tolerance, int64_t most, double *barrier, double *bound,
                     int64_t *iterations, double *w, double *r, double *p, double *q,
                     float *cycle_b, float *cycle_x)
{
    hierarchy h = {.count = levels, .dense = dense, .factor = factor};
    if (levels < 1 || levels > DM_MAX_LEVELS || dense < 0 || dense > DM_MAX_DENSE)
        return DM_INVALID;
    for (int64_t at = 0; at < levels; at++) {
        const int64_t n = sizes[at];
        const int32_t *const rows = at ? indptr : near, *const columns = at ? indices : neighbours;
        if (n < 0 || entries[at] < 0 || !dm_is_graph(rows, n, columns, entries[at]))
            return DM_INVALID;
        if (at + 1 < levels)
            for (int64_t i = 0; i < n; i++)
                if (aggregate[i] >= sizes[at + 1])
                    return DM_INVALID;
        float *const finest = (float *)q;
        h.levels[at] = (level){n,
                               rows,
                               columns,
                               aggregate,
                               at ? weights : NULL,
                               diagonal,
                               inverse,
                               at ? cycle_b : finest,
                               at ? cycle_x : finest + n * LANES};
        diagonal += n, inverse += n, aggregate += n;
        if (at) {
            indptr += n + 1, indices += entries[at], weights += entries[at];
            cycle_b += n * LANES, cycle_x += n * LANES;
        }
    }
    const level *const l = &h.levels[0];
    const double one = tolerance > 0.0 && *barrier == 0.0 ? 1.0 : 0.0;
    for (int64_t i = 0; i < l->n; i++)
        w[i] = 0.0;
    *iterations = 0;
    /* What the recurrence of r says drifts from the truth by rounding, and only the truth bounds the
       error: go on from there, a few times. */
    for (int again = 0;; again++) {
        residual(l, b, one, x, w, r);
        *bound = bound_of(l, w, r, barrier);
        for (int64_t i = 0; i < l->n * LANES; i++)
            p[i] = 0.0;
        if (*bound < 0.0) {
            *bound = HUGE_VAL;
            break;
        }
        if (*bound <= tolerance || *iterations >= most || again == RESTARTS)
            break;
        *iterations += descend(&h, x, w, r, p, q, tolerance, most - *iterations, barrier, bound);
    }
    return DM_OK;
}
