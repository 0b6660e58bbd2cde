/* Differences of a mesh from a reference with the same faces: of each vertex, face and edge.

   They are computed from differences of positions, so that nothing is lost far from the origin, in a
   unit near their size. Angles are in degrees.

   Change of dihedral angles: L. Vasa, J. Rus, "Dihedral Angle Mesh Error: a fast perception
   correlated distortion measure for fixed connectivity triangle meshes", Comput. Graph. Forum 31(5),
   2012. */
#include "deltamesh_core.h"

#include <string.h>

#include "graphs.h"
#include "halfedges.h"
#include "vectors.h"

/* Powers of two from 2^-1000 to 2^1000 are taken: the inverses of all of them are doubles, too. */
enum { MOST_EXPONENT = 1000 };

static const double DEGREES = 180.0 / 3.14159265358979323846;

/* The angle between vectors of any length, 0 for zero vectors. */
static double angle_between(dm_vector v, dm_vector w)
{
    return atan2(dm_length(dm_cross(v, w)), dm_dot(v, w)) * DEGREES;
}

/* 2 to the power of an exponent up to MOST_EXPONENT; `ldexp` takes several times as long. */
static double power(int exponent)
{
    const uint64_t bits = (uint64_t)(exponent + 1023) << 52;
    double value;
    memcpy(&value, &bits, sizeof(value));
    return value;
}

/* A vector whose largest number is 1/2 to 1, to the last bit, and the power of two that it lacks.

   Beyond the powers that are taken, the last of them is: for a zero vector, say. */
static dm_vector scaled(dm_vector v, int *exponent)
{
    const double x = fabs(v.x), y = fabs(v.y), z = fabs(v.z);
    const double largest = x > y ? (x > z ? x : z) : (y > z ? y : z);
    uint64_t bits;
    memcpy(&bits, &largest, sizeof(bits));
    const int found = (int)(bits >> 52) - 1022;
    const int most = found < MOST_EXPONENT ? found : MOST_EXPONENT;
    *exponent = most > -MOST_EXPONENT ? most : -MOST_EXPONENT;
    return dm_multiple(v, power(-*exponent));
}

/* Set `normals` (m, 3) of the faces (m, 3) over points (n, 3), of any length, and `areas` (m,), twice
   the areas in the square unit.

   The sides of a face are scaled by themselves: that of others may be 1e150 times as long. */
int dm_face_normals(const double *points, int64_t n, const int64_t *faces, int64_t m, double unit,
                    double *normals, double *areas)
{
    if (!dm_all_in(faces, 3 * m, 0, n))
        return DM_INVALID;
    for (int64_t f = 0; f < m; f++) {
        const int64_t *const face = faces + 3 * f;
        const double *const a = points + 3 * face[0];
        int i, j;
        const dm_vector left = scaled(dm_over(dm_from_to(a, points + 3 * face[1]), unit), &i);
        const dm_vector right = scaled(dm_over(dm_from_to(a, points + 3 * face[2]), unit), &j);
        const dm_vector normal = dm_cross(left, right);
        dm_set_row(normals, f, normal);
        const int half = (i + j) / 2; /* the product of halves is exact, or beyond all doubles */
        areas[f] = dm_length(normal) * power(half) * power(i + j - half);
    }
    return DM_OK;
}

/* Set `distances` (n,) in the unit from the points (n, 3) of a reference to others. */
int dm_distances(const double *points, const double *others, int64_t n, double unit,
                 double *distances)
{
    for (int64_t v = 0; v < n; v++)
        distances[v] = dm_length(dm_over(dm_from_to(points + 3 * v, others + 3 * v), unit));
    return DM_OK;
}

/* Set the angles (m,) between the normals of a reference and others, 90 where one of the latter is a
   zero vector, and the flags (m,) of the faces that are lost or turned.

   A face is lost if it had an area, of which less than the share `least` is left; and turned if it
   had one, is not lost, and its angle is above `most`. */
int dm_face_changes(const double *normals, const double *areas, const double *other_normals,
                    const double *other_areas, int64_t m, double least, double most,
                    double *angles, uint8_t *lost, uint8_t *turned)
{
    for (int64_t f = 0; f < m; f++) {
        const dm_vector normal = dm_row(normals, f), other = dm_row(other_normals, f);
        const int is_flat = other.x == 0.0 && other.y == 0.0 && other.z == 0.0;
        angles[f] = is_flat ? 90.0 : angle_between(normal, other);
        lost[f] = areas[f] > 0.0 && other_areas[f] < least * areas[f];
        turned[f] = areas[f] > 0.0 && !lost[f] && angles[f] > most;
    }
    return DM_OK;
}

/* Set `angles` (count,) from the normals of the left faces to those of the right ones at edges of
   the faces (m, 3) over points (n, 3): positive where the surface is convex.

   `normals` (m, 3) are those of the faces. An edge is a pair of half-edges, in `pairs` (count, 2), of
   the left face and of the right one. Where both run in the same direction, one of the two faces is
   turned over. */
int dm_dihedral_angles(const double *points, int64_t n, const double *normals,
                       const int64_t *faces, int64_t m, const int32_t *pairs, int64_t count,
                       double *angles)
{
    if (!dm_all_in(faces, 3 * m, 0, n) || !dm_are_shorts_in(pairs, 2 * count, 0, 3 * m))
        return DM_INVALID;
    for (int64_t e = 0; e < count; e++) {
        const int64_t left = pairs[2 * e], right = pairs[2 * e + 1];
        const int64_t start = faces[left], same = start == faces[right];
        const double *const a = points + 3 * start, *const b = points + 3 * faces[dm_next(left)];
        const dm_vector normal = dm_row(normals, left / 3);
        const dm_vector other = dm_multiple(dm_row(normals, right / 3), same ? -1.0 : 1.0);
        const dm_vector axis = dm_cross(normal, other);
        const double angle = angle_between(normal, other);
        angles[e] = dm_dot(axis, dm_from_to(a, b)) < 0.0 ? -angle : angle;
    }
    return DM_OK;
}
