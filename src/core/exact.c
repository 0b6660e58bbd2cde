/* Numbers to the last bit: the distance of each from a prediction, in units of its own format.

   A number m * base^(e - places) of a number format is known by its index in that format.
   Parallelograms predict a point on a grid of integers; the coded distance is the number of indices
   between the number next to that point and the true one. After P. Lindstrom, M. Isenburg, "Fast and
   efficient compression of floating-point data", IEEE TVCG 12(5), 2006, and M. Isenburg, P.
   Lindstrom, J. Snoeyink, "Lossless compression of predicted floating-point geometry", CAD 37(8),
   2005, whose contexts are exponents. Here the errors around are measured in the unit that the
   format has at the prediction: that they were made where numbers lie denser or less dense then
   makes no difference. */
#include "exact.h"

#include "graphs.h"
#include "grid.h"

enum { WINDOW = 8 }; /* levels distinguish sizes down to 2^-8 of the usual */

typedef struct {
    const int32_t *indptr, *indices, *first, *corners;
    const int64_t *axes, *formats;
    int64_t width;
    int64_t *choices, *values, *grid;
    int64_t *errors; /* prediction to truth, on the grid */
} exact_mesh;

/* What is known of the neighbours of a vertex: the sum of the sizes of their errors, and of the
   signs; how many of them are raw or in the second format; how many there are. */
typedef struct {
    int64_t total, signs, others, count;
} surroundings;

/* Slots of the bits of a distance. */
typedef struct {
    int64_t magnitudes[DM_EXACT_MAGNITUDES], mantissas[DM_EXACT_MANTISSAS], signs[DM_EXACT_SIGNS];
} distance_slots;

/* The mean of the parallelograms, else of the known neighbours, and their spread. */
static int64_t predict(const exact_mesh *m, int64_t i, int axis, int64_t *spread)
{
    const int64_t *const grid = m->grid;
    int64_t total = 0, low = 4 * DM_EXACT_BOUND, high = -4 * DM_EXACT_BOUND;
    int64_t count = dm_min(m->first[i + 1] - m->first[i], DM_MOST);
    for (int64_t at = m->first[i]; at < m->first[i] + count; at++) {
        const int32_t *const corner = m->corners + 3 * at;
        const int64_t point = grid[INT64_C(3) * corner[0] + axis] +
                              grid[INT64_C(3) * corner[1] + axis] -
                              grid[INT64_C(3) * corner[2] + axis];
        total += point;
        low = dm_min(low, point), high = dm_max(high, point);
    }
    *spread = 0;
    if (count > 0) {
        *spread = high - low;
        const int64_t mean = dm_quotient(2 * total + count, 2 * count);
        return dm_clamp(mean, -DM_EXACT_BOUND, DM_EXACT_BOUND);
    }
    for (int64_t at = m->indptr[i]; at < m->indptr[i + 1]; at++) {
        if (m->indices[at] >= i || count == DM_MOST)
            break; /* neighbours ascend */
        total += grid[INT64_C(3) * m->indices[at] + axis];
        count++;
    }
    if (count > 0)
        return dm_quotient(total, count);
    return i > 0 ? grid[3 * (i - 1) + axis] : 0;
}

static surroundings look_around(const exact_mesh *m, int64_t i, int axis)
{
    surroundings s = {0};
    for (int64_t at = m->indptr[i]; at < m->indptr[i + 1]; at++) {
        const int64_t j = m->indices[at];
        if (j >= i || s.count == DM_MOST)
            break;
        const int64_t error = m->errors[3 * j + axis], choice = m->choices[3 * j + axis];
        s.total += dm_size(error);
        s.signs += (error > 0) - (error < 0);
        s.others += choice == DM_SECOND_FORMAT || choice == DM_RAW;
        s.count++;
    }
    return s;
}

/* Code whether a coordinate is in the first format, the second, or raw.

   `before` has the choices of the axes before, as digits. */
static int64_t code_choice(dm_coder *c, const exact_mesh *m, int64_t i, int axis,
                           const surroundings *around, int64_t before)
{
    const int64_t *const of = m->axes + DM_AXIS_SIZE * axis;
    const int64_t formats = of[DM_FORMATS], raw = of[DM_HAS_RAW];
    const int64_t given = m->choices[3 * i + axis];
    const int64_t last = i > 0 ? m->choices[3 * (i - 1) + axis] : DM_FIRST_FORMAT;
    const int64_t base = axis * AXIS_SLOTS, mixer = axis * DM_AXIS_CHOICE_MIXERS;
    const int64_t share = 4 * around->others / dm_max(around->count, 1);
    int64_t at[DM_CHOICES] = {
        base + 16 * share + before,
        base + DM_CHOICE_SLOTS + (DM_MOST + 1) * around->others + around->count,
        base + 2 * DM_CHOICE_SLOTS + 16 * last + before,
    };
    if (formats == 0)
        return DM_RAW;
    if (formats + raw == 1)
        return DM_FIRST_FORMAT;
    if (!dm_code_bit(c, given == DM_SECOND_FORMAT || given == DM_RAW, mixer, at))
        return DM_FIRST_FORMAT;
    if (formats == 1)
        return DM_RAW;
    if (raw == 0)
        return DM_SECOND_FORMAT;
    for (int k = 0; k < DM_CHOICES; k++)
        at[k] += DM_CHOICES * DM_CHOICE_SLOTS;
    return dm_code_bit(c, given == DM_RAW, mixer + 1, at) ? DM_RAW : DM_SECOND_FORMAT;
}

/* Code a number as it is, the highest bits first. */
static int64_t code_bits(dm_coder *c, int64_t value, int64_t width)
{
    const uint64_t bits = (uint64_t)value;
    const int64_t high = dm_code_raw(c, (int64_t)(bits >> 32), width - 32);
    const int64_t low = dm_code_raw(c, (int64_t)(bits & 0xFFFFFFFF), 32);
    return (int64_t)((uint64_t)high << 32 | (uint64_t)low);
}

/* Code whether a zero is negative. */
static int64_t code_zero(dm_coder *c, const exact_mesh *m, int64_t i, int axis)
{
    const int64_t *const choices = m->choices;
    int64_t alike = 0;
    for (int64_t at = m->indptr[i]; at < dm_min(m->indptr[i + 1], m->indptr[i] + DM_MOST); at++) {
        const int64_t j = m->indices[at];
        alike += j < i && choices[3 * j + axis] == DM_NEGATIVE_ZERO;
    }
    const int64_t base = axis * AXIS_SLOTS + 2 * DM_CHOICES * DM_CHOICE_SLOTS;
    const int64_t at[] = {
        base,
        base + DM_CHOICE_SLOTS + alike,
        base + 2 * DM_CHOICE_SLOTS + (i > 0 ? choices[3 * (i - 1) + axis] : 0),
    };
    const int64_t mixer = axis * DM_AXIS_CHOICE_MIXERS + 2;
    return dm_code_bit(c, choices[3 * i + axis] == DM_NEGATIVE_ZERO, mixer, at) ? DM_NEGATIVE_ZERO
                                                                               : DM_FIRST_FORMAT;
}

/* Set the slots of a distance in format f, whose unit at the prediction is base^unit.

   `error` is that of the vertex before, `before` the level of the coordinates before. */
static distance_slots slots_of(const exact_mesh *m, int64_t f, int64_t unit,
                               const surroundings *around, int64_t kind, int64_t spread,
                               int64_t error, int64_t before)
{
    const int64_t *const format = m->formats + DM_FORMAT_SIZE * f;
    const int64_t shift = dm_max(format[DM_USUAL] - WINDOW, 0);
    const int64_t mean = 4 * around->total / dm_max(around->count, 1);
    const int64_t here = dm_level(dm_units(format, unit, mean) >> shift);
    const int64_t hint = dm_level(dm_units(format, unit, spread) >> shift);
    const int64_t latest = dm_level(dm_units(format, unit, dm_size(error)) >> shift);
    const int64_t base = FORMATS_AT + f * FORMAT_SLOTS;
    const int64_t side = dm_side(around->signs), last = dm_side(error);
    const int64_t contexts[DM_EXACT_MAGNITUDES] = {
        here * 4 + kind,
        here * DM_LEVELS + before,
        here * DM_LEVELS + latest,
        hint * DM_LEVELS + here,
        (hint / 2 * 16 + before / 2) * 4 + kind,
        (here / 2 * 16 + before / 2) * 4 + kind,
    };
    distance_slots slots = {
        .mantissas = {base + MANTISSA_AT, base + MANTISSA_AT + (1 + here) * DM_MANTISSA_SLOTS},
        .signs = {base + SIGN_AT + side, base + SIGN_AT + DM_SIGN_SLOTS + around->signs + DM_MOST,
                  base + SIGN_AT + 2 * DM_SIGN_SLOTS + 3 * last + side},
    };
    for (int k = 0; k < DM_EXACT_MAGNITUDES; k++)
        slots.magnitudes[k] = base + MAGNITUDE_AT + k * DM_MAGNITUDE_SLOTS +
                              contexts[k] * DM_DISTANCE_LENGTHS;
    return slots;
}

static int is_longer(dm_coder *c, int64_t length, int64_t k, const distance_slots *slots,
                     int64_t mixer)
{
    int64_t at[DM_EXACT_MAGNITUDES];
    for (int j = 0; j < DM_EXACT_MAGNITUDES; j++)
        at[j] = slots->magnitudes[j] + k;
    return dm_code_bit(c, length > k, mixer + k, at) == 1;
}

/* Code the bits of a magnitude below its highest, the first three in their contexts. */
static int64_t code_mantissa(dm_coder *c, int64_t magnitude, int64_t length,
                             const distance_slots *slots, int64_t mixer)
{
    const int64_t modelled = dm_min(length - 1, 3), rest = length - 1 - modelled;
    int64_t result = 1;
    for (int64_t j = 0; j < modelled; j++) {
        const int64_t node = 8 * length + result;
        const int64_t at[] = {slots->mantissas[0] + node, slots->mantissas[1] + node};
        result = 2 * result + dm_code_bit(c, magnitude >> (length - 2 - j) & 1, mixer, at);
    }
    const int64_t below = magnitude & (((int64_t)1 << rest) - 1);
    return (result << rest) | dm_code_raw(c, below, rest);
}

/* Code the length of |value|, asked from the usual one up or down, its other bits, its sign. */
static int64_t code_distance(dm_coder *c, int64_t value, const distance_slots *slots,
                             int64_t mixer, int64_t usual)
{
    const int64_t size = dm_size(value), length = dm_bits(size);
    int64_t k = usual;
    if (is_longer(c, length, k, slots, mixer)) {
        k++;
        while (k < DM_DISTANCE_LENGTHS - 1 && is_longer(c, length, k, slots, mixer))
            k++;
    } else {
        while (k > 0 && !is_longer(c, length, k - 1, slots, mixer))
            k--;
    }
    if (k == 0)
        return 0;
    const int64_t magnitude = code_mantissa(c, size, k, slots, mixer + DM_DISTANCE_LENGTHS);
    const int64_t negative =
        dm_code_bit(c, value < 0, mixer + DM_DISTANCE_LENGTHS + 1, slots->signs);
    return negative ? -magnitude : magnitude;
}

/* Code one coordinate; `before` and `chosen_before` are those of the coordinates before it. */
static void code_coordinate(dm_coder *c, const exact_mesh *m, int64_t i, int axis, int64_t *before,
                            int64_t *chosen_before)
{
    const int64_t *const of = m->axes + DM_AXIS_SIZE * axis;
    int64_t *const value = &m->values[3 * i + axis], *const choice = &m->choices[3 * i + axis];
    int64_t spread, unit;
    const int64_t point = predict(m, i, axis, &spread);
    const surroundings around = look_around(m, i, axis);
    const int64_t chosen = code_choice(c, m, i, axis, &around, *chosen_before);
    *chosen_before = 3 * *chosen_before + chosen;
    if (*choice != DM_NEGATIVE_ZERO)
        *choice = chosen;
    if (chosen == DM_RAW) {
        *value = code_bits(c, *value, m->width);
        m->grid[3 * i + axis] = point;
        return;
    }
    const int64_t f = of[DM_FORMAT_AT] + chosen;
    const int64_t *const format = m->formats + DM_FORMAT_SIZE * f;
    const int64_t index = dm_nearest_index(format, point, &unit);
    const int64_t error = i > 0 ? m->errors[3 * (i - 1) + axis] : 0;
    const int64_t kind = dm_min(m->first[i + 1] - m->first[i], 3);
    const distance_slots slots = slots_of(m, f, unit, &around, kind, spread, error, *before);
    const int64_t mixer = 3 * DM_AXIS_CHOICE_MIXERS + f * DM_FORMAT_MIXERS;
    const int64_t distance =
        code_distance(c, dm_subtract(*value, index), &slots, mixer, format[DM_USUAL]);
    *value = dm_add(index, distance);
    if (*value == 0 && chosen == DM_FIRST_FORMAT && of[DM_HAS_ZEROS] == 1)
        *choice = code_zero(c, m, i, axis);
    m->grid[3 * i + axis] = dm_grid_point(format, *value);
    m->errors[3 * i + axis] =
        dm_clamp(m->grid[3 * i + axis] - point, -DM_EXACT_BOUND, DM_EXACT_BOUND);
    const int64_t size = dm_level(dm_size(distance) >> dm_max(format[DM_USUAL] - WINDOW, 0));
    *before = axis == 0 ? size : (*before + size + 1) / 2;
}

static int are_tables(const exact_mesh *m, int64_t format_count)
{
    for (int64_t f = 0; f < format_count; f++)
        if (!dm_is_format(m->formats + DM_FORMAT_SIZE * f))
            return 0;
    for (int axis = 0; axis < 3; axis++) {
        const int64_t *const of = m->axes + DM_AXIS_SIZE * axis;
        if (of[DM_FORMATS] < 0 || of[DM_FORMATS] > 2 || of[DM_FORMAT_AT] < 0 ||
            of[DM_FORMAT_AT] > format_count - of[DM_FORMATS] || of[DM_HAS_RAW] < 0 ||
            of[DM_HAS_RAW] > 1)
            return 0;
    }
    return m->width == 32 || m->width == 64;
}

/* Code `choices` and `values` (n, 3), filled in when decoding; `grid`, `errors` (n, 3) are scratch.

   A value is an index or, where it is raw, `width` bits. Neighbours ascend in the rows of the graph,
   parallelograms are as of `dm_code_positions`; axes (3, 4) and formats (format_count, 4) are tables.
 */
int dm_code_exact(dm_coder *c, const int32_t *indptr, int64_t n, const int32_t *indices,
                  int64_t entries, const int32_t *first, const int32_t *corners, int64_t count,
                  const int64_t *axes, const int64_t *formats, int64_t format_count, int64_t width,
                  int64_t *choices, int64_t *values, int64_t *grid, int64_t *errors)
{
    const exact_mesh m = {indptr, indices, first, corners, axes, formats,
                          width,  choices, values, grid,   errors};
    if (!dm_has_memory(c, FORMATS_AT + format_count * FORMAT_SLOTS,
                       3 * DM_AXIS_CHOICE_MIXERS + format_count * DM_FORMAT_MIXERS) ||
        !dm_is_graph(indptr, n, indices, entries) || !dm_are_short_bounds(first, n, count) ||
        !dm_are_shorts_in(corners, 3 * count, 0, n) || !are_tables(&m, format_count) ||
        !dm_all_in(choices, 3 * n, 0, DM_NEGATIVE_ZERO + 1))
        return DM_INVALID;
    for (int64_t k = 0; k < 3 * n; k++)
        grid[k] = errors[k] = 0;
    for (int64_t i = 0; i < n; i++) {
        int64_t before = 0, chosen_before = 0;
        for (int axis = 0; axis < 3; axis++)
            code_coordinate(c, &m, i, axis, &before, &chosen_before);
    }
    return DM_OK;
}
