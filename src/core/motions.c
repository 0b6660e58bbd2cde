/* Motions of anchors: how each is displaced and turned, as small integers along a tree.

   An anchor is taken to follow the rigid motion of its parent, and integers say what is left: where
   a part moves as one body, or not at all, they are zero.

   Rotations are unit quaternions w, x, y, z. What one turns further than its parent is coded as the
   modified Rodrigues parameters of T. F. Wiener, tan(angle / 4) along the axis: every vector is a
   rotation, and no root or trigonometry decodes it. */
#include "deltamesh_core.h"
#include "graphs.h"
#include "vectors.h"

/* Mark in `kept` (count,) the edges (a, b) between n nodes that join two trees, in their order: the
   forest of J. B. Kruskal, 1956. Scratch: root (n,). */
int dm_span(const int64_t *a, const int64_t *b, int64_t count, int64_t n, uint8_t *kept,
            int64_t *root)
{
    if (n < 0 || !dm_all_in(a, count, 0, n) || !dm_all_in(b, count, 0, n))
        return DM_INVALID;
    for (int64_t v = 0; v < n; v++)
        root[v] = v;
    for (int64_t e = 0; e < count; e++) {
        int64_t v = a[e], w = b[e];
        while (root[v] != v)
            v = root[v] = root[root[v]];
        while (root[w] != w)
            w = root[w] = root[root[w]];
        kept[e] = v != w;
        root[v < w ? w : v] = v < w ? v : w;
    }
    return DM_OK;
}

/* Walk through trees, each from its lowest node, breadth first: set `order` (n,) to the nodes as
   they are met, and `parent` (n,) to the node from which each was, -1 for the first of a tree. */
int dm_walk_forest(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                   int64_t *order, int64_t *parent)
{
    if (!dm_is_graph(indptr, n, indices, entries))
        return DM_INVALID;
    int64_t head = 0, tail = 0;
    for (int64_t v = 0; v < n; v++)
        parent[v] = -2;
    for (int64_t first = 0; first < n; first++) {
        if (parent[first] != -2)
            continue;
        parent[first] = -1;
        order[tail++] = first;
        for (; head < tail; head++) {
            const int64_t v = order[head];
            for (int64_t at = indptr[v]; at < indptr[v + 1]; at++)
                if (parent[indices[at]] == -2)
                    parent[indices[at]] = v, order[tail++] = indices[at];
        }
    }
    return DM_OK;
}

/* A quaternion w + v. */
typedef struct {
    double w;
    dm_vector v;
} quaternion;

static quaternion product(quaternion p, quaternion q)
{
    const dm_vector c = dm_cross(p.v, q.v);
    return (quaternion){p.w * q.w - dm_dot(p.v, q.v),
                        {p.w * q.v.x + q.w * p.v.x + c.x, p.w * q.v.y + q.w * p.v.y + c.y,
                         p.w * q.v.z + q.w * p.v.z + c.z}};
}

/* The vector v, turned by a unit quaternion: v + 2 q x (q x v + w v). */
static dm_vector turned(quaternion q, dm_vector v)
{
    const dm_vector c = dm_cross(q.v, v);
    const dm_vector d = dm_cross(
        q.v, (dm_vector){c.x + q.w * v.x, c.y + q.w * v.y, c.z + q.w * v.z});
    return (dm_vector){v.x + 2.0 * d.x, v.y + 2.0 * d.y, v.z + 2.0 * d.z};
}

static quaternion quaternion_of(const double *row)
{
    return (quaternion){row[0], {row[1], row[2], row[3]}};
}

/* Set the numbers (6,) of a motion: how far `position` is from where the parent takes it, in steps,
   and what `q` turns further than `before`, in units. */
static void measure(const double *position, dm_vector base, double step, quaternion q,
                    quaternion before, double unit, int64_t *numbers)
{
    const quaternion back = {before.w, {-before.v.x, -before.v.y, -before.v.z}};
    quaternion left = product(q, back);
    if (left.w < 0.0)
        left = (quaternion){-left.w, {-left.v.x, -left.v.y, -left.v.z}};
    const double share = 1.0 / ((1.0 + left.w) * unit);
    numbers[0] = (int64_t)rint((position[0] - base.x) / step);
    numbers[1] = (int64_t)rint((position[1] - base.y) / step);
    numbers[2] = (int64_t)rint((position[2] - base.z) / step);
    numbers[3] = (int64_t)rint(left.v.x * share);
    numbers[4] = (int64_t)rint(left.v.y * share);
    numbers[5] = (int64_t)rint(left.v.z * share);
}

/* Take n nodes from `rest` (n, 3) to `positions` (n, 3), and set their quaternions (n, 4), by the
   numbers (n, 6) of their motions; nodes are in an `order` in which parents come first.

   If `measuring`, positions and quaternions are those to come near to, and set the numbers first;
   the caller has seen to it that these are of 63 bits. */
int dm_carry_motions(const int64_t *order, const int64_t *parent, int64_t n, const double *rest,
                     double step, double unit, int64_t measuring, int64_t *numbers,
                     double *positions, double *quaternions)
{
    if (n < 0 || !dm_all_in(order, n, 0, n) || !dm_all_in(parent, n, -1, n))
        return DM_INVALID;
    for (int64_t i = 0; i < n; i++) {
        const int64_t v = order[i], p = parent[v];
        dm_vector base = dm_row(rest, v);
        quaternion before = {1.0, {0.0, 0.0, 0.0}};
        if (p >= 0) {
            before = quaternion_of(quaternions + 4 * p);
            const dm_vector arm = turned(before, dm_from_to(rest + 3 * p, rest + 3 * v));
            const double *const at = positions + 3 * p;
            base = (dm_vector){at[0] + arm.x, at[1] + arm.y, at[2] + arm.z};
        }
        int64_t *const own = numbers + 6 * v;
        if (measuring)
            measure(positions + 3 * v, base, step, quaternion_of(quaternions + 4 * v), before, unit,
                    own);
        const dm_vector m = {(double)own[3] * unit, (double)own[4] * unit, (double)own[5] * unit};
        const double square = dm_dot(m, m), divisor = 1.0 + square;
        const quaternion further = {(1.0 - square) / divisor, dm_multiple(m, 2.0 / divisor)};
        const quaternion q = product(further, before);
        dm_set_row(positions, v,
                   (dm_vector){base.x + (double)own[0] * step, base.y + (double)own[1] * step,
                               base.z + (double)own[2] * step});
        quaternions[4 * v] = q.w;
        dm_set_row(quaternions + 4 * v + 1, 0, q.v);
    }
    return DM_OK;
}
