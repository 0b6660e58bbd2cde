/* Numbers of a format on a grid of integers, on which predictions of exact numbers are made.

   A number m * base^(e - places) of a number format is known by its index in that format. The grid
   has the integer multiples of base^-grid. */
#ifndef DELTAMESH_GRID_H
#define DELTAMESH_GRID_H

#include "integers.h"

#define DM_EXACT_BOUND ((int64_t)1 << 56) /* of the points on the grid */

/* Columns of the table of formats: the base; the places of the grid less those of the format; the
   digits; the usual length of a distance, at which the coder begins to ask. */
enum { DM_BASE, DM_OFFSET, DM_DIGITS, DM_USUAL, DM_FORMAT_SIZE };

int dm_is_format(const int64_t *format);
int64_t dm_nearest_index(const int64_t *format, int64_t point, int64_t *unit);
int64_t dm_grid_point(const int64_t *format, int64_t index);
int64_t dm_units(const int64_t *format, int64_t unit, int64_t size);

#endif
