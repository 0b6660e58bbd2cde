/* Elimination of the unknowns of a symmetric system: an order of little fill, and its fill.

   Rows of neighbours are those of a symmetric matrix, with its diagonal or without.

   Sources: A. George, J. W. H. Liu, "An automatic nested dissection algorithm for irregular finite
   element problems", SIAM J. Numer. Anal. 15, 1978 (separators from breadth-first levels); J. W. H.
   Liu, "The role of elimination trees in sparse factorization", SIAM J. Matrix Anal. 11, 1990 (the
   tree, and the rows of a factor from it). */
#include <math.h>

#include "deltamesh_core.h"
#include "graphs.h"
#include "integers.h"
#include "supernodes.h"

enum {
    LEAF = 24, /* unknowns that are not worth a separator */
    /* Nearly every separator would contain an unknown with more than that many neighbours, times the
       root of the count of unknowns: those come last, as in approximate minimum degree orderings. */
    DENSE = 10,
    SEARCHES = 4, /* for a pair of unknowns that are far from each other */
    DONE = -1,
};

typedef struct {
    const int64_t *indptr, *indices;
    int64_t *part;  /* of each unknown; DONE for one of a separator */
    int64_t *level; /* -1, or the distance from the start of a search */
    int64_t *queue; /* what a search has found, in its order */
} graph;

/* Search a connected part breadth-first; return how many unknowns it has. */
static int64_t search(const graph *g, int64_t start)
{
    int64_t head = 0, tail = 1;
    g->queue[0] = start;
    g->level[start] = 0;
    for (; head < tail; head++) {
        const int64_t v = g->queue[head];
        for (int64_t at = g->indptr[v]; at < g->indptr[v + 1]; at++) {
            const int64_t w = g->indices[at];
            if (g->part[w] == g->part[start] && g->level[w] < 0) {
                g->level[w] = g->level[v] + 1;
                g->queue[tail++] = w;
            }
        }
    }
    return tail;
}

static void forget(const graph *g, const int64_t *unknowns, int64_t count)
{
    for (int64_t i = 0; i < count; i++)
        g->level[unknowns[i]] = -1;
}

/* Set the mean count of unknowns on a breadth-first level, of the component with the most.

   Of a surface it is about the root of the count of unknowns, of a random graph nearly all. Scratch:
   part, level, queue (n,). */
int dm_breadth(const int64_t *indptr, int64_t n, const int64_t *indices, int64_t entries,
               int64_t *part, int64_t *level, int64_t *queue, double *breadth)
{
    const graph g = {indptr, indices, part, level, queue};
    if (!dm_is_matrix(indptr, n, indices, entries))
        return DM_INVALID;
    for (int64_t v = 0; v < n; v++)
        part[v] = 0, level[v] = -1;
    *breadth = 0.0;
    for (int64_t v = 0; v < n; v++) {
        if (level[v] >= 0)
            continue;
        const int64_t count = search(&g, v);
        const double mean = (double)count / (double)(level[queue[count - 1]] + 1);
        if (mean > *breadth)
            *breadth = mean;
    }
    return DM_OK;
}

/* Whether an unknown has a neighbour of its part on a level above `middle`. */
static int is_beside(const graph *g, int64_t v, int64_t middle)
{
    for (int64_t at = g->indptr[v]; at < g->indptr[v + 1]; at++) {
        const int64_t w = g->indices[at];
        if (g->part[w] == g->part[v] && g->level[w] > middle)
            return 1;
    }
    return 0;
}

/* Put a connected part, which a search from an end of it has found, into an order of two halves and
   their separator; return the count of the first half, and set that of both. */
static int64_t halve(const graph *g, int64_t *order, int64_t count, int64_t *both)
{
    const int64_t last = g->level[g->queue[count - 1]];
    const int64_t middle = dm_min(g->level[g->queue[count / 2]], last - 1);
    int64_t low = 0, high = count;
    for (int64_t i = 0; i < count; i++) {
        const int64_t v = g->queue[i];
        if (g->level[v] == middle && is_beside(g, v, middle))
            order[--high] = v;
        else if (g->level[v] <= middle)
            order[low++] = v;
    }
    int64_t at = low;
    for (int64_t i = 0; i < count; i++)
        if (g->level[g->queue[i]] > middle)
            order[at++] = g->queue[i];
    *both = high;
    return low;
}

/* Search again and again from the end of the last search, until that is no further; return how far
   it is. */
static int64_t go_to_an_end(const graph *g, int64_t count)
{
    int64_t depth = g->level[g->queue[count - 1]];
    for (int i = 0; i < SEARCHES; i++) {
        const int64_t end = g->queue[count - 1];
        forget(g, g->queue, count);
        search(g, end);
        const int64_t found = g->level[g->queue[count - 1]];
        const int deeper = found > depth;
        depth = found;
        if (!deeper)
            break;
    }
    return depth;
}

/* Parts that wait for their dissection, ranges of the order. */
typedef struct {
    int64_t *begins, *ends, waiting, parts;
} stack;

static void push(stack *s, int64_t begin, int64_t end)
{
    s->begins[s->waiting] = begin;
    s->ends[s->waiting] = end;
    s->waiting++;
}

/* Put the components of a range of the order side by side; the first has been searched. */
static void separate(const graph *g, stack *s, int64_t *order, int64_t a, int64_t b, int64_t count,
                     int64_t *old)
{
    const int64_t first = s->waiting;
    for (int64_t i = 0; i < b - a; i++)
        old[i] = order[a + i];
    int64_t at = a;
    for (int64_t i = 0; i < b - a; i++) {
        if (i > 0 && g->level[old[i]] >= 0)
            continue;
        if (i > 0)
            count = search(g, old[i]);
        for (int64_t k = 0; k < count; k++)
            order[at + k] = g->queue[k];
        push(s, at, at + count);
        at += count;
    }
    for (int64_t k = s->waiting - 1; k >= first; k--) {
        for (int64_t i = s->begins[k]; i < s->ends[k]; i++)
            g->part[order[i]] = s->parts;
        forget(g, order + s->begins[k], s->ends[k] - s->begins[k]);
        s->parts++;
    }
}

/* Fill in an order of elimination (n,) by nested dissection.

   Scratch: part, level, queue, old (n,); begins, ends (n + 2,). */
int dm_dissect(const int64_t *indptr, int64_t n, const int64_t *indices, int64_t entries,
               int64_t *order, int64_t *part, int64_t *level, int64_t *queue, int64_t *old,
               int64_t *begins, int64_t *ends)
{
    const graph g = {indptr, indices, part, level, queue};
    if (!dm_is_matrix(indptr, n, indices, entries))
        return DM_INVALID;
    const double root = DENSE * sqrt((double)n), dense = root > 100.0 ? root : 100.0;
    int64_t first = 0, last = n;
    for (int64_t v = 0; v < n; v++) {
        const int is_dense = (double)(indptr[v + 1] - indptr[v]) > dense;
        part[v] = is_dense ? DONE : 0;
        level[v] = -1;
        order[is_dense ? --last : first++] = v;
    }
    stack s = {begins, ends, 0, 1};
    push(&s, 0, last);
    while (s.waiting > 0) {
        s.waiting--;
        const int64_t a = begins[s.waiting], b = ends[s.waiting];
        if (b - a <= LEAF)
            continue;
        const int64_t count = search(&g, order[a]);
        if (count < b - a) {
            separate(&g, &s, order, a, b, count, old);
            continue;
        }
        if (go_to_an_end(&g, count) >= 2) {
            int64_t high;
            const int64_t low = halve(&g, order + a, count, &high);
            for (int64_t i = a; i < b; i++)
                part[order[i]] = i < a + low ? s.parts : (i < a + high ? s.parts + 1 : DONE);
            s.parts += 2;
            push(&s, a, a + low);
            push(&s, a + low, a + high);
        }
        forget(&g, queue, count);
    }
    return DM_OK;
}

/* Set the entries of the triangular factor for an order of elimination, a permutation (n,).

   The count stops as soon as it is above `most`. Scratch: rank, parent, ancestor, seen (n,). */
int dm_factor_entries(const int64_t *indptr, int64_t n, const int64_t *indices, int64_t entries,
                      const int64_t *order, int64_t most, int64_t *rank, int64_t *parent,
                      int64_t *ancestor, int64_t *seen, int64_t *count)
{
    if (!dm_is_matrix(indptr, n, indices, entries) || !dm_fill_ranks(order, n, rank))
        return DM_INVALID;
    dm_eliminate(indptr, n, indices, order, rank, parent, ancestor);
    for (int64_t i = 0; i < n; i++)
        seen[i] = -1;
    /* Row i of the factor has an entry at all that are on the way from its neighbours up to i. */
    *count = n;
    for (int64_t i = 0; i < n && *count <= most; i++) {
        seen[i] = i;
        for (int64_t at = indptr[order[i]]; at < indptr[order[i] + 1]; at++) {
            for (int64_t j = rank[indices[at]]; j >= 0 && j < i && seen[j] != i; j = parent[j]) {
                seen[j] = i;
                (*count)++;
            }
        }
    }
    return DM_OK;
}

/* Set the entries of A^T A, for A (m, n) by rows and by columns.

   The count stops as soon as it is above `most`. Scratch: seen (n,). */
int dm_product_entries(const int64_t *rows, int64_t m, const int64_t *row_indices, int64_t entries,
                       const int64_t *columns, int64_t n, const int64_t *column_indices,
                       int64_t most, int64_t *seen, int64_t *count)
{
    if (!dm_are_bounds(rows, m, entries) || !dm_all_in(row_indices, entries, 0, n) ||
        !dm_are_bounds(columns, n, entries) || !dm_all_in(column_indices, entries, 0, m))
        return DM_INVALID;
    for (int64_t j = 0; j < n; j++)
        seen[j] = -1;
    *count = 0;
    for (int64_t j = 0; j < n && *count <= most; j++) {
        for (int64_t at = columns[j]; at < columns[j + 1]; at++) {
            const int64_t i = column_indices[at];
            for (int64_t there = rows[i]; there < rows[i + 1]; there++) {
                const int64_t k = row_indices[there];
                if (seen[k] != j)
                    seen[k] = j, (*count)++;
            }
        }
    }
    return DM_OK;
}
