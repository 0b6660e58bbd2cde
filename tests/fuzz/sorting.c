/* Sorted keys, and what follows from groups. */
#include <stdlib.h>

#include "fuzz.h"

typedef struct {
    int64_t key, index;
} row;

static int compare(const void *a, const void *b)
{
    const row *const x = a, *const y = b;
    if (x->key != y->key)
        return x->key < y->key ? -1 : 1;
    return (x->index > y->index) - (x->index < y->index);
}

int64_t *order_of(const int64_t *keys, int64_t count)
{
    row *const rows = take_bytes((size_t)count * sizeof(row));
    int64_t *const order = take_numbers(count);
    for (int64_t i = 0; i < count; i++)
        rows[i] = (row){keys[i], i};
    if (count > 0)
        qsort(rows, (size_t)count, sizeof(row), compare);
    for (int64_t i = 0; i < count; i++)
        order[i] = rows[i].index;
    return order;
}

int64_t *inverse_of(const int64_t *order, int64_t count)
{
    int64_t *const inverse = take_numbers(count);
    for (int64_t i = 0; i < count; i++)
        inverse[order[i]] = i;
    return inverse;
}

int64_t largest_of(const int64_t *numbers, int64_t count)
{
    int64_t largest = -1;
    for (int64_t i = 0; i < count; i++)
        largest = numbers[i] > largest ? numbers[i] : largest;
    return largest;
}

int64_t *starts_of(const int64_t *groups, int64_t count, int64_t n)
{
    int64_t *const starts = take_zeros(n + 1);
    for (int64_t i = 0; i < count; i++)
        starts[groups[i] + 1]++;
    for (int64_t i = 0; i < n; i++)
        starts[i + 1] += starts[i];
    return starts;
}
