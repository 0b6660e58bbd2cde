/* Fronts of a region that grows over a closed triangle mesh.

   A *node* is one appearance of a vertex on a front. Its *free* edges are those of its vertex inside
   the unvisited region that the node borders on. The *gate* from a node to its successor is an edge
   of the front, with the unvisited region on its left. All fronts are circular lists over one set of
   nodes, so that one operation on four links splits a front or merges two (see `connectivity.c`).

   Nodes wait in buckets by their free edges, and choosing a pivot takes constant time. The oldest of
   a bucket comes first: the front then stays round, which halves the joins that the newest makes.
   Nodes with more free edges share the last bucket; they are rarely the lowest. */
#ifndef DELTAMESH_FRONT_H
#define DELTAMESH_FRONT_H

#include "deltamesh_core.h"
#include "integers.h"

static inline int64_t dm_bucket(int64_t free) { return dm_clamp(free, 0, DM_BUCKETS - 1); }

static inline void dm_enqueue(dm_front *f, int64_t node)
{
    const int64_t b = dm_bucket(f->nodes[node].free), last = f->newest[b];
    f->nodes[node].older = last;
    f->nodes[node].newer = -1;
    if (last >= 0)
        f->nodes[last].newer = node;
    else
        f->oldest[b] = node;
    f->newest[b] = node;
    f->lowest = dm_min(f->lowest, b);
}

static inline void dm_dequeue(dm_front *f, int64_t node)
{
    const int64_t older = f->nodes[node].older, newer = f->nodes[node].newer;
    const int64_t b = dm_bucket(f->nodes[node].free);
    if (older >= 0)
        f->nodes[older].newer = newer;
    else
        f->oldest[b] = newer;
    if (newer >= 0)
        f->nodes[newer].older = older;
    else
        f->newest[b] = older;
}

/* Make a new live node, for which there has to be room; the caller links it. */
static inline int64_t dm_new_node(dm_front *f, int64_t vertex, int64_t free)
{
    const int64_t node = f->node_count++, index = f->live_count++;
    f->live[index] = node;
    f->nodes[node].vertex = vertex;
    f->nodes[node].free = free;
    f->nodes[node].index = index;
    dm_enqueue(f, node);
    return node;
}

/* Take a node off the buckets and the live nodes; the caller mends the front. */
static inline void dm_drop_node(dm_front *f, int64_t node)
{
    dm_dequeue(f, node);
    const int64_t last = f->live[--f->live_count], index = f->nodes[node].index;
    f->live[index] = last;
    f->nodes[last].index = index;
}

/* Change the number of free edges of a node. */
static inline void dm_change_free(dm_front *f, int64_t node, int64_t free)
{
    dm_dequeue(f, node);
    f->nodes[node].free = free;
    dm_enqueue(f, node);
}

/* Make b the successor of a, with the vertex behind the gate and the half-edge at it. */
static inline void dm_link(dm_front *f, int64_t a, int64_t b, int64_t behind, int64_t gate)
{
    f->nodes[a].successor = b;
    f->nodes[b].predecessor = a;
    f->nodes[a].behind = behind;
    f->nodes[a].gate = gate;
}

/* The oldest node with the fewest free edges, -1 when all fronts are closed. */
static inline int64_t dm_pivot_of(dm_front *f)
{
    while (f->lowest < DM_BUCKETS && f->oldest[f->lowest] < 0)
        f->lowest++;
    return f->lowest < DM_BUCKETS ? f->oldest[f->lowest] : -1;
}

#endif
