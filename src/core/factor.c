/* Sparse factorization M = L D L^T of a symmetric matrix.

   Left-looking by supernodes: a panel gets its entries of M, then the products of all panels to the
   left that reach its columns, then it is factored as a dense one. The matrix is quasidefinite:
   every order of elimination will do, and no pivot is looked for. One thread, one order of
   operations.

   Sources: E. G. Ng, B. W. Peyton, "Block sparse Cholesky algorithms on advanced uniprocessor
   computers", SIAM J. Sci. Comput. 14, 1993; R. J. Vanderbei, "Symmetric quasidefinite matrices",
   SIAM J. Optim. 5, 1995. */
#include <math.h>

#include "deltamesh_core.h"
#include "graphs.h"
#include "integers.h"
#include "panels.h"
#include "supernodes.h"

int dm_is_plan(const dm_factor_plan *p)
{
    if (!dm_are_bounds(p->starts, p->supernodes, p->n) ||
        !dm_are_bounds(p->row_bounds, p->supernodes, p->row_count) ||
        !dm_are_bounds(p->panel_bounds, p->supernodes, p->entries))
        return 0;
    int good = 1;
    for (int64_t s = 0; s < p->supernodes; s++) {
        const int64_t width = p->starts[s + 1] - p->starts[s];
        const int64_t height = p->row_bounds[s + 1] - p->row_bounds[s];
        good &= 0 < width && width <= DM_WIDEST && width <= height && height <= p->tallest &&
                p->panel_bounds[s + 1] - p->panel_bounds[s] == width * height;
    }
    return good;
}

/* Fill in the rows of each panel, ascending: its own columns, then those below. */
static int fill_rows(const int64_t *indptr, const int64_t *indices, const int64_t *rank,
                     const dm_factor_plan *p, const int64_t *parent, const int64_t *of,
                     int64_t *seen, int64_t *ends)
{
    for (int64_t s = 0; s < p->supernodes; s++) {
        seen[s] = -1;
        ends[s] = p->row_bounds[s];
        for (int64_t j = p->starts[s]; j < p->starts[s + 1]; j++)
            p->rows[ends[s]++] = j;
    }
    for (int64_t i = 0; i < p->n; i++) {
        for (int64_t at = indptr[p->order[i]]; at < indptr[p->order[i] + 1]; at++) {
            int64_t j = rank[indices[at]];
            while (0 <= j && j < p->starts[of[i]]) {
                const int64_t s = of[j];
                if (seen[s] == i)
                    break;
                if (ends[s] >= p->row_bounds[s + 1])
                    return 0;
                seen[s] = i;
                p->rows[ends[s]++] = i;
                j = parent[p->starts[s + 1] - 1];
            }
        }
    }
    int good = 1;
    for (int64_t s = 0; s < p->supernodes; s++)
        good &= ends[s] == p->row_bounds[s + 1];
    return good;
}

/* Tile of a product: c (DM_TILE columns, `height` apart) = a (DM_TILE rows, columns `stride` apart) times
   b (`depth` rows of DM_TILE). Sixteen sums, each in the order of the columns. */
#define ROWS(i)                                                                                    \
    c[i] = s0##i, c[height + i] = s1##i, c[2 * height + i] = s2##i, c[3 * height + i] = s3##i
static void multiply_tile(const double *a, int64_t stride, const double *b, int64_t depth,
                          double *c, int64_t height)
{
    double s00 = 0, s01 = 0, s02 = 0, s03 = 0, s10 = 0, s11 = 0, s12 = 0, s13 = 0;
    double s20 = 0, s21 = 0, s22 = 0, s23 = 0, s30 = 0, s31 = 0, s32 = 0, s33 = 0;
    for (int64_t k = 0; k < depth; k++, a += stride, b += DM_TILE) {
        s00 += a[0] * b[0], s01 += a[1] * b[0], s02 += a[2] * b[0], s03 += a[3] * b[0];
        s10 += a[0] * b[1], s11 += a[1] * b[1], s12 += a[2] * b[1], s13 += a[3] * b[1];
        s20 += a[0] * b[2], s21 += a[1] * b[2], s22 += a[2] * b[2], s23 += a[3] * b[2];
        s30 += a[0] * b[3], s31 += a[1] * b[3], s32 += a[2] * b[3], s33 += a[3] * b[3];
    }
    ROWS(0), ROWS(1), ROWS(2), ROWS(3);
}
#undef ROWS

/* Factor a panel (height, width), columns one after the other, in place: below the unit diagonal L,
   on the diagonal D. Return the first column whose pivot is zero or no number, else -1. */
static int64_t factor_panel(double *panel, int64_t height, int64_t width)
{
    for (int64_t k = 0; k < width; k++) {
        double *restrict column = panel + k * height;
        const double pivot = column[k];
        if (pivot == 0.0 || !isfinite(pivot))
            return k;
        for (int64_t j = k + 1; j < width; j++) {
            double *restrict other = panel + j * height;
            const double share = column[j] / pivot;
            for (int64_t i = j; i < height; i++)
                other[i] -= share * column[i];
        }
        for (int64_t i = k + 1; i < height; i++)
            column[i] /= pivot;
    }
    return -1;
}

/* Scratch of the products: `block` of tallest + DM_TILE rows and DM_WIDEST columns, `packed`
   (DM_WIDEST, DM_TILE), `place` (n,) of each column among the rows of the present panel. */
typedef struct {
    double *block, *packed;
    int64_t *place;
} workspace;

/* Subtract from panel s the product of panel d, whose rows from `from` to `to` are columns of s. */
static void subtract_product(const dm_factor_plan *p, int64_t s, int64_t d, int64_t from,
                             int64_t to, const workspace *w)
{
    const int64_t *rows = p->rows + p->row_bounds[d];
    const int64_t width = p->starts[d + 1] - p->starts[d], count = to - from;
    const int64_t height = p->row_bounds[d + 1] - p->row_bounds[d], below = height - from;
    const int64_t padded = (below + DM_TILE - 1) / DM_TILE * DM_TILE;
    const int64_t tall = p->row_bounds[s + 1] - p->row_bounds[s];
    const double *panel = p->panels + p->panel_bounds[d];
    double *target = p->panels + p->panel_bounds[s];
    for (int64_t j = 0; j < count; j += DM_TILE) {
        for (int64_t k = 0; k < width; k++) {
            const double *column = panel + k * height;
            for (int64_t t = 0; t < DM_TILE; t++) {
                const int64_t at = from + j + t;
                w->packed[k * DM_TILE + t] = j + t < count ? column[at] * column[k] : 0.0;
            }
        }
        /* The last tile may reach into what comes next, and beyond the last panel: DM_TILE entries
           more are there, and nothing is done with what they make. */
        for (int64_t i = j; i < below; i += DM_TILE)
            multiply_tile(panel + from + i, height, w->packed, width, w->block + j * padded + i,
                          padded);
    }
    for (int64_t j = 0; j < count; j++) {
        double *column = target + (rows[from + j] - p->starts[s]) * tall;
        const double *product = w->block + j * padded;
        for (int64_t i = j; i < below; i++)
            column[w->place[rows[from + i]]] -= product[i];
    }
}

/* Put the lower entries of the columns of a panel into it; return whether all have a place. */
static int take_entries(const dm_factor_plan *p, int64_t s, const int64_t *indptr,
                        const int64_t *indices, const double *values, const int64_t *rank,
                        const int64_t *place)
{
    const int64_t *rows = p->rows + p->row_bounds[s];
    const int64_t tall = p->row_bounds[s + 1] - p->row_bounds[s];
    double *column = p->panels + p->panel_bounds[s];
    int good = 1;
    for (int64_t i = 0; i < tall * (p->starts[s + 1] - p->starts[s]); i++)
        column[i] = 0.0;
    for (int64_t j = p->starts[s]; j < p->starts[s + 1]; j++, column += tall) {
        const int64_t v = p->order[j];
        for (int64_t at = indptr[v]; at < indptr[v + 1]; at++) {
            const int64_t i = rank[indices[at]];
            if (i < j)
                continue;
            if (place[i] < 0 || place[i] >= tall || rows[place[i]] != i)
                good = 0;
            else
                column[place[i]] += values[at];
        }
    }
    return good;
}

/* Factor a symmetric matrix as dm_plan has planned it; set the first pivot, in the order of
   elimination, that is zero or no number, or -1.

   Fills in rows (row_count,) and panels (entries + DM_TILE,). Scratch: rank, place (n,); from, next,
   first (supernodes,); block ((tallest + DM_TILE) * DM_WIDEST,); packed (DM_WIDEST, DM_TILE). */
int dm_factor(const int64_t *indptr, int64_t n, const int64_t *indices, int64_t entries,
              const double *values, const dm_factor_plan *plan, const int64_t *parent,
              const int64_t *of, int64_t *rank, int64_t *place, int64_t *from, int64_t *next,
              int64_t *first, double *block, double *packed, int64_t *pivot)
{
    const dm_factor_plan *p = plan;
    if (p->n != n || !dm_is_matrix(indptr, n, indices, entries) || !dm_is_plan(p) ||
        !dm_fill_ranks(p->order, n, rank) || !dm_all_in(parent, n, -1, n) ||
        !dm_all_in(of, n, 0, p->supernodes) ||
        !fill_rows(indptr, indices, rank, p, parent, of, from, next))
        return DM_INVALID;
    const workspace w = {block, packed, place};
    for (int64_t s = 0; s < p->supernodes; s++)
        first[s] = -1;
    for (int64_t i = 0; i < n; i++)
        place[i] = -1;
    *pivot = -1;
    for (int64_t s = 0; s < p->supernodes; s++) {
        const int64_t *rows = p->rows + p->row_bounds[s];
        const int64_t tall = p->row_bounds[s + 1] - p->row_bounds[s];
        const int64_t width = p->starts[s + 1] - p->starts[s];
        for (int64_t i = 0; i < tall; i++)
            place[rows[i]] = i;
        if (!take_entries(p, s, indptr, indices, values, rank, place))
            return DM_INVALID;
        for (int64_t d = first[s], after; d >= 0; d = after) {
            const int64_t *others = p->rows + p->row_bounds[d];
            const int64_t height = p->row_bounds[d + 1] - p->row_bounds[d];
            int64_t to = from[d];
            after = next[d];
            while (to < height && others[to] < p->starts[s + 1])
                to++;
            subtract_product(p, s, d, from[d], to, &w);
            from[d] = to;
            if (to < height)
                next[d] = first[of[others[to]]], first[of[others[to]]] = d;
        }
        const int64_t bad = factor_panel(p->panels + p->panel_bounds[s], tall, width);
        if (bad >= 0) {
            *pivot = p->starts[s] + bad;
            return DM_OK;
        }
        from[s] = width;
        if (width < tall)
            next[s] = first[of[rows[width]]], first[of[rows[width]]] = s;
    }
    return DM_OK;
}
