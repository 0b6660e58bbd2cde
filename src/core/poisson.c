/* Poisson problem of the decoder: conjugate gradients, preconditioned by a cycle of multigrid.

   The cycle works in single precision and the gradients in double. All passes over the finest level
   go block by block, and a caller may lend threads to do blocks at once. Sums are those of the
   blocks, in their order, so that the result does not depend on who did which.

   Source of the bound on the error, the maximum principle: R. S. Varga, "Matrix Iterative Analysis",
   1962, section 3.5. */
#include <math.h>
#include <stddef.h>

#include "cycle.h"
#include "deltamesh_core.h"
#include "graphs.h"

enum { COORDINATES = DM_COORDINATES, LANES = DM_LANES, BARRIER = LANES - 1 };

/* More of them gain nothing: the residual is as small as rounding lets it be. */
enum { RESTARTS = 3 };

/* The bound where a number is infinite or none: no iteration mends that. */
#define OVERFLOWN (-1.0)

/* The least that a bound needs to know of a block, in its sums. */
enum { LARGEST, SLACK, MOST, UNDEFINED };

/* A solve, of which threads do one pass at a time. */
typedef struct solve {
    dm_hierarchy h;
    const double *rhs;
    double *x, *w, *r, *p, *q; /* see `dm_solve_poisson` */
    double one, share[LANES], step[LANES];
    void (*pass)(const struct solve *, int64_t begin, int64_t end, double *sums);
    int64_t block, blocks;
    double *sums; /* (blocks, LANES) */
    int (*each)(void *, int64_t);
    int stopped;
} solve;

typedef void pass(const solve *, int64_t begin, int64_t end, double *sums);

int dm_solve_block(const void *of, int64_t index)
{
    const solve *const s = of;
    const int64_t begin = index * s->block, n = s->h.levels[0].n;
    const int64_t end = begin + s->block < n ? begin + s->block : n;
    s->pass(s, begin, end, s->sums + index * LANES);
    return DM_OK;
}

/* Do a pass over all blocks; return whether none was given up. */
static int everywhere(solve *s, pass *one)
{
    if (s->stopped)
        return 0;
    s->pass = one;
    if (s->each != NULL && s->blocks > 1) {
        s->stopped = s->each(s, s->blocks) != 0;
        return !s->stopped;
    }
    for (int64_t index = 0; index < s->blocks; index++)
        dm_solve_block(s, index);
    return 1;
}

/* Add up the sums of all blocks, lane by lane. */
static void add_up(const solve *s, double *total)
{
    for (int k = 0; k < LANES; k++)
        total[k] = 0.0;
    for (int64_t i = 0; i < s->blocks * LANES; i++)
        total[i % LANES] += s->sums[i];
}

/* Note what a bound needs to know of rows of r and w. */
static void note(const solve *s, int64_t i, double *sums)
{
    const double *const r = s->r + i * LANES;
    for (int k = 0; k < LANES; k++)
        if (!isfinite(r[k]))
            sums[UNDEFINED] = 1.0;
    for (int k = 0; k < COORDINATES; k++)
        sums[LARGEST] = fmax(sums[LARGEST], fabs(r[k]));
    sums[SLACK] = fmax(sums[SLACK], fabs(r[BARRIER]));
    if (s->h.levels[0].inverse[i] != 0.0f)
        sums[MOST] = fmax(sums[MOST], s->w[i]);
}

static void clear(double *sums)
{
    for (int k = 0; k < LANES; k++)
        sums[k] = 0.0;
}

/* Return a bound on the error of a solution, from what was noted and the barrier so far; infinite
   where it proves nothing yet, OVERFLOWN where it never will.

   The barrier w has A w >= (1 - s) 1, s being the largest |1 - A w|. A is an M-matrix, so A^-1 >= 0
   and no row of A^-1 sums up to more than max w / (1 - s). */
static double bound_of(const solve *s, double *barrier)
{
    double most[LANES] = {0.0};
    for (int64_t i = 0; i < s->blocks * LANES; i++)
        most[i % LANES] = fmax(most[i % LANES], s->sums[i]);
    if (most[UNDEFINED] > 0.0)
        return OVERFLOWN;
    if (*barrier == 0.0 && most[SLACK] <= 0.5)
        *barrier = most[MOST] / (1.0 - most[SLACK]);
    if (*barrier > 0.0)
        return *barrier * most[LARGEST];
    return most[LARGEST] == 0.0 && most[SLACK] == 0.0 ? 0.0 : HUGE_VAL;
}

/* r = b - A x on the free vertices, 0 elsewhere; the last lane of b is `one`, that of x the
   barrier w. p = 0. */
static void begin_anew(const solve *s, int64_t begin, int64_t end, double *sums)
{
    const dm_level *const l = &s->h.levels[0];
    clear(sums);
    for (int64_t i = begin; i < end; i++) {
        const double degree = (double)(l->indptr[i + 1] - l->indptr[i]);
        double sum[LANES];
        for (int k = 0; k < COORDINATES; k++)
            sum[k] = s->rhs[i * COORDINATES + k] - degree * s->x[i * COORDINATES + k];
        sum[BARRIER] = s->one - degree * s->w[i];
        for (int32_t at = l->indptr[i]; at < l->indptr[i + 1]; at++) {
            const ptrdiff_t j = l->indices[at];
            for (int k = 0; k < COORDINATES; k++)
                sum[k] += s->x[j * COORDINATES + k];
            sum[BARRIER] += s->w[j];
        }
        for (int k = 0; k < LANES; k++) {
            s->r[i * LANES + k] = l->inverse[i] == 0.0f ? 0.0 : sum[k];
            s->p[i * LANES + k] = 0.0;
        }
        note(s, i, sums);
    }
}

/* The cycle, down: its b is r. */
static void go_down(const solve *s, int64_t begin, int64_t end, double *sums)
{
    const dm_level *const l = &s->h.levels[0];
    (void)sums;
    for (int64_t i = begin * LANES; i < end * LANES; i++)
        l->b[i] = (float)s->r[i];
    dm_sweep_forward(l, begin, end, 1);
}

static void restrict_residual(const solve *s, int64_t begin, int64_t end, double *sums)
{
    dm_level coarse = s->h.levels[1];
    (void)sums;
    dm_restrict_rows(&s->h.levels[0], &coarse, begin, end);
}

static void prolongate(const solve *s, int64_t begin, int64_t end, double *sums)
{
    (void)sums;
    dm_prolongate_rows(&s->h.levels[0], &s->h.levels[1], begin, end);
}

static void take_in_others(const solve *s, int64_t begin, int64_t end, double *sums)
{
    (void)sums;
    dm_take_in_others(&s->h.levels[0], begin, end);
}

/* ... and up again; sums are the scalar products of r and the cycle's x. */
static void go_up(const solve *s, int64_t begin, int64_t end, double *sums)
{
    const dm_level *const l = &s->h.levels[0];
    dm_sweep_backward(l, begin, end);
    clear(sums);
    for (int64_t i = begin; i < end; i++)
        for (int k = 0; k < LANES; k++)
            sums[k] += s->r[i * LANES + k] * (double)l->x[i * LANES + k];
}

static void turn(const solve *s, int64_t begin, int64_t end, double *sums)
{
    const dm_level *const l = &s->h.levels[0];
    (void)sums;
    for (int64_t i = begin; i < end; i++)
        for (int k = 0; k < LANES; k++)
            s->p[i * LANES + k] =
                (double)l->x[i * LANES + k] + s->share[k] * s->p[i * LANES + k];
}

/* q = A p on the free vertices, 0 elsewhere; sums are the scalar products of p and q. */
static void multiply(const solve *s, int64_t begin, int64_t end, double *sums)
{
    const dm_level *const l = &s->h.levels[0];
    clear(sums);
    for (int64_t i = begin; i < end; i++) {
        const double degree = (double)(l->indptr[i + 1] - l->indptr[i]);
        double sum[LANES];
        for (int k = 0; k < LANES; k++)
            sum[k] = degree * s->p[i * LANES + k];
        for (int32_t at = l->indptr[i]; at < l->indptr[i + 1]; at++) {
            const double *const other = s->p + (ptrdiff_t)l->indices[at] * LANES;
            for (int k = 0; k < LANES; k++)
                sum[k] -= other[k];
        }
        for (int k = 0; k < LANES; k++) {
            s->q[i * LANES + k] = l->inverse[i] == 0.0f ? 0.0 : sum[k];
            sums[k] += s->q[i * LANES + k] * s->p[i * LANES + k];
        }
    }
}

static void advance(const solve *s, int64_t begin, int64_t end, double *sums)
{
    clear(sums);
    for (int64_t i = begin; i < end; i++) {
        for (int k = 0; k < COORDINATES; k++)
            s->x[i * COORDINATES + k] += s->step[k] * s->p[i * LANES + k];
        s->w[i] += s->step[BARRIER] * s->p[i * LANES + BARRIER];
        for (int k = 0; k < LANES; k++)
            s->r[i * LANES + k] -= s->step[k] * s->q[i * LANES + k];
        note(s, i, sums);
    }
}

/* Set the cycle's x of the finest level; return whether no pass was given up. */
static int precondition(solve *s)
{
    if (!everywhere(s, go_down))
        return 0;
    if (s->h.count > 1) {
        dm_level *const coarse = &s->h.levels[1];
        for (int64_t i = 0; i < coarse->n * LANES; i++)
            coarse->b[i] = 0.0f;
        if (!everywhere(s, restrict_residual))
            return 0;
        dm_solve_coarse(&s->h);
        if (!everywhere(s, prolongate))
            return 0;
    }
    return (s->blocks == 1 || everywhere(s, take_in_others)) && everywhere(s, go_up);
}

/* Let the gradients go from x until the bound is kept, or `most` iterations are done. */
static int64_t descend(solve *s, double tolerance, int64_t most, double *barrier, double *bound)
{
    double before[LANES] = {0.0}, now[LANES], product[LANES];
    int64_t done = 0;
    while (done < most && !(*bound <= tolerance)) {
        if (!precondition(s))
            break;
        add_up(s, now);
        for (int k = 0; k < LANES; k++)
            s->share[k] = before[k] > 0.0 && now[k] > 0.0 ? now[k] / before[k] : 0.0;
        if (!everywhere(s, turn) || !everywhere(s, multiply))
            break;
        add_up(s, product);
        for (int k = 0; k < LANES; k++) {
            s->step[k] = product[k] > 0.0 && now[k] > 0.0 ? now[k] / product[k] : 0.0;
            before[k] = now[k];
        }
        if (!everywhere(s, advance))
            break;
        done++;
        *bound = bound_of(s, barrier);
    }
    return done;
}

/* Solve A x = b for the free vertices, in place from where x (n, 3) starts; fixed vertices keep
   their x. Without `barrier`, the first solve with a tolerance finds it.

   It ends when `bound`, on the error of each coordinate, is at most the tolerance, or after `most`
   iterations, which it counts. The rows of the finest level, `near` and `neighbours`, are those of a
   graph; the other levels follow each other in each array, and in those of numbers all do. Sizes and
   entries (levels,) count their nodes and entries. `factor` (dense, dense) is of the coarsest level,
   where that has so few nodes. The finest level is in blocks of `block` rows, as its aggregates are.

   `each`, if given, is called to have `dm_solve_block` done for what it gets, and for each index
   below a count, by any thread and in any order; once all are done it returns 0, or another number
   to end the solve, whose result is then worthless.

   Scratch: sums (blocks, LANES); w, border (n,); r, p, q (n, LANES); the cycle's b and x of all levels
   but the finest, which has them in q: nothing needs both at once. */
int dm_solve_poisson(const int64_t *sizes, const int64_t *entries, int64_t levels,
                     const int32_t *near, const int32_t *neighbours, const int32_t *indptr,
                     const int32_t *indices, const float *weights, const float *diagonal,
                     const float *inverse, const int32_t *aggregate, const double *factor,
                     int64_t dense, const double *b, double *x, double tolerance, int64_t most,
                     double *barrier, double *bound, int64_t *iterations, int64_t block,
                     int (*each)(void *, int64_t), double *sums, double *w, double *r, double *p,
                     double *q, float *cycle_b, float *cycle_x, uint8_t *border)
{
    if (levels < 1 || levels > DM_MAX_LEVELS || dense < 0 || dense > DM_MAX_DENSE || block < 1)
        return DM_INVALID;
    solve s = {.h = {.count = levels, .dense = dense, .factor = factor},
               .rhs = b,
               .x = x,
               .w = w,
               .r = r,
               .p = p,
               .q = q,
               .one = tolerance > 0.0 && *barrier == 0.0 ? 1.0 : 0.0,
               .block = block,
               .blocks = sizes[0] / block + (sizes[0] % block != 0),
               .sums = sums,
               .each = each};
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
        s.h.levels[at] = (dm_level){n,
                                    rows,
                                    columns,
                                    aggregate,
                                    at ? weights : NULL,
                                    diagonal,
                                    inverse,
                                    at || s.blocks == 1 ? NULL : border,
                                    at ? cycle_b : finest,
                                    at ? cycle_x : finest + n * LANES};
        diagonal += n, inverse += n, aggregate += n;
        if (at) {
            indptr += n + 1, indices += entries[at], weights += entries[at];
            cycle_b += n * LANES, cycle_x += n * LANES;
        }
    }
    for (int64_t i = 0; i < sizes[0]; i++) {
        w[i] = 0.0;
        border[i] = 0;
        for (int32_t at = near[i]; at < near[i + 1]; at++)
            border[i] |= neighbours[at] / block != i / block;
    }
    *iterations = 0;
    /* What the recurrence of r says drifts from the truth by rounding, and only the truth bounds the
       error: go on from there, a few times. */
    for (int again = 0;; again++) {
        if (!everywhere(&s, begin_anew))
            break;
        *bound = bound_of(&s, barrier);
        if (*bound < 0.0) {
            *bound = HUGE_VAL;
            break;
        }
        if (*bound <= tolerance || *iterations >= most || again == RESTARTS)
            break;
        *iterations += descend(&s, tolerance, most - *iterations, barrier, bound);
    }
    if (s.stopped)
        *bound = HUGE_VAL;
    return DM_OK;
}
