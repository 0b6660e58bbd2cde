/* Panels of a factor, which two kernels walk over. */
#ifndef DELTAMESH_PANELS_H
#define DELTAMESH_PANELS_H

#include "deltamesh_core.h"
#include "graphs.h"
#include "supernodes.h"

/* Whether the bounds of a plan fit each other. */
static inline int dm_is_plan(const dm_factor_plan *p)
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

#endif
