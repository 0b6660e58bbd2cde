/* One cycle of multigrid; see `cycle.c`. */
#ifndef DELTAMESH_CYCLE_H
#define DELTAMESH_CYCLE_H

#include <stdint.h>

#include "multigrid.h"

/* One level of the hierarchy. */
typedef struct {
    int64_t n;
    const int32_t *indptr, *indices, *aggregate;
    const float *weights, *diagonal, *inverse;
    const uint8_t *border; /* whether a row has neighbours in other blocks; NULL where none has */
    float *b, *x;
} dm_level;

typedef struct {
    dm_level levels[DM_MAX_LEVELS];
    int64_t count, dense;
    const double *factor;
} dm_hierarchy;

/* Steps of the cycle for the rows from `begin` to `end` of a level, which are a block: no aggregate
   goes beyond it. Blocks may take each step side by side, once all have done the one before; a sweep
   forward over several of them has to be from zero. */
void dm_sweep_forward(const dm_level *l, int64_t begin, int64_t end, int from_zero);
void dm_restrict_rows(const dm_level *l, dm_level *coarse, int64_t begin, int64_t end);
void dm_prolongate_rows(const dm_level *l, const dm_level *coarse, int64_t begin, int64_t end);
void dm_take_in_others(const dm_level *l, int64_t begin, int64_t end);
void dm_sweep_backward(const dm_level *l, int64_t begin, int64_t end);

/* Solve for x of the level above the finest, from x = 0, by one or two cycles. */
void dm_solve_coarse(dm_hierarchy *h);

#endif
