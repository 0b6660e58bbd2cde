/* Rotation of a polygon: the corner at which it begins.

   It is a corner of the triangle that represents the polygon, coded relative to one that the ranks of
   its vertices single out, or some corners after that. */
#ifndef DELTAMESH_ROTATION_H
#define DELTAMESH_ROTATION_H

#include "steps.h"

/* What rotations are coded with: the ranks of vertices, -1 without one; the kind of anchors; the
   vertices of the last two faces, as they came, -1 at first; the last rotation and whether the last
   two were those of the file; the last answers about skipped corners. */
typedef struct {
    const int64_t *rank;
    int64_t mode, recent[2][3], rotated[2], skips;
} dm_rotations;

/* The rank of a vertex, DM_NO_RANK without one. */
static inline int64_t dm_rank_of(const int64_t *rank, int64_t v)
{
    return rank[v] >= 0 ? rank[v] : DM_NO_RANK;
}

/* The corner of a face (3,) that is its anchor, the first of equals. */
static inline int64_t dm_anchor_corner(const int64_t *face, const int64_t *rank, int64_t mode,
                                       int64_t rotation)
{
    if (mode == DM_FIRST)
        return rotation;
    int64_t best = 0;
    for (int64_t j = 1; j < 3; j++) {
        const int64_t newer = rank[face[j]], old = rank[face[best]];
        if (mode == DM_NEWEST ? newer > old : newer >= 0 && (old < 0 || newer < old))
            best = j;
    }
    return best;
}

int64_t dm_code_skipped(dm_coder *c, dm_rotations *r, const int64_t *corners, int64_t size,
                        int64_t at, int64_t gap, int64_t skipped);
int64_t dm_code_rotation(dm_coder *c, dm_rotations *r, const int64_t *face, int64_t rotation);

#endif
