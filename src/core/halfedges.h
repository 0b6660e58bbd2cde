/* Half-edges of triangles. Half-edge h = 3 f + c >= 0 runs from corner c of face f to the next one.

   The rest of a division by 3 takes one multiplication without a sign, and four steps with it. */
#ifndef DELTAMESH_HALFEDGES_H
#define DELTAMESH_HALFEDGES_H

#include <stdint.h>

/* The half-edge that follows in the same face. */
static inline int64_t dm_next(int64_t h) { return (uint64_t)h % 3 == 2 ? h - 2 : h + 1; }

/* The half-edge that precedes in the same face. */
static inline int64_t dm_previous(int64_t h) { return (uint64_t)h % 3 == 0 ? h + 2 : h - 1; }

#endif
