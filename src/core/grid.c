/* Numbers of a format on a grid of integers; see `grid.h`. */
#include "grid.h"

#include "deltamesh_core.h"

static const int64_t POWERS[19] = {1,
                                   10,
                                   100,
                                   1000,
                                   10000,
                                   100000,
                                   1000000,
                                   10000000,
                                   100000000,
                                   1000000000,
                                   10000000000,
                                   100000000000,
                                   1000000000000,
                                   10000000000000,
                                   100000000000000,
                                   1000000000000000,
                                   10000000000000000,
                                   100000000000000000,
                                   1000000000000000000};

/* Whether a row of the table of formats keeps what follows within 64 bits. */
int dm_is_format(const int64_t *format)
{
    if (format[DM_USUAL] < 0 || format[DM_USUAL] > 62 || format[DM_DIGITS] < 1)
        return 0;
    if (format[DM_BASE] == 10)
        return format[DM_DIGITS] <= 18 && format[DM_OFFSET] >= 0 && format[DM_OFFSET] <= 18;
    return format[DM_BASE] == 2 && format[DM_DIGITS] <= 60 && format[DM_OFFSET] >= -(1 << 20) &&
           format[DM_OFFSET] <= 1 << 20;
}

/* The index of the number next to a point, and its unit as a power on the grid. */
int64_t dm_nearest_index(const int64_t *format, int64_t point, int64_t *unit)
{
    const int64_t offset = format[DM_OFFSET], digits = format[DM_DIGITS];
    const int64_t size = dm_size(point);
    int64_t index;
    if (format[DM_BASE] == 2) {
        const int64_t e = dm_max(dm_bits(size) - offset - digits, 0);
        int64_t m = 0;
        *unit = e + offset;
        if (*unit > 0)
            m = ((size >> dm_min(*unit - 1, 62)) + 1) >> 1;
        else if (size > 0) /* fewer digits than the format has */
            m = (int64_t)((uint64_t)size << dm_min(-*unit, 63));
        index = dm_add((int64_t)((uint64_t)e << (digits - 1)), m);
    } else {
        int64_t length = 0;
        while (length < 18 && size >= POWERS[length])
            length++;
        const int64_t e = dm_max(length - offset - digits, 0);
        *unit = e + offset;
        const int64_t m = (size + POWERS[*unit] / 2) / POWERS[*unit];
        index = e * 9 * POWERS[digits - 1] + m;
    }
    return point < 0 ? dm_subtract(0, index) : index;
}

/* The grid point of a number, rounded towards 0, within the bound. */
int64_t dm_grid_point(const int64_t *format, int64_t index)
{
    const int64_t offset = format[DM_OFFSET], digits = format[DM_DIGITS];
    const int64_t size = dm_size(index);
    int64_t point = DM_EXACT_BOUND;
    if (format[DM_BASE] == 2) {
        const int64_t e = dm_max((size >> (digits - 1)) - 1, 0);
        const int64_t m = size - (e << (digits - 1)), unit = e + offset;
        if (unit <= 0)
            point = dm_min(m >> dm_min(-unit, 62), DM_EXACT_BOUND);
        else if ((unit < 56 && m < DM_EXACT_BOUND >> unit) || m == 0)
            point = m << dm_min(unit, 56);
    } else {
        const int64_t top = POWERS[digits - 1];
        const int64_t e = size >= top ? (size - top) / (9 * top) : 0;
        const int64_t m = size - e * 9 * top, power = POWERS[dm_min(e + offset, 18)];
        if (m <= DM_EXACT_BOUND / power)
            point = m * power;
    }
    return index < 0 ? -point : point;
}

/* A size on the grid in units of base^unit, or as many of them as fit. */
int64_t dm_units(const int64_t *format, int64_t unit, int64_t size)
{
    if (format[DM_BASE] == 10)
        return size / POWERS[dm_clamp(unit, 0, 18)];
    if (unit >= 0)
        return size >> dm_min(unit, 62);
    return dm_min(size, (int64_t)1 << 29) << dm_min(-unit, 32);
}

static int is_on_grid(int64_t point)
{
    return point >= -DM_EXACT_BOUND && point <= DM_EXACT_BOUND;
}

int dm_index_at(const int64_t *format, int64_t point, int64_t *index, int64_t *unit)
{
    if (!dm_is_format(format) || !is_on_grid(point))
        return DM_INVALID;
    *index = dm_nearest_index(format, point, unit);
    return DM_OK;
}

int dm_point_of(const int64_t *format, int64_t index, int64_t *point)
{
    if (!dm_is_format(format) || index == INT64_MIN)
        return DM_INVALID;
    *point = dm_grid_point(format, index);
    return DM_OK;
}

int dm_in_units(const int64_t *format, int64_t unit, int64_t size, int64_t *units)
{
    if (!dm_is_format(format) || size < 0)
        return DM_INVALID;
    *units = dm_units(format, unit, size);
    return DM_OK;
}
