/* Model of the positions of anchors and isolated vertices. */
#ifndef DELTAMESH_POINTS_H
#define DELTAMESH_POINTS_H

#include "models.h"

enum { DM_POINT_LENGTHS = 64 };
enum { DM_GAP, DM_STEP }; /* mixers */

#define POINTS_RANGES(R) R(POINTS_GAP, DM_POINT_LENGTHS) R(POINTS_STEP, DM_POINT_LENGTHS)
enum { POINTS_RANGES(DM_RANGE) POINTS_SLOTS };

#endif
