/* Plan of a sparse factorization: the order, and the columns that are factored together.

   A supernode is a run of columns whose entries below them are in the same rows, or nearly so: it
   is stored as one dense panel, with some zeros.

   Sources: T. A. Davis, "Direct Methods for Sparse Linear Systems", SIAM 2006, chapter 4
   (elimination tree, postorder, counts); C. Ashcraft, R. Grimes, "The influence of relaxed
   supernode partitions on the multifrontal method", ACM Trans. Math. Softw. 15, 1989. */
#include "deltamesh_core.h"
#include "graphs.h"
#include "integers.h"
#include "supernodes.h"

/* Runs of so few columns are one supernode, whatever their zeros; up to so many where a share of
   1 / FEW_ZEROS of the panel is zeros, else of 1 / FEWER_ZEROS. */
enum { SMALL = 4, MIDDLING = 16, FEW_ZEROS = 3, FEWER_ZEROS = 12 };

int dm_fill_ranks(const int64_t *order, int64_t n, int64_t *rank)
{
    if (!dm_all_in(order, n, 0, n))
        return 0;
    for (int64_t i = 0; i < n; i++)
        rank[i] = -1;
    for (int64_t i = 0; i < n; i++) {
        if (rank[order[i]] >= 0)
            return 0;
        rank[order[i]] = i;
    }
    return 1;
}

void dm_eliminate(const int64_t *indptr, int64_t n, const int64_t *indices, const int64_t *order,
                  const int64_t *rank, int64_t *parent, int64_t *ancestor)
{
    for (int64_t i = 0; i < n; i++)
        parent[i] = ancestor[i] = -1;
    for (int64_t i = 0; i < n; i++) {
        for (int64_t at = indptr[order[i]]; at < indptr[order[i] + 1]; at++) {
            int64_t j = rank[indices[at]];
            while (j >= 0 && j < i) {
                const int64_t above = ancestor[j];
                ancestor[j] = i;
                if (above < 0)
                    parent[j] = i;
                j = above;
            }
        }
    }
}

/* Put the order of elimination, and the tree with it, into one in which each subtree is a run that
   ends at its root. Scratch: first, next, stack, old (n,). */
static void sort_by_subtrees(int64_t n, int64_t *order, int64_t *parent, int64_t *first,
                             int64_t *next, int64_t *stack, int64_t *old)
{
    int64_t placed = 0;
    for (int64_t j = 0; j < n; j++)
        first[j] = -1, old[j] = order[j];
    for (int64_t j = n - 1; j >= 0; j--)
        if (parent[j] >= 0)
            next[j] = first[parent[j]], first[parent[j]] = j;
    for (int64_t root = 0; root < n; root++) {
        if (parent[root] >= 0)
            continue;
        int64_t depth = 0;
        stack[0] = root;
        while (depth >= 0) {
            const int64_t j = stack[depth], child = first[j];
            if (child < 0) {
                order[placed] = old[j];
                first[j] = -2 - placed++; /* from now on the new number of j */
                depth--;
            } else {
                first[j] = next[child];
                stack[++depth] = child;
            }
        }
    }
    for (int64_t j = 0; j < n; j++)
        old[-2 - first[j]] = parent[j] < 0 ? -1 : -2 - first[parent[j]];
    for (int64_t j = 0; j < n; j++)
        parent[j] = old[j];
}

/* Whether a run of columns remains a supernode with `zeros` of so many entries. */
static int is_dense(int64_t width, int64_t zeros, int64_t entries)
{
    if (width > DM_WIDEST)
        return 0;
    if (width <= SMALL)
        return 1;
    return zeros * (width <= MIDDLING ? FEW_ZEROS : FEWER_ZEROS) <= entries;
}

/* Divide the columns into supernodes; return how many there are, and set where each begins. */
static int64_t divide(int64_t n, const int64_t *parent, const int64_t *counts, int64_t *starts)
{
    int64_t found = 0, entries = 0;
    for (int64_t j = 0; j < n; j++) {
        entries += counts[j];
        if (j > 0 && parent[j - 1] == j) {
            const int64_t width = j - starts[found - 1] + 1;
            const int64_t all = width * counts[j] + width * (width - 1) / 2;
            if (is_dense(width, all - entries, all))
                continue;
        }
        starts[found++] = j;
        entries = counts[j];
    }
    starts[found] = n;
    return found;
}

/* Plan the factorization of a symmetric matrix in an order of elimination, which becomes another of
   the same fill.

   Sets parent (n,), the tree of the order; of (n,), the supernode of each column; starts (n + 1,),
   the columns at which the supernodes begin, and n; row_bounds and panel_bounds (n + 1,), where the
   rows and the entries of each panel begin and end; and sizes[]: supernodes, rows of all panels,
   entries of all panels, rows of the tallest. Where the factor alone would have more than `most`
   entries, there is no plan, and sizes[0] is -1. Scratch: rank, counts, seen, old (n,). */
int dm_plan(const int64_t *indptr, int64_t n, const int64_t *indices, int64_t entries,
            int64_t *order, int64_t most, int64_t *parent, int64_t *starts, int64_t *of,
            int64_t *row_bounds, int64_t *panel_bounds, int64_t *sizes, int64_t *rank,
            int64_t *counts, int64_t *seen, int64_t *old)
{
    if (!dm_is_matrix(indptr, n, indices, entries) || !dm_fill_ranks(order, n, rank))
        return DM_INVALID;
    dm_eliminate(indptr, n, indices, order, rank, parent, seen);
    sort_by_subtrees(n, order, parent, counts, seen, of, old);
    dm_fill_ranks(order, n, rank);
    for (int64_t j = 0; j < n; j++)
        counts[j] = 1, seen[j] = -1;
    int64_t total = n;
    for (int64_t i = 0; i < n && total <= most; i++) {
        seen[i] = i;
        for (int64_t at = indptr[order[i]]; at < indptr[order[i] + 1]; at++) {
            for (int64_t j = rank[indices[at]]; j >= 0 && j < i && seen[j] != i; j = parent[j])
                seen[j] = i, counts[j]++, total++;
        }
    }
    sizes[0] = -1;
    if (total > most)
        return DM_OK;
    sizes[0] = divide(n, parent, counts, starts);
    sizes[3] = row_bounds[0] = panel_bounds[0] = 0;
    for (int64_t s = 0; s < sizes[0]; s++) {
        const int64_t last = starts[s + 1] - 1, width = last + 1 - starts[s];
        /* The last column is the one whose rows all columns have. */
        const int64_t height = width - 1 + counts[last];
        for (int64_t j = starts[s]; j <= last; j++)
            of[j] = s;
        row_bounds[s + 1] = row_bounds[s] + height;
        panel_bounds[s + 1] = panel_bounds[s] + height * width;
        sizes[3] = dm_max(sizes[3], height);
    }
    sizes[1] = row_bounds[sizes[0]];
    sizes[2] = panel_bounds[sizes[0]];
    return DM_OK;
}
