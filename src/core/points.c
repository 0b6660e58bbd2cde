/* Positions of anchors and isolated vertices, which are stored beside the deltas. */
#include "coder.h"
#include "points.h"

/* Code a number >= 0; -1 for one beyond 63 bits. */
static int64_t code_count(dm_coder *c, int64_t value, int64_t kind)
{
    const int64_t first = kind == DM_GAP ? POINTS_GAP : POINTS_STEP;
    const int64_t number = dm_code_number(c, value + 1, first, kind, DM_POINT_LENGTHS - 1);
    return number < 1 ? -1 : number - 1;
}

/* Code ascending indices below n, filled in when decoding. */
int dm_code_gaps(dm_coder *c, int64_t *indices, int64_t count, int64_t n)
{
    if (!dm_has_memory(c, POINTS_SLOTS, 2))
        return DM_INVALID;
    int64_t previous = -1;
    for (int64_t k = 0; k < count; k++) {
        const int64_t gap = code_count(c, indices[k] - previous - 1, DM_GAP);
        if (gap < 0 || gap > n - previous - 2)
            return DM_CORRUPT;
        indices[k] = previous + 1 + gap;
        previous = indices[k];
    }
    return DM_OK;
}

static int has_bits(const int64_t *bits)
{
    return bits[0] >= 0 && bits[0] < 63 && bits[1] >= 0 && bits[1] < 63 && bits[2] >= 0 &&
           bits[2] < 63;
}

/* Code `points` (count, 3), filled in when decoding, in `bits` (3,) and `extra` (count,) bits each. */
int dm_code_points(dm_coder *c, int64_t *points, int64_t count, const int64_t *bits,
                   const int64_t *extra)
{
    if (!has_bits(bits))
        return DM_INVALID;
    for (int64_t k = 0; k < count; k++) {
        for (int axis = 0; axis < 3; axis++) {
            const int64_t length = dm_add(bits[axis], extra[k]);
            if (length < 0 || length > 63)
                return DM_INVALID;
            points[3 * k + axis] = dm_code_raw(c, points[3 * k + axis], length);
        }
    }
    return DM_OK;
}

/* Code `points` (count, 3) in ascending order of x, as steps in x. */
int dm_code_sorted_points(dm_coder *c, int64_t *points, int64_t count, const int64_t *bits)
{
    if (!dm_has_memory(c, POINTS_SLOTS, 2) || !has_bits(bits))
        return DM_INVALID;
    int64_t x = 0;
    for (int64_t k = 0; k < count; k++) {
        const int64_t step = code_count(c, points[3 * k] - x, DM_STEP);
        if (step < 0 || step >= ((int64_t)1 << bits[0]) - x)
            return DM_CORRUPT;
        x += step;
        points[3 * k] = x;
        for (int axis = 1; axis < 3; axis++)
            points[3 * k + axis] = dm_code_raw(c, points[3 * k + axis], bits[axis]);
    }
    return DM_OK;
}
