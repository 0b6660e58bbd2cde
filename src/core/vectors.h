/* Vectors of three numbers. */
#ifndef DELTAMESH_VECTORS_H
#define DELTAMESH_VECTORS_H

#include <math.h>
#include <stdint.h>

typedef struct {
    double x, y, z;
} dm_vector;

/* The vector from point a to point b. */
static inline dm_vector dm_from_to(const double *a, const double *b)
{
    return (dm_vector){b[0] - a[0], b[1] - a[1], b[2] - a[2]};
}

static inline dm_vector dm_over(dm_vector v, double divisor)
{
    return (dm_vector){v.x / divisor, v.y / divisor, v.z / divisor};
}

static inline dm_vector dm_multiple(dm_vector v, double factor)
{
    return (dm_vector){v.x * factor, v.y * factor, v.z * factor};
}

static inline double dm_dot(dm_vector v, dm_vector w) { return v.x * w.x + v.y * w.y + v.z * w.z; }

static inline dm_vector dm_cross(dm_vector v, dm_vector w)
{
    return (dm_vector){v.y * w.z - v.z * w.y, v.z * w.x - v.x * w.z, v.x * w.y - v.y * w.x};
}

static inline dm_vector dm_row(const double *rows, int64_t i)
{
    return (dm_vector){rows[3 * i], rows[3 * i + 1], rows[3 * i + 2]};
}

static inline void dm_set_row(double *rows, int64_t i, dm_vector v)
{
    rows[3 * i] = v.x, rows[3 * i + 1] = v.y, rows[3 * i + 2] = v.z;
}

static inline double dm_length(dm_vector v) { return sqrt(dm_dot(v, v)); }

/* The longest side of the bounding box of points (n, 3), or 1. */
static inline double dm_extent(const double *points, int64_t n)
{
    double longest = 0.0;
    for (int c = 0; c < 3; c++) {
        double low = INFINITY, high = -INFINITY;
        for (int64_t v = 0; v < n; v++) {
            const double x = points[3 * v + c];
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
        longest = high - low > longest ? high - low : longest;
    }
    return longest > 0.0 ? longest : 1.0;
}

#endif
