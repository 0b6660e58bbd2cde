/* Solution of systems with a factor: forward and backward substitution, panel by panel.

   Both go over the panels of `factor.c` once for several right-hand sides, in one order of
   operations. */
#include "deltamesh_core.h"
#include "graphs.h"
#include "integers.h"
#include "panels.h"

/* A panel, and what it does to right-hand sides. */
typedef struct {
    const double *entries;
    const int64_t *rows;
    int64_t height, width, start;
} panel;

static panel panel_of(const dm_factor_plan *p, int64_t s)
{
    const panel made = {p->panels + p->panel_bounds[s], p->rows + p->row_bounds[s],
                        p->row_bounds[s + 1] - p->row_bounds[s], p->starts[s + 1] - p->starts[s],
                        p->starts[s]};
    return made;
}

/* Four columns at once: each right-hand side is read and written a quarter as often. */
enum { AT_ONCE = 4 };

/* Right-hand sides that one pass over the factor solves for: with fewer, reading it would take most of
   the time. */
enum { MOST_COLUMNS = 16 };

/* Subtract `count` columns from `first` on, times their solutions, from the rows below them. */
static inline void subtract_columns(const panel *p, int64_t first, int64_t count, double *x,
                                    int64_t columns)
{
    const double *e = p->entries + first * p->height, *solved = x + first * columns;
    const int64_t h = p->height;
    for (int64_t k = 0; k < count; k++) /* a triangle on the diagonal */
        for (int64_t i = k + 1; i < count; i++)
            for (int64_t c = 0; c < columns; c++)
                x[(first + i) * columns + c] -= e[k * h + first + i] * solved[k * columns + c];
    if (count < AT_ONCE) {
        for (int64_t k = 0; k < count; k++)
            for (int64_t i = first + count; i < h; i++)
                for (int64_t c = 0; c < columns; c++)
                    x[i * columns + c] -= e[k * h + i] * solved[k * columns + c];
        return;
    }
    for (int64_t i = first + count; i < h; i++)
        for (int64_t c = 0; c < columns; c++)
            x[i * columns + c] -= (e[i] * solved[c] + e[h + i] * solved[columns + c]) +
                                  (e[2 * h + i] * solved[2 * columns + c] +
                                   e[3 * h + i] * solved[3 * columns + c]);
}

/* Subtract the rows below `count` columns from `first` on, times their solutions, from these. */
static inline void subtract_rows(const panel *p, int64_t first, int64_t count, double *x,
                                 int64_t columns)
{
    const double *e = p->entries + first * p->height;
    double *own = x + first * columns;
    const int64_t h = p->height;
    if (count == AT_ONCE) {
        double sums[AT_ONCE * MOST_COLUMNS] = {0.0};
        for (int64_t i = first + count; i < h; i++)
            for (int64_t c = 0; c < columns; c++) {
                const double solved = x[i * columns + c];
                sums[c] += e[i] * solved, sums[columns + c] += e[h + i] * solved;
                sums[2 * columns + c] += e[2 * h + i] * solved;
                sums[3 * columns + c] += e[3 * h + i] * solved;
            }
        for (int64_t i = 0; i < AT_ONCE * columns; i++)
            own[i] -= sums[i];
    } else {
        for (int64_t k = 0; k < count; k++)
            for (int64_t i = first + count; i < h; i++)
                for (int64_t c = 0; c < columns; c++)
                    own[k * columns + c] -= e[k * h + i] * x[i * columns + c];
    }
    for (int64_t k = count - 2; k >= 0; k--)
        for (int64_t i = k + 1; i < count; i++)
            for (int64_t c = 0; c < columns; c++)
                own[k * columns + c] -= e[k * h + first + i] * own[i * columns + c];
}

/* Solve L D L^T x = b in place, x (n, columns) in the order of elimination. */
static inline void solve_in_order(const dm_factor_plan *plan, double *x, int64_t columns,
                                  double *gathered)
{
    for (int64_t s = 0; s < plan->supernodes; s++) {
        const panel p = panel_of(plan, s);
        double *own = x + p.start * columns;
        int is_zero = 1;
        for (int64_t i = 0; i < p.width * columns; i++)
            gathered[i] = own[i], is_zero &= own[i] == 0.0;
        if (is_zero) /* as nearly all panels of a unit vector are */
            continue;
        for (int64_t i = p.width * columns; i < p.height * columns; i++)
            gathered[i] = 0.0;
        for (int64_t k = 0; k < p.width; k += AT_ONCE)
            subtract_columns(&p, k, dm_min(AT_ONCE, p.width - k), gathered, columns);
        for (int64_t k = 0; k < p.width; k++)
            for (int64_t c = 0; c < columns; c++)
                own[k * columns + c] = gathered[k * columns + c] / p.entries[k * p.height + k];
        for (int64_t i = p.width; i < p.height; i++)
            for (int64_t c = 0; c < columns; c++)
                x[p.rows[i] * columns + c] += gathered[i * columns + c];
    }
    for (int64_t s = plan->supernodes - 1; s >= 0; s--) {
        const panel p = panel_of(plan, s);
        for (int64_t i = 0; i < p.height; i++)
            for (int64_t c = 0; c < columns; c++)
                gathered[i * columns + c] = x[p.rows[i] * columns + c];
        for (int64_t k = (p.width - 1) / AT_ONCE * AT_ONCE; k >= 0; k -= AT_ONCE)
            subtract_rows(&p, k, dm_min(AT_ONCE, p.width - k), gathered, columns);
        for (int64_t i = 0; i < p.width * columns; i++)
            x[p.start * columns + i] = gathered[i];
    }
}

/* Solve M x = b in place, x (n, columns), with the factor of dm_factor.

   Scratch: ordered (n, columns), sums (tallest, columns), or 16 columns where there are more. */
int dm_solve_factored(const dm_factor_plan *plan, double *x, int64_t columns, double *ordered,
                      double *sums)
{
    if (!dm_is_plan(plan) || !dm_all_in(plan->order, plan->n, 0, plan->n) ||
        !dm_all_in(plan->rows, plan->row_count, 0, plan->n))
        return DM_INVALID;
    for (int64_t first = 0; first < columns; first += MOST_COLUMNS) {
        const int64_t count = dm_min(MOST_COLUMNS, columns - first);
        for (int64_t i = 0; i < plan->n; i++)
            for (int64_t c = 0; c < count; c++)
                ordered[i * count + c] = x[plan->order[i] * columns + first + c];
        if (count == 3) /* the common cases, for which the compiler knows the inner loops */
            solve_in_order(plan, ordered, 3, sums);
        else if (count == MOST_COLUMNS)
            solve_in_order(plan, ordered, MOST_COLUMNS, sums);
        else
            solve_in_order(plan, ordered, count, sums);
        for (int64_t i = 0; i < plan->n; i++)
            for (int64_t c = 0; c < count; c++)
                x[plan->order[i] * columns + first + c] = ordered[i * count + c];
    }
    return DM_OK;
}
