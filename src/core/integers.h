/* Integers of 64 bits: what C leaves open, as Python has it.

   Sums and products that hostile bytes may drive out of 64 bits wrap around: they are computed
   without a sign. */
#ifndef DELTAMESH_INTEGERS_H
#define DELTAMESH_INTEGERS_H

#include <stdint.h>

static inline int64_t dm_min(int64_t a, int64_t b) { return a < b ? a : b; }

static inline int64_t dm_max(int64_t a, int64_t b) { return a > b ? a : b; }

static inline int64_t dm_clamp(int64_t x, int64_t low, int64_t high)
{
    return dm_min(dm_max(x, low), high);
}

static inline int64_t dm_add(int64_t a, int64_t b) { return (int64_t)((uint64_t)a + (uint64_t)b); }

static inline int64_t dm_subtract(int64_t a, int64_t b)
{
    return (int64_t)((uint64_t)a - (uint64_t)b);
}

static inline int64_t dm_times(int64_t a, int64_t b)
{
    return (int64_t)((uint64_t)a * (uint64_t)b);
}

/* |x|; the least number is its own. */
static inline int64_t dm_size(int64_t x) { return x < 0 ? dm_subtract(0, x) : x; }

/* The largest integer not above a / b, b > 0. */
static inline int64_t dm_quotient(int64_t a, int64_t b)
{
    return a / b - (a % b < 0 ? 1 : 0);
}

/* a - b * dm_quotient(a, b), in [0, b). */
static inline int64_t dm_rest(int64_t a, int64_t b)
{
    const int64_t rest = a % b;
    return rest < 0 ? rest + b : rest;
}

/* Number of bits of x, 0 where x <= 0. */
static inline int64_t dm_bits(int64_t x)
{
    if (x <= 0)
        return 0;
#if defined(__GNUC__)
    return 64 - __builtin_clzll((unsigned long long)x);
#else
    int64_t bits = 0;
    while (bits < 63 && x >> bits > 0)
        bits++;
    return bits;
#endif
}

static inline int64_t dm_is(int condition) { return condition ? 1 : 0; }

/* 1 for a positive number, 2 for a negative one, 0 for zero. */
static inline int64_t dm_side(int64_t x) { return x > 0 ? 1 : (x < 0 ? 2 : 0); }

#endif
