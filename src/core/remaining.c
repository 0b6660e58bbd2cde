/* Sets whose elements are used up one by one; see `remaining.h`. */
#include "remaining.h"

#include "graphs.h"

/* Fill in `sums` and `onwards` (n + 1,) of all indices below n. */
void dm_all_of(int64_t n, int64_t *sums, int64_t *onwards)
{
    for (int64_t i = 0; i <= n; i++)
        sums[i] = i & -i, onwards[i] = i;
}

int dm_remove(int64_t n, int64_t *sums, int64_t *onwards, int64_t index)
{
    dm_remaining r = {n, sums, onwards};
    if (index < 0 || index >= n || onwards[index] != index)
        return DM_INVALID;
    dm_take_away(&r, index);
    return DM_OK;
}

int dm_next_left(int64_t n, int64_t *sums, int64_t *onwards, int64_t index, int64_t *next)
{
    dm_remaining r = {n, sums, onwards};
    if (index < 0 || index > n)
        return DM_INVALID;
    *next = dm_first_left(&r, index);
    return DM_OK;
}

int dm_count_below(int64_t n, int64_t *sums, int64_t *onwards, int64_t index, int64_t *count)
{
    const dm_remaining r = {n, sums, onwards};
    if (index < 0 || index > n)
        return DM_INVALID;
    *count = dm_left_below(&r, index);
    return DM_OK;
}

int dm_select(int64_t n, int64_t *sums, int64_t *onwards, int64_t rank, int64_t *index)
{
    const dm_remaining r = {n, sums, onwards};
    if (rank < 0 || rank >= dm_left_below(&r, n))
        return DM_INVALID;
    *index = dm_of_rank(&r, rank);
    return DM_OK;
}

/* Fill in the rings of elements in ascending order; element e belongs to groups[e]. */
int dm_rings_of(const int64_t *groups, int64_t elements, int64_t count, int64_t *after,
                int64_t *before, int64_t *start)
{
    if (!dm_all_in(groups, elements, 0, count))
        return DM_INVALID;
    for (int64_t g = 0; g < count; g++)
        start[g] = -1;
    for (int64_t e = 0; e < elements; e++) {
        const int64_t first = start[groups[e]];
        if (first < 0) {
            start[groups[e]] = after[e] = before[e] = e;
        } else {
            const int64_t last = before[first];
            after[last] = e, before[e] = last;
            after[e] = first, before[first] = e;
        }
    }
    return DM_OK;
}

int dm_leave_ring(int64_t elements, int64_t count, int64_t *after, int64_t *before, int64_t *start,
                  int64_t group, int64_t element)
{
    dm_rings r = {after, before, start};
    if (group < 0 || group >= count || element < 0 || element >= elements)
        return DM_INVALID;
    dm_take_off(&r, group, element);
    return DM_OK;
}
