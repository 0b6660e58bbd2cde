/* Tree of bounding boxes over triangles. */
#ifndef DELTAMESH_CLOSEST_H
#define DELTAMESH_CLOSEST_H

#include "deltamesh_core.h"

enum { DM_LEAF = 4 }; /* triangles of a leaf */

#endif
