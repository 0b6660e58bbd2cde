/* Model of hidden edges, and the forest of merged triangles. */
#ifndef DELTAMESH_HIDDEN_EDGES_H
#define DELTAMESH_HIDDEN_EDGES_H

#include "integers.h"
#include "models.h"

/* The first slot of each input of the mixers: its range is indexed by its contexts. */
#define HIDDEN_RANGES(R)                                                                           \
    R(HIDE_BY_SIZES, 4 * 4 * 4 * 4)                                                                \
    R(HIDE_BY_ENDS, 20 * 20 * 4)                                                                   \
    R(HIDE_BY_APEXES, 20 * 20 * 4)                                                                 \
    R(HIDE_BY_BEYOND, 25 * 25 * 4)                                                                 \
    R(PAIR_BY_SIZE, 64)                                                                            \
    R(PAIR_BY_HISTORY, 64)                                                                         \
    R(PAIR_BY_CANDIDATE, 64)                                                                       \
    R(CHOOSE_BY_RANK, 8 * 4)                                                                       \
    R(CHOOSE_BY_SIZE, 64)
enum { HIDDEN_RANGES(DM_RANGE) HIDDEN_SLOTS };

enum { DM_HIDE_MIXER, DM_PAIR_MIXER, DM_CHOOSE_MIXER, DM_HIDDEN_MIXERS };

/* The polygons of triangles: a forest whose roots have the numbers of their corners. */
typedef struct {
    int64_t faces;
    int64_t *merged;        /* (3 faces,): the half-edge that each is merged with, -1 for none */
    int64_t *parent, *size; /* (faces,) */
} dm_polygons;

/* The triangle at the root of the polygon of one, halving the path to it. */
static inline int64_t dm_root_of(dm_polygons *p, int64_t t)
{
    for (int64_t left = p->faces; left > 0 && p->parent[t] != t; left--) {
        p->parent[t] = p->parent[p->parent[t]];
        t = p->parent[t];
    }
    return t;
}

/* Merge polygons r and s across their half-edges h and g. */
static inline void dm_join(dm_polygons *p, int64_t h, int64_t g, int64_t r, int64_t s)
{
    p->merged[h] = g, p->merged[g] = h;
    p->parent[s] = r;
    p->size[r] += p->size[s] - 2;
}

/* The class of a size, 0 to 3. */
static inline int64_t dm_corners_class(int64_t size) { return dm_clamp(size, 3, 6) - 3; }

#endif
