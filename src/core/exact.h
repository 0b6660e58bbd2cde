/* Model of numbers to the last bit. */
#ifndef DELTAMESH_EXACT_H
#define DELTAMESH_EXACT_H

#include "signed_integers.h"

/* Parallelograms and neighbours of a vertex that are looked at: sums of so many points of the grid
   stay within 64 bits. */
enum { DM_MOST = 8 };

/* Choices of a coordinate: the first format, the second, its raw bits, a negative zero. */
enum { DM_FIRST_FORMAT, DM_SECOND_FORMAT, DM_RAW, DM_NEGATIVE_ZERO };

/* Columns of the table of axes: the row of its first format, the number of formats, whether there
   are raw coordinates and negative zeros. */
enum { DM_FORMAT_AT, DM_FORMATS, DM_HAS_RAW, DM_HAS_ZEROS, DM_AXIS_SIZE };

enum {
    DM_DISTANCE_LENGTHS = 63, /* of a distance, in bits; indices are below 2^61 */
    DM_EXACT_LIMIT = 255,
    /* Contexts of each kind of bit. */
    DM_EXACT_MAGNITUDES = 6,
    DM_EXACT_MANTISSAS = 2,
    DM_EXACT_SIGNS = 3,
    DM_MAGNITUDE_SLOTS = 1024 * DM_DISTANCE_LENGTHS, /* of one context */
    DM_MANTISSA_SLOTS = 8 * DM_DISTANCE_LENGTHS,     /* of one level */
    DM_SIGN_SLOTS = 32,
    DM_CHOICES = 3,
    DM_CHOICE_SLOTS = 128,
};

/* Slots of the choice between the formats, of one axis: of the first question, the second, of the
   sign of a zero. */
#define EXACT_AXIS_RANGES(R) R(CHOICE_AT, 3 * DM_CHOICES * DM_CHOICE_SLOTS)
enum { EXACT_AXIS_RANGES(DM_RANGE) AXIS_SLOTS };

/* Slots of one format; those of the formats come after those of the three axes. */
#define EXACT_FORMAT_RANGES(R)                                                                     \
    R(MAGNITUDE_AT, DM_EXACT_MAGNITUDES *DM_MAGNITUDE_SLOTS)                                       \
    R(MANTISSA_AT, (1 + DM_LEVELS) * DM_MANTISSA_SLOTS)                                            \
    R(SIGN_AT, DM_EXACT_SIGNS *DM_SIGN_SLOTS)
enum { EXACT_FORMAT_RANGES(DM_RANGE) FORMAT_SLOTS };
enum { FORMATS_AT = 3 * AXIS_SLOTS };

/* Mixers: three for each axis; then, of each format, one for each bit of a length, one for the
   mantissa, one for the sign. */
enum { DM_AXIS_CHOICE_MIXERS = 3, DM_FORMAT_MIXERS = DM_DISTANCE_LENGTHS + 2 };

#endif
