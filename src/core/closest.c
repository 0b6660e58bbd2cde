/* Distance from points to a triangle mesh, by a tree of bounding boxes.

   The tree is a complete binary one over the triangles in spatial order: node i has children 2 i + 1
   and 2 i + 2, the leaves hold DM_LEAF triangles each, and what pads the last level has empty boxes.
   Point against triangle: C. Ericson, "Real-Time Collision Detection", 2005, section 5.1.5,
   rearranged so that triangles without area need no division. */
#include "closest.h"

#include <math.h>

#include "integers.h"
#include "vectors.h"

/* A path from the root leaves one sibling a level on the stack: 64 is more than any tree has. */
enum { STACK = 64 };

static double larger(double a, double b) { return a > b ? a : b; }

static double smaller(double a, double b) { return a < b ? a : b; }

/* The squared distance from point p to the segment ab. */
static double squared_to_segment(const double *p, const double *a, const double *b)
{
    double length = 0.0, along = 0.0, total = 0.0;
    for (int c = 0; c < 3; c++) {
        length += (b[c] - a[c]) * (b[c] - a[c]);
        along += (p[c] - a[c]) * (b[c] - a[c]);
    }
    const double t = length > 0.0 ? smaller(larger(along / length, 0.0), 1.0) : 0.0;
    for (int c = 0; c < 3; c++) {
        const double d = p[c] - a[c] - t * (b[c] - a[c]);
        total += d * d;
    }
    return total;
}

/* (a - o) x (b - o). */
static dm_vector cross(const double *o, const double *a, const double *b)
{
    return dm_cross(dm_from_to(o, a), dm_from_to(o, b));
}

/* The squared distance from point p to the triangle abc: to its plane where p projects into the
   triangle, else to the nearest edge. */
double dm_squared_to_triangle(const double *p, const double *a, const double *b, const double *c)
{
    const dm_vector n = cross(a, b, c);
    const double area = dm_dot(n, n);
    if (area > 0.0 && dm_dot(n, cross(a, b, p)) >= 0.0 && dm_dot(n, cross(b, c, p)) >= 0.0 &&
        dm_dot(n, cross(c, a, p)) >= 0.0) {
        const double height = dm_dot(n, dm_from_to(a, p));
        return height * height / area;
    }
    return smaller(smaller(squared_to_segment(p, a, b), squared_to_segment(p, b, c)),
                   squared_to_segment(p, c, a));
}

/* The squared distance from point p to a box; infinite when the box is empty. */
static double squared_to_box(const double *p, const double *low, const double *high)
{
    double total = 0.0;
    for (int c = 0; c < 3; c++) {
        const double d = larger(larger(low[c] - p[c], p[c] - high[c]), 0.0);
        total += d * d;
    }
    return total;
}

static int is_tree(int64_t triangles, int64_t nodes)
{
    const int64_t leaves = (nodes + 1) / 2;
    return nodes >= 1 && nodes % 2 == 1 && (leaves & (leaves - 1)) == 0 &&
           triangles <= DM_LEAF * leaves;
}

/* Fill the boxes (nodes, 3) of the tree over triangles (count, 3, 3) in the order of the leaves. */
int dm_fill_boxes(const double *triangles, int64_t count, double *low, double *high, int64_t nodes)
{
    const int64_t leaves = (nodes + 1) / 2;
    if (!is_tree(count, nodes))
        return DM_INVALID;
    for (int64_t k = 0; k < 3 * nodes; k++)
        low[k] = INFINITY, high[k] = -INFINITY;
    for (int64_t t = 0; t < count; t++) {
        const int64_t node = leaves - 1 + t / DM_LEAF;
        for (int k = 0; k < 9; k++) {
            low[3 * node + k % 3] = smaller(low[3 * node + k % 3], triangles[9 * t + k]);
            high[3 * node + k % 3] = larger(high[3 * node + k % 3], triangles[9 * t + k]);
        }
    }
    for (int64_t node = leaves - 2; node >= 0; node--) {
        const int64_t left = 3 * (2 * node + 1), right = left + 3;
        for (int c = 0; c < 3; c++) {
            low[3 * node + c] = smaller(low[left + c], low[right + c]);
            high[3 * node + c] = larger(high[left + c], high[right + c]);
        }
    }
    return DM_OK;
}

/* Triangles and the boxes over them. */
typedef struct {
    const double *triangles;
    int64_t count;
    const double *low, *high;
    int64_t nodes;
} tree;

static double to_box(const tree *t, const double *p, int64_t node)
{
    return squared_to_box(p, t->low + 3 * node, t->high + 3 * node);
}

/* The squared distance from p to the nearest triangle.

   `bound` is a known upper bound. The search stops as soon as the distance is known to be at most
   `enough`, and returns an upper bound not above it. */
static double squared_to_mesh(const tree *m, const double *p, double bound, double enough)
{
    const int64_t leaves = (m->nodes + 1) / 2;
    int64_t stack[STACK] = {0};
    int top = 1;
    while (top > 0 && bound > enough) {
        const int64_t node = stack[--top];
        if (to_box(m, p, node) >= bound)
            continue;
        if (node < leaves - 1) {
            const int64_t left = 2 * node + 1, right = left + 1;
            const int swap = to_box(m, p, left) <= to_box(m, p, right);
            stack[top++] = swap ? right : left;
            stack[top++] = swap ? left : right;
            continue;
        }
        const int64_t first = (node - leaves + 1) * DM_LEAF;
        for (int64_t t = first; t < dm_min(first + DM_LEAF, m->count); t++) {
            const double *const corners = m->triangles + 9 * t;
            bound = smaller(dm_squared_to_triangle(p, corners, corners + 3, corners + 6), bound);
        }
    }
    return bound;
}

/* Set `largest` to the largest squared distance from the points (count, 3) to the mesh, if larger.

   A point whose distance cannot be the largest is left as soon as that is known; bounds (count,) are
   upper bounds of the points' squared distances. A. A. Taha, A. Hanbury, "An efficient algorithm for
   calculating the exact Hausdorff distance", IEEE TPAMI 37(11), 2015 ("early breaking"). */
int dm_largest_squared_distance(const double *points, const double *bounds, int64_t count,
                                const double *triangles, int64_t triangle_count, const double *low,
                                const double *high, int64_t nodes, double *largest)
{
    const tree mesh = {triangles, triangle_count, low, high, nodes};
    if (!is_tree(triangle_count, nodes))
        return DM_INVALID;
    for (int64_t i = 0; i < count; i++)
        if (bounds[i] > *largest)
            *largest = larger(squared_to_mesh(&mesh, points + 3 * i, bounds[i], *largest), *largest);
    return DM_OK;
}
