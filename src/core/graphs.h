/* Checks of arrays before a kernel walks along them. */
#ifndef DELTAMESH_GRAPHS_H
#define DELTAMESH_GRAPHS_H

#include <stdint.h>

/* Whether all of `count` numbers are in [low, end). */
static inline int dm_all_in(const int64_t *numbers, int64_t count, int64_t low, int64_t end)
{
    /* One comparison a number: those below `low` are large without a sign. */
    const uint64_t range = (uint64_t)end - (uint64_t)low;
    int good = 1;
    for (int64_t i = 0; i < count; i++)
        good &= (uint64_t)numbers[i] - (uint64_t)low < range;
    return end >= low ? good : count == 0;
}

/* Whether `bounds` (rows + 1,) ascend from 0 to `entries`. */
static inline int dm_are_bounds(const int64_t *bounds, int64_t rows, int64_t entries)
{
    int good = rows >= 0 && bounds[0] == 0 && bounds[rows] == entries;
    for (int64_t i = 0; i < rows; i++)
        good &= bounds[i] <= bounds[i + 1];
    return good;
}

/* Whether `numbers` (count,) are those below count, each once; `seen` (count,) is scratch. */
static inline int dm_is_permutation(const int64_t *numbers, int64_t count, int64_t *seen)
{
    if (!dm_all_in(numbers, count, 0, count))
        return 0;
    for (int64_t i = 0; i < count; i++)
        seen[i] = 0;
    for (int64_t i = 0; i < count; i++)
        if (seen[numbers[i]]++ > 0)
            return 0;
    return 1;
}

/* Whether rows of entries are those of a matrix of n columns, or of anything else that may have more
   than 2^31 of them. */
static inline int dm_is_matrix(const int64_t *indptr, int64_t n, const int64_t *indices,
                               int64_t entries)
{
    return dm_are_bounds(indptr, n, entries) && dm_all_in(indices, entries, 0, n);
}

/* As dm_all_in and dm_are_bounds, of 32 bits: what graphs and parallelograms have, which are the
   most of what a kernel reads. */
static inline int dm_are_shorts_in(const int32_t *numbers, int64_t count, int64_t low, int64_t end)
{
    int good = 1;
    for (int64_t i = 0; i < count; i++)
        good &= numbers[i] >= low && numbers[i] < end;
    return good;
}

static inline int dm_are_short_bounds(const int32_t *bounds, int64_t rows, int64_t entries)
{
    int good = rows >= 0 && bounds[0] == 0 && bounds[rows] == entries;
    for (int64_t i = 0; i < rows; i++)
        good &= bounds[i] <= bounds[i + 1];
    return good;
}

/* Whether rows of neighbours are those of a graph of n vertices. */
static inline int dm_is_graph(const int32_t *indptr, int64_t n, const int32_t *indices,
                              int64_t entries)
{
    return n < INT32_MAX && dm_are_short_bounds(indptr, n, entries) &&
           dm_are_shorts_in(indices, entries, 0, n);
}

#endif
