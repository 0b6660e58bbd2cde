/* Normals of the vertices of a surface. */
#include "deltamesh_core.h"
#include "graphs.h"
#include "vectors.h"

/* Set `normals` (n, 3) to s / (|s| + fade (a + step^2)), s the sum of the cross products of the faces
   (m, 3) around each vertex of `points` (n, 3), and a that of their lengths.

   The steps are those of all vertices, (1,), or of each, (n,). Above `most` extents of the surface, a
   step counts as that many. Lengths are divided by the extent: products then neither overflow nor
   vanish. Each sum is in the order of the faces: bytes depend on it. Scratch: areas (n,). */
int dm_vertex_normals(const double *points, int64_t n, const int64_t *faces, int64_t m,
                      const double *steps, int64_t step_count, double most, double fade,
                      double *normals, double *areas)
{
    if (!dm_all_in(faces, 3 * m, 0, n) || (step_count != 1 && step_count != n))
        return DM_INVALID;
    const double extent = dm_extent(points, n);
    for (int64_t v = 0; v < n; v++)
        normals[3 * v] = normals[3 * v + 1] = normals[3 * v + 2] = areas[v] = 0.0;
    for (int64_t f = 0; f < m; f++) {
        const int64_t *const face = faces + 3 * f;
        const double *const a = points + 3 * face[0];
        const dm_vector left = dm_over(dm_from_to(a, points + 3 * face[1]), extent);
        const dm_vector right = dm_over(dm_from_to(a, points + 3 * face[2]), extent);
        const dm_vector normal = dm_cross(left, right);
        const double area = dm_length(normal);
        for (int i = 0; i < 3; i++) {
            double *const sum = normals + 3 * face[i];
            sum[0] += normal.x;
            sum[1] += normal.y;
            sum[2] += normal.z;
            areas[face[i]] += area;
        }
    }
    for (int64_t v = 0; v < n; v++) {
        const dm_vector sum = dm_row(normals, v);
        const double extents = steps[step_count > 1 ? v : 0] / extent;
        const double step = extents < most ? extents : most;
        const double length = dm_length(sum) + fade * (areas[v] + step * step);
        dm_set_row(normals, v, dm_over(sum, length));
    }
    return DM_OK;
}
