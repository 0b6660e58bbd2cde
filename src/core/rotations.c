/* Rotations of neighbourhoods: how the edges around each vertex turn from one surface to another.

   The rotation R that takes vectors a best to vectors b has the largest sum of b . R a, which is
   q^T K q for its unit quaternion q: K, 4 x 4, is linear in the sum C of b a^T (Davenport; B. K. P.
   Horn, "Closed-form solution of absolute orientation using unit quaternions", JOSA A 4, 1987).

   The largest eigenvector of K is the answer where it is alone, but where all vectors are along one
   line, or there are none, others are as good, and noise decides. So the mean of all rotations is
   taken here, each weighted by what it is worth to a high power: R is linear in q q^T, and the mean
   of that is K, made positive, squared again and again. It is the best rotation to the last digit
   where there is one. Where some are equally good, their mean takes the vectors that are known to
   the same places as each of them does, and nothing jumps: a mean changes by the power times the
   change of K at the most.

   Turned deltas are those of Y. Lipman, O. Sorkine, D. Levin, D. Cohen-Or, "Linear rotation-invariant
   coordinates for meshes", SIGGRAPH 2005, about the edges of a vertex rather than its frame. */
#include "deltamesh_core.h"
#include "graphs.h"
#include "vectors.h"

/* The power is 2 to that. */
enum { SQUARINGS = 14 };

/* Weight of the identity, in terms of all that is known, where vectors are along one line: enough to
   say what nothing else does. */
static const double LINE = 0x1p-10;
/* Share of a second direction below which vectors are along one line. */
static const double THIN = 1e-4;
/* Ratio of squared lengths below which vectors have collapsed, and no longer say how they turned. */
static const double COLLAPSED = 1e-2;
/* A product of lengths that says nothing, in squares of the extent of a surface. */
static const double NOTHING = 1e-14;

/* Numbers of a neighbourhood: C by rows, and the sums of the squares of a and of b. */
enum { MOMENTS = 11 };

/* Square a symmetric matrix, and divide it by the trace of the result. */
static void square(double k[4][4])
{
    double product[4][4];
    for (int i = 0; i < 4; i++)
        for (int j = i; j < 4; j++)
            product[i][j] = k[i][0] * k[0][j] + k[i][1] * k[1][j] + k[i][2] * k[2][j] +
                            k[i][3] * k[3][j];
    const double trace = product[0][0] + product[1][1] + product[2][2] + product[3][3];
    for (int i = 0; i < 4; i++)
        for (int j = i; j < 4; j++)
            k[i][j] = k[j][i] = product[i][j] / trace;
}

/* Set `turn` (9,) to the rotation nearest to the moments (11,) of a neighbourhood. */
static void turn_of(const double *moments, double *turn)
{
    const double known = sqrt(moments[9] * moments[10]), all = known + NOTHING;
    const double collapsed = COLLAPSED / (COLLAPSED + known / (moments[9] + moments[10] + NOTHING));
    const double squared = collapsed * collapsed, nothing = squared * squared * squared;
    double c[9];
    for (int i = 0; i < 9; i++)
        c[i] = (1.0 - nothing) * moments[i] / all;
    const dm_vector x = dm_row(c, 0), y = dm_row(c, 1), z = dm_row(c, 2);
    const dm_vector yz = dm_cross(y, z), zx = dm_cross(z, x), xy = dm_cross(x, y);
    const double second = sqrt(dm_dot(yz, yz) + dm_dot(zx, zx) + dm_dot(xy, xy));
    const double thin = THIN / (THIN + second);
    const double identity = LINE * thin * thin + NOTHING / all + nothing;
    c[0] += identity, c[4] += identity, c[8] += identity;

    const double shift = 1.0 + LINE; /* no eigenvalue of K is below its negative */
    double k[4][4];
    k[0][0] = shift + c[0] + c[4] + c[8];
    k[1][1] = shift + c[0] - c[4] - c[8];
    k[2][2] = shift - c[0] + c[4] - c[8];
    k[3][3] = shift - c[0] - c[4] + c[8];
    k[0][1] = k[1][0] = c[7] - c[5];
    k[0][2] = k[2][0] = c[2] - c[6];
    k[0][3] = k[3][0] = c[3] - c[1];
    k[1][2] = k[2][1] = c[3] + c[1];
    k[1][3] = k[3][1] = c[2] + c[6];
    k[2][3] = k[3][2] = c[7] + c[5];
    for (int i = 0; i < SQUARINGS; i++)
        square(k);

    turn[0] = k[0][0] + k[1][1] - k[2][2] - k[3][3];
    turn[4] = k[0][0] - k[1][1] + k[2][2] - k[3][3];
    turn[8] = k[0][0] - k[1][1] - k[2][2] + k[3][3];
    turn[1] = 2.0 * (k[1][2] - k[0][3]);
    turn[2] = 2.0 * (k[1][3] + k[0][2]);
    turn[3] = 2.0 * (k[1][2] + k[0][3]);
    turn[5] = 2.0 * (k[2][3] - k[0][1]);
    turn[6] = 2.0 * (k[1][3] - k[0][2]);
    turn[7] = 2.0 * (k[2][3] + k[0][1]);
}

/* Set the moments (11,) of the edges around vertex i of points `from` and `to`, in their extents. */
static void gather(const int32_t *indptr, const int32_t *indices, int64_t i, const double *from,
                   double extent, const double *to, double other_extent, double *moments)
{
    for (int m = 0; m < MOMENTS; m++)
        moments[m] = 0.0;
    for (int64_t at = indptr[i]; at < indptr[i + 1]; at++) {
        const int64_t j = indices[at];
        const dm_vector a = dm_over(dm_from_to(from + 3 * i, from + 3 * j), extent);
        const dm_vector b = dm_over(dm_from_to(to + 3 * i, to + 3 * j), other_extent);
        moments[0] += b.x * a.x, moments[1] += b.x * a.y, moments[2] += b.x * a.z;
        moments[3] += b.y * a.x, moments[4] += b.y * a.y, moments[5] += b.y * a.z;
        moments[6] += b.z * a.x, moments[7] += b.z * a.y, moments[8] += b.z * a.z;
        moments[9] += dm_dot(a, a);
        moments[10] += dm_dot(b, b);
    }
}

/* Set `turns` (n, 9) to the rotations that take the edges around each vertex in the points `from`
   (n, 3) to those in the points `to` (n, 3), with those of neighbours `rings` edges away.

   Scratch: moments (n, 11), and wider (n, 11). */
int dm_fit_rotations(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                     const double *from, const double *to, int64_t rings, double *turns,
                     double *moments, double *wider)
{
    if (!dm_is_graph(indptr, n, indices, entries) || rings < 0)
        return DM_INVALID;
    const double extent = dm_extent(from, n), other_extent = dm_extent(to, n);
    for (int64_t i = 0; i < n; i++)
        gather(indptr, indices, i, from, extent, to, other_extent, moments + MOMENTS * i);
    for (int64_t ring = 0; ring < rings; ring++) {
        for (int64_t i = 0; i < n; i++) {
            double *const sums = wider + MOMENTS * i;
            for (int m = 0; m < MOMENTS; m++)
                sums[m] = moments[MOMENTS * i + m];
            for (int64_t at = indptr[i]; at < indptr[i + 1]; at++)
                for (int m = 0; m < MOMENTS; m++)
                    sums[m] += moments[(int64_t)MOMENTS * indices[at] + m];
        }
        double *const narrow = moments;
        moments = wider;
        wider = narrow;
    }
    for (int64_t i = 0; i < n; i++)
        turn_of(moments + MOMENTS * i, turns + 9 * i);
    return DM_OK;
}

/* Set `turns` (n, 9) to the rotations that are nearest to matrices (n, 9), by rows. */
int dm_nearest_rotations(const double *matrices, int64_t n, double *turns)
{
    if (n < 0)
        return DM_INVALID;
    for (int64_t i = 0; i < n; i++) {
        double moments[MOMENTS];
        moments[9] = 3.0, moments[10] = 0.0;
        for (int m = 0; m < 9; m++) {
            moments[m] = matrices[9 * i + m];
            moments[10] += moments[m] * moments[m];
        }
        turn_of(moments, turns + 9 * i);
    }
    return DM_OK;
}

/* Set `out` (n, 3) to the deltas of points (n, 3), turned: the sums of (R_i + R_j) (v_i - v_j) / 2,
   each in the order of the neighbours j, for the matrices R (n, 9). */
int dm_turned_deltas(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                     const double *points, const double *turns, double *out)
{
    if (!dm_is_graph(indptr, n, indices, entries))
        return DM_INVALID;
    for (int64_t i = 0; i < n; i++) {
        dm_vector sum = {0.0, 0.0, 0.0};
        const double *const r = turns + 9 * i;
        for (int64_t at = indptr[i]; at < indptr[i + 1]; at++) {
            const int64_t j = indices[at];
            const double *const s = turns + 9 * j;
            const dm_vector e = dm_from_to(points + 3 * j, points + 3 * i);
            sum.x += 0.5 * ((r[0] + s[0]) * e.x + (r[1] + s[1]) * e.y + (r[2] + s[2]) * e.z);
            sum.y += 0.5 * ((r[3] + s[3]) * e.x + (r[4] + s[4]) * e.y + (r[5] + s[5]) * e.z);
            sum.z += 0.5 * ((r[6] + s[6]) * e.x + (r[7] + s[7]) * e.y + (r[8] + s[8]) * e.z);
        }
        dm_set_row(out, i, sum);
    }
    return DM_OK;
}
