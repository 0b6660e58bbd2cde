/* Panels of a factor, which two kernels walk over. */
#ifndef DELTAMESH_PANELS_H
#define DELTAMESH_PANELS_H

#include "deltamesh_core.h"

/* Whether the bounds of a plan fit each other. */
int dm_is_plan(const dm_factor_plan *p);

#endif
