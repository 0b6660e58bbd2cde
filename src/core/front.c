/* Fronts of a region; see `front.h`. */
#include "front.h"

/* Begin with an empty front for at most `capacity` nodes. */
void dm_start_front(dm_front *front, dm_node *nodes, int64_t *live, int64_t capacity)
{
    *front = (dm_front){.nodes = nodes, .live = live, .capacity = capacity, .lowest = DM_BUCKETS};
    for (int b = 0; b < DM_BUCKETS; b++)
        front->oldest[b] = front->newest[b] = -1;
}

int dm_add_node(dm_front *front, int64_t vertex, int64_t free, int64_t *node)
{
    if (front->node_count >= front->capacity || free < 0)
        return DM_INVALID;
    *node = dm_new_node(front, vertex, free);
    return DM_OK;
}

static int is_live(const dm_front *front, int64_t node)
{
    return node >= 0 && node < front->node_count && front->nodes[node].index < front->live_count &&
           front->live[front->nodes[node].index] == node;
}

int dm_remove_node(dm_front *front, int64_t node)
{
    if (!is_live(front, node))
        return DM_INVALID;
    dm_drop_node(front, node);
    return DM_OK;
}

int dm_set_free(dm_front *front, int64_t node, int64_t free)
{
    if (!is_live(front, node) || free < 0)
        return DM_INVALID;
    dm_change_free(front, node, free);
    return DM_OK;
}

int64_t dm_choose_pivot(dm_front *front) { return dm_pivot_of(front); }
