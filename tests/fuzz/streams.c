/* Streams of numbers at elements; see `src/deltamesh/_streams`. */
#include "fuzz.h"

enum { FOLLOWERS = 1 << 16, FORMATS = 6, COLUMN_AT = 4 };

int64_t *decode_labels(bytes payload, graph near, int64_t *count)
{
    int64_t *const labels = take_zeros(near.n), seen = 0;
    static int64_t followers[FOLLOWERS];
    dm_coder *const c = decoder_of("labels", 0, payload);
    check(dm_code_labels(c, ROWS_OF(near), labels, followers, &seen), "dm_code_labels");
    check_end(c);
    *count = largest_of(labels, near.n) + 1;
    insist(*count == seen, "labels without gaps");
    return labels;
}

int64_t *decode_vectors(bytes payload, graph near)
{
    int64_t *const values = take_zeros(3 * near.n);
    dm_coder *const c = decoder_of("vectors", 0, payload);
    check(dm_code_deltas(c, ROWS_OF(near), values), "dm_code_deltas");
    check_end(c);
    return values;
}

int64_t *decode_three(bytes payload, const elements *e)
{
    int64_t *const values = take_zeros(3 * e->near.n);
    dm_coder *const c = decoder_of("positions", 0, payload);
    check(dm_code_positions(c, ROWS_OF(e->near), PARALLELOGRAMS_OF(e),
                            shorts_of(e->within, e->near.n), values,
                            take_numbers(3 * e->near.n)), "dm_code_positions");
    check_end(c);
    return values;
}

static int64_t read_signed(bytes *from)
{
    const int64_t value = read_little(from, 2);
    return value >= 1 << 15 ? value - (1 << 16) : value;
}

/* Whether a format is one by the rules of SPEC.md 5.12; `offset`: its places below the grid. */
static int is_format(int64_t base, int64_t places, int64_t digits, int64_t usual, int64_t offset)
{
    if (usual > 60)
        return 0;
    if (base == 2)
        return places >= -971 && places <= 1074 && digits >= 1 && digits <= 53 &&
               offset >= 58 - ((int64_t)1 << (61 - digits));
    return base == 10 && places >= 0 && places <= 22 && digits >= 1 && digits <= 17 &&
           offset >= 0 && offset <= 18;
}

/* The rows of a column in the tables of `dm_code_exact`; return the number of its formats. */
static int64_t read_column(bytes *payload, int64_t *axis, int64_t *formats, int64_t row,
                           int *deviate)
{
    const uint8_t flags = read_byte(payload);
    const int64_t grid = read_signed(payload), operations = flags >> 4 & 3, count = flags & 3;
    require(operations <= 2 && count <= 2 && (count > 0 || flags & 4), "formats of a column");
    for (int64_t k = 0; k < operations; k++) {
        require(read_byte(payload) <= 2, "an operator");
        read_bytes(payload, 8);
    }
    for (int64_t k = 0; k < count; k++) {
        const int64_t base = read_byte(payload), places = read_signed(payload);
        const int64_t digits = read_byte(payload), usual = read_byte(payload);
        int64_t *const format = formats + 4 * (row + k);
        format[0] = base, format[1] = grid - places, format[2] = digits, format[3] = usual;
        require(is_format(base, places, digits, usual, format[1]), "a number format");
        require(base == formats[4 * row], "a number format of another base");
    }
    axis[0] = row, axis[1] = count, axis[2] = (flags & 4) != 0, axis[3] = (flags & 8) != 0;
    *deviate |= flags >> 7;
    return count;
}

int64_t *decode_exact(bytes payload, const elements *e, int *width)
{
    const int64_t n = e->near.n;
    *width = read_byte(&payload);
    require(*width == 32 || *width == 64, "the width of numbers");
    int64_t *const axes = take_numbers(3 * COLUMN_AT), rows = 0;
    int64_t *const table = take_numbers(FORMATS * COLUMN_AT);
    int deviate = 0;
    for (int axis = 0; axis < 3; axis++)
        rows += read_column(&payload, axes + COLUMN_AT * axis, table, rows, &deviate);
    const bytes stream = read_bytes(&payload, deviate ? read_little(&payload, 4)
                                                      : left_of(&payload));
    int64_t *const choices = take_zeros(3 * n), *const values = take_zeros(3 * n);
    dm_coder *const c = decoder_of("exact", rows, stream);
    check(dm_code_exact(c, ROWS_OF(e->near), PARALLELOGRAMS_OF(e), axes,
                        copy_of(table, COLUMN_AT * rows), rows, *width, choices, values,
                        take_numbers(3 * n), take_numbers(3 * n)),
          "dm_code_exact");
    check_end(c);
    if (deviate)
        decode_vectors(payload, e->near);
    return values;
}
