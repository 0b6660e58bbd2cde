/* What the core asks of <math.h>, where there is no library: instructions of WebAssembly. */
#ifndef DELTAMESH_FREESTANDING_MATH_H
#define DELTAMESH_FREESTANDING_MATH_H

#define INFINITY __builtin_inf()
#define HUGE_VAL __builtin_huge_val()
#define fabs(x) __builtin_fabs(x)
#define isfinite(x) __builtin_isfinite(x)
#define rint(x) __builtin_rint(x)
#define sqrt(x) __builtin_sqrt(x)

/* Of what only measures errors, which no decoder calls. */
double atan2(double y, double x);

/* The instruction f64.max returns NaN for NaN, other than the function. */
static inline double fmax(double a, double b)
{
    return a != a ? b : (b != b || a > b ? a : b);
}

#endif
