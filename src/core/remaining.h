/* Sets whose elements are used up one by one: the rest in order of index, and in rings.

   Counts are in a tree of partial sums (Fenwick, "A new data structure for cumulative frequency
   tables", 1994), the next index that is left is found by path halving (Tarjan, van Leeuwen, 1984).
   A ring is a circular list of those elements of a group that are left, with an element to begin
   at. */
#ifndef DELTAMESH_REMAINING_H
#define DELTAMESH_REMAINING_H

#include "deltamesh_core.h"

/* The indices below n that are left. */
typedef struct {
    int64_t n;
    int64_t *sums;    /* (n + 1,): sums[i] counts those among the last (i & -i) below i */
    int64_t *onwards; /* (n + 1,): an index not above the next that is left; itself if left, or n */
} dm_remaining;

/* The rings of some groups. */
typedef struct {
    int64_t *after, *before; /* (e,): the neighbours of an element on its ring */
    int64_t *start;          /* (g,): an element of each group, -1 when none is left */
} dm_rings;

/* Take away an index that is left. */
static inline void dm_take_away(dm_remaining *r, int64_t index)
{
    r->onwards[index] = index + 1;
    for (int64_t i = index + 1; i <= r->n; i += i & -i)
        r->sums[i]--;
}

static inline int64_t dm_end_of_path(dm_remaining *r, int64_t i)
{
    while (r->onwards[i] != i) {
        r->onwards[i] = r->onwards[r->onwards[i]];
        i = r->onwards[i];
    }
    return i;
}

/* The lowest index left that is not below `index`, else the lowest; there is one. */
static inline int64_t dm_first_left(dm_remaining *r, int64_t index)
{
    const int64_t i = dm_end_of_path(r, index);
    return i == r->n ? dm_end_of_path(r, 0) : i;
}

/* How many are left below `index`. */
static inline int64_t dm_left_below(const dm_remaining *r, int64_t index)
{
    int64_t total = 0;
    for (int64_t i = index; i > 0; i -= i & -i)
        total += r->sums[i];
    return total;
}

/* The index below which `rank` are left, itself left; `rank` is below their number. */
static inline int64_t dm_of_rank(const dm_remaining *r, int64_t rank)
{
    int64_t step = 1, at = 0;
    while (2 * step <= r->n)
        step *= 2;
    for (; step > 0; step >>= 1) {
        if (at + step <= r->n && r->sums[at + step] <= rank) {
            at += step;
            rank -= r->sums[at];
        }
    }
    return at;
}

/* Take an element off its ring, which then begins after it. */
static inline void dm_take_off(dm_rings *r, int64_t group, int64_t element)
{
    const int64_t following = r->after[element], previous = r->before[element];
    if (following == element) {
        r->start[group] = -1;
        return;
    }
    r->after[previous] = following, r->before[following] = previous;
    r->start[group] = following;
}

#endif
