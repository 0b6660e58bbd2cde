/* Section POSE: the tree of the anchors, and motions along it; see
   `src/deltamesh/_geometry/poses.py`. */
#include "fuzz.h"

/* Pairs of cells that edges join, the lower one first, those of the longest borders first. */
typedef struct {
    int64_t count, *low, *high;
} borders;

static borders borders_of(graph near, const int64_t *cell, int64_t k)
{
    int64_t *const keys = take_numbers(near.entries), crossing = 0;
    for (int64_t v = 0; v < near.n; v++)
        for (int64_t e = near.indptr[v]; e < near.indptr[v + 1]; e++)
            if (cell[v] < cell[near.indices[e]])
                keys[crossing++] = cell[v] * k + cell[near.indices[e]];
    const int64_t *const order = order_of(keys, crossing);
    int64_t *const pairs = take_numbers(crossing), *const lengths = take_numbers(crossing);
    int64_t count = 0;
    for (int64_t i = 0; i < crossing; i++) {
        const int64_t key = keys[order[i]];
        if (count == 0 || pairs[count - 1] != key)
            pairs[count] = key, lengths[count++] = 0;
        lengths[count - 1]--;
    }
    const int64_t *const by_length = order_of(lengths, count);
    borders found = {count, take_numbers(count), take_numbers(count)};
    for (int64_t i = 0; i < count; i++) {
        found.low[i] = pairs[by_length[i]] / k;
        found.high[i] = pairs[by_length[i]] % k;
    }
    return found;
}

/* What predicts displacements and turns, in the order of the anchors. */
static graph motions_of(borders b, const int64_t *order, int64_t k)
{
    const int64_t *const rank = inverse_of(order, k);
    int64_t *const from = take_numbers(2 * b.count + k), *const to = take_numbers(2 * b.count + k);
    for (int64_t i = 0; i < b.count; i++) {
        from[i] = rank[b.low[i]], to[i] = rank[b.high[i]];
        from[b.count + i] = from[i] + k, to[b.count + i] = to[i] + k;
    }
    for (int64_t i = 0; i < k; i++)
        from[2 * b.count + i] = i, to[2 * b.count + i] = i + k;
    return graph_of_pairs(from, to, 2 * b.count + k, 2 * k);
}

static graph forest_of(borders b, int64_t k)
{
    uint8_t *const kept = take_bytes((size_t)b.count);
    check(dm_span(b.low, b.high, b.count, k, kept, take_numbers(k)), "dm_span");
    int64_t *const from = take_numbers(b.count), *const to = take_numbers(b.count), count = 0;
    for (int64_t i = 0; i < b.count; i++)
        if (kept[i])
            from[count] = b.low[i], to[count++] = b.high[i];
    return graph_of_pairs(from, to, count, k);
}

void decode_poses(bytes payload, graph near, const int64_t *anchors, int64_t k)
{
    int64_t *const cell = take_numbers(near.n);
    int64_t *const order = take_numbers(k), *const parent = take_numbers(k);
    check(dm_nearest(ROWS_OF(near), anchors, k, cell, take_numbers(near.n)), "dm_nearest");
    const borders b = borders_of(near, cell, k);
    const graph forest = forest_of(b, k);
    check(dm_walk_forest(ROWS_OF(forest), order, parent), "dm_walk_forest");
    const graph motions = motions_of(b, order, k);
    double *const rest = take_bytes((size_t)(3 * k) * sizeof(double));
    for (int64_t i = 0; i < 3 * k; i++)
        rest[i] = (double)(i % 7);
    do {
        read_bytes(&payload, read_byte(&payload)); /* the name */
        read_bytes(&payload, 8);                   /* the step */
        require(read_byte(&payload) <= 24, "a unit of rotations");
        int64_t *const rows = decode_vectors(read_bytes(&payload, read_varint(&payload)), motions);
        int64_t *const numbers = take_numbers(6 * k);
        for (int64_t i = 0; i < k; i++)
            for (int a = 0; a < 3; a++) {
                numbers[6 * order[i] + a] = rows[3 * i + a];
                numbers[6 * order[i] + 3 + a] = rows[3 * (k + i) + a];
            }
        check(dm_carry_motions(order, parent, k, rest, 0.5, 0.5, 0, numbers,
                               take_bytes((size_t)(3 * k) * sizeof(double)),
                               take_bytes((size_t)(4 * k) * sizeof(double))),
              "dm_carry_motions");
        tell("POSE", numbers, 6 * k);
    } while (left_of(&payload) > 0);
}
