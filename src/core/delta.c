/* Quantized delta coordinates: their coding, and the diffusion of their quantization error.

   Vertices come in coding order; a neighbour j of i is known when j < i. Nothing is predicted:
   subtracting a mean of the neighbours made the numbers larger on every kind of mesh that was
   tried. The contexts are the magnitudes and signs around. */
#include <math.h>

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

/* A number of steps as an integer; -2^63 for one that 64 bits do not hold. */
static inline int64_t integer_of(double steps)
{
    return fabs(steps) < 0x1p63 ? (int64_t)steps : INT64_MIN;
}

/* Round some numbers of steps, up or down each, to the integers that cost the least.

   The cost is the squared error, its part along the `normal` `weight` times; the bits that a
   magnitude takes, as if `pull[k]` were the price of half a step of it; and of the first step,
   `zone` more. The nearer to 0 is taken of two alike. */
static inline void cheapest(const double *restrict numbers, int columns,
                            const double *restrict pull, double zone, double weight,
                            const double *restrict normal, double *restrict chosen)
{
    double costs[3][2], along[3][2], candidates[3][2], least = INFINITY;
    for (int k = 0; k < columns; k++) {
        const double number = numbers[k], sign = number < 0 ? -1 : 1, near = rint(number);
        candidates[k][0] = fabs(near) > fabs(number) ? near - sign : near;
        candidates[k][1] = candidates[k][0] + sign;
        chosen[k] = candidates[k][0];
        for (int far = 0; far < 2; far++) {
            const double size = fabs(candidates[k][far]), error = number - candidates[k][far];
            costs[k][far] = error * error + 2 * (pull[k] * size + (size > 0 ? zone : 0));
            along[k][far] = error * normal[k];
        }
    }
    for (int choice = 0; choice < 1 << columns; choice++) {
        double cost = 0, across = 0;
        for (int k = 0; k < columns; k++) {
            cost += costs[k][choice >> k & 1];
            across += along[k][choice >> k & 1];
        }
        cost += (weight - 1) * across * across;
        if (cost < least) {
            least = cost;
            for (int k = 0; k < columns; k++)
                chosen[k] = candidates[k][choice >> k & 1];
        }
    }
}

/* Round delta / step into `out` (n, 3), or its component along `normals` into `out` (n, 1).

   Each vertex has its own of the `steps` (n,). Where rounding costs bits, as `cheapest` says, the
   pull on a number is `pull` / (1 + m), m the mean magnitude of the known neighbours: the smaller
   they are, the more bits a step more takes. The error is passed on, in equal parts, to the
   neighbours that are still to come, into `delta` (n, 3), which is used up: the share `normal` of
   its component along the normal, the share `tangential` of the rest. Neighbours ascend in the rows
   of the graph. */
int dm_diffuse(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
               double *restrict delta, const double *restrict normals,
               const double *restrict steps, double zone, double pull, double weight,
               double tangential, double normal, int64_t columns, int64_t *restrict out)
{
    if ((columns != 1 && columns != 3) || !dm_is_graph(indptr, n, indices, entries))
        return DM_INVALID;
    for (int64_t i = 0; i < n; i++) {
        const double step = steps[i];
        const double nx = normals[3 * i], ny = normals[3 * i + 1], nz = normals[3 * i + 2];
        const int64_t end = indptr[i + 1];
        int64_t at = indptr[i];
        double sums[3] = {0}, pulls[3], chosen[3];
        for (; at < end && indices[at] < i; at++)
            for (int64_t k = 0; k < columns; k++)
                sums[k] += fabs((double)out[columns * indices[at] + k]);
        const double known = fmax((double)(at - indptr[i]), 1);
        for (int64_t k = 0; k < columns; k++)
            pulls[k] = pull / (1 + sums[k] / known);
        /* The rounded part is taken off: the error stays. */
        double x = delta[3 * i], y = delta[3 * i + 1], z = delta[3 * i + 2];
        if (columns == 3) {
            const double numbers[3] = {x / step, y / step, z / step};
            cheapest(numbers, 3, pulls, zone, weight, normals + 3 * i, chosen);
            x -= chosen[0] * step, y -= chosen[1] * step, z -= chosen[2] * step;
        } else {
            const double number = (x * nx + y * ny + z * nz) / step;
            cheapest(&number, 1, pulls, zone, 1, normals + 3 * i, chosen);
            const double length = chosen[0] * step;
            x -= length * nx, y -= length * ny, z -= length * nz;
        }
        for (int64_t k = 0; k < columns; k++)
            out[columns * i + k] = integer_of(chosen[k]);
        delta[3 * i] = x, delta[3 * i + 1] = y, delta[3 * i + 2] = z;
        if (at == end)
            continue;
        const double count = (double)(end - at);
        const double along = x * nx + y * ny + z * nz, across = normal * along;
        x = (tangential * (x - along * nx) + across * nx) / count;
        y = (tangential * (y - along * ny) + across * ny) / count;
        z = (tangential * (z - along * nz) + across * nz) / count;
        for (; at < end; at++) {
            double *const next = delta + INT64_C(3) * indices[at];
            next[0] += x, next[1] += y, next[2] += z;
        }
    }
    return DM_OK;
}
