/* Outlines of polygons of merged triangles. */
#include "deltamesh_core.h"
#include "graphs.h"
#include "halfedges.h"

/* The half-edge at which the corner of a half-edge begins, over merged triangles; -1 for one in a
   ring of them, which has no beginning. */
static int64_t begin_of(const int64_t *merged, int64_t h)
{
    int64_t e = h;
    while (merged[e] >= 0) {
        e = dm_next(merged[e]);
        if (e == h)
            return -1;
    }
    return e;
}

/* List the corners of the polygons, ascending by their lowest triangles.

   merged (3 faces,): the half-edge that each is merged with, -1 for none; no triangles form a ring.
   corners (corner_count,), offsets (polygons + 1,), of_corners (3 faces,): filled in; see
   `_shape/polygons.py`. */
int dm_walk_outlines(const int64_t *merged, int64_t faces, int64_t *corners, int64_t corner_count,
                     int64_t *offsets, int64_t polygons, int64_t *of_corners)
{
    const int64_t halfedges = 3 * faces;
    int good = polygons >= 0 && dm_all_in(merged, halfedges, -1, halfedges);
    for (int64_t h = 0; good && h < halfedges; h++)
        good = merged[h] < 0 || merged[merged[h]] == h;
    if (!good)
        return DM_INVALID;
    for (int64_t h = 0; h < halfedges; h++)
        of_corners[h] = -1;
    int64_t at = 0, number = 0;
    offsets[0] = 0;
    for (int64_t t = 0; t < faces; t++) {
        if (of_corners[3 * t] >= 0)
            continue;
        int64_t start = 3 * t, most = 0;
        for (int64_t h = 3 * t; h < 3 * t + 3; h++) {
            const int64_t e = begin_of(merged, h); /* to where the corner begins, then over it */
            int64_t meeting = 1;
            if (e < 0)
                return DM_INVALID;
            for (int64_t f = e; merged[dm_previous(f)] >= 0; meeting++)
                f = merged[dm_previous(f)];
            if (meeting > most)
                start = e, most = meeting;
        }
        if (number == polygons)
            return DM_INVALID;
        for (int64_t e = start;;) {
            if (at == corner_count)
                return DM_INVALID;
            corners[at] = e;
            of_corners[e] = at;
            for (int64_t f = e; merged[dm_previous(f)] >= 0;) {
                f = merged[dm_previous(f)];
                of_corners[f] = at;
            }
            at++;
            e = begin_of(merged, dm_next(e));
            if (e < 0)
                return DM_INVALID;
            if (e == start)
                break;
        }
        offsets[++number] = at;
    }
    return at == corner_count && number == polygons ? DM_OK : DM_INVALID;
}
