/* Quantized delta coordinates: their coding, and the diffusion of their quantization error.

   Vertices come in coding order; a neighbour j of i is known when j < i. Nothing is predicted:
   subtracting a mean of the neighbours made the numbers larger on every kind of mesh that was
   tried. The contexts are the magnitudes and signs around. */
#include <math.h>
#include <string.h>

#include "graphs.h"
#include "residual.h"

static int can_code(const dm_coder *c)
{
    return dm_has_memory(c, DM_HASH_SLOTS, 3 * DM_AXIS_MIXERS);
}

/* Code `values` (n, 3), filled in when decoding; neighbours ascend in the rows of the graph. */
int dm_code_deltas(dm_coder *c, const int32_t *indptr, int64_t n, const int32_t *indices,
                   int64_t entries, int64_t *values)
{
    if (!can_code(c) || !dm_is_graph(indptr, n, indices, entries))
        return DM_INVALID;
    for (int64_t i = 0; i < n; i++) {
        dm_known known = {0};
        for (int64_t at = indptr[i]; at < indptr[i + 1]; at++) {
            const int64_t j = indices[at];
            if (j >= i)
                break; /* neighbours ascend */
            known.neighbours++;
            for (int axis = 0; axis < 3; axis++) {
                const int64_t value = values[3 * j + axis], size = dm_size(value);
                known.sum[axis] = dm_add(known.sum[axis], value);
                known.absolute[axis] = dm_add(known.absolute[axis], size);
                known.hint[axis] = dm_max(known.hint[axis], size);
            }
        }
        for (int axis = 0; axis < 3; axis++)
            known.last[axis] = i > 0 ? values[3 * (i - 1) + axis] : 0;
        known.kind = dm_min(known.neighbours, 3);
        known.hint_all = dm_min(indptr[i + 1] - indptr[i], 15);
        dm_code_vector(c, values + 3 * i, 3, &known);
    }
    return DM_OK;
}

static int64_t size_of(const int64_t *v)
{
    return dm_add(dm_add(dm_size(v[0]), dm_size(v[1])), dm_size(v[2]));
}

/* Code `values` (n,), filled in when decoding, where the `deltas` (n, 3) are known. */
int dm_code_refinements(dm_coder *c, const int32_t *indptr, int64_t n, const int32_t *indices,
                        int64_t entries, const int64_t *deltas, int64_t *values)
{
    if (!can_code(c) || !dm_is_graph(indptr, n, indices, entries))
        return DM_INVALID;
    for (int64_t i = 0; i < n; i++) {
        dm_known known = {0};
        int64_t around = 0;
        for (int64_t at = indptr[i]; at < indptr[i + 1]; at++) {
            const int64_t j = indices[at];
            around = dm_add(around, size_of(deltas + 3 * j));
            if (j < i) {
                known.neighbours++;
                known.sum[0] = dm_add(known.sum[0], values[j]);
                known.absolute[0] = dm_add(known.absolute[0], dm_size(values[j]));
                known.hint[0] = dm_max(known.hint[0], dm_size(values[j]));
            }
        }
        const int64_t valence = indptr[i + 1] - indptr[i];
        if (valence > 0)
            known.absolute[1] = dm_quotient(dm_times(known.neighbours, around), valence);
        known.spent = dm_times(2, size_of(deltas + 3 * i));
        known.last[0] = i > 0 ? values[i - 1] : 0;
        known.kind = dm_min(known.neighbours, 3);
        known.hint_all = dm_min(valence, 15);
        dm_code_vector(c, values + i, 1, &known);
    }
    return DM_OK;
}

/* The integer next to a number of steps, the even one of two; -2^63 for one that 64 bits do not hold.
 */
static inline double rounded(double steps, double zone)
{
    /* Doubles around it are 1 apart: the sum is rounded to an integer, without a call of rint. */
    const double shift = 0x1.8p52;
    double near = (steps + shift) - shift;
    if (fabs(steps) >= 0x1p51)
        near = fabs(steps) < 0x1p63 ? steps : -0x1p63; /* an integer already */
    uint64_t bits; /* a mask, since the processor would guess a jump wrong every other time */
    memcpy(&bits, &near, sizeof(bits));
    bits &= 0 - (uint64_t)(fabs(steps) > 0.5 + zone);
    memcpy(&near, &bits, sizeof(bits));
    return near;
}

/* Round delta / step into `out` (n, 3), or its component along `normals` into `out` (n, 1).

   Each vertex has its own of the `steps` (n,). Numbers within 0.5 + `zone` steps of 0 become 0. The
   error is passed on, in equal parts, to the neighbours that are still to come, into `delta` (n, 3),
   which is used up: the share `normal` of its component along the normal, the share `tangential` of
   the rest. Neighbours ascend in the rows of the graph. */
int dm_diffuse(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
               double *restrict delta, const double *restrict normals,
               const double *restrict steps, double zone, double tangential, double normal,
               int64_t columns, int64_t *restrict out)
{
    if ((columns != 1 && columns != 3) || !dm_are_short_bounds(indptr, n, entries))
        return DM_INVALID;
    for (int64_t i = 0; i < n; i++) {
        const double step = steps[i];
        /* The rounded part is taken off: the error stays. */
        double x = delta[3 * i], y = delta[3 * i + 1], z = delta[3 * i + 2];
        const double nx = normals[3 * i], ny = normals[3 * i + 1], nz = normals[3 * i + 2];
        if (columns == 3) {
            const double a = rounded(x / step, zone), b = rounded(y / step, zone);
            const double c = rounded(z / step, zone);
            out[3 * i] = (int64_t)a, out[3 * i + 1] = (int64_t)b, out[3 * i + 2] = (int64_t)c;
            x -= a * step, y -= b * step, z -= c * step;
        } else {
            const double number = rounded((x * nx + y * ny + z * nz) / step, zone);
            out[i] = (int64_t)number;
            x -= number * step * nx, y -= number * step * ny, z -= number * step * nz;
        }
        delta[3 * i] = x, delta[3 * i + 1] = y, delta[3 * i + 2] = z;
        const int64_t end = indptr[i + 1];
        int64_t first = end; /* of the neighbours still to come, which are the last ones */
        while (first > indptr[i] && indices[first - 1] > i)
            if (indices[--first] >= n)
                return DM_INVALID;
        if (first == end)
            continue;
        const double count = (double)(end - first), along = x * nx + y * ny + z * nz;
        const double across = normal * along;
        x = (tangential * (x - along * nx) + across * nx) / count;
        y = (tangential * (y - along * ny) + across * ny) / count;
        z = (tangential * (z - along * nz) + across * nz) / count;
        for (int64_t at = first; at < end; at++) {
            double *const next = delta + INT64_C(3) * indices[at];
            next[0] += x, next[1] += y, next[2] += z;
        }
    }
    return DM_OK;
}
