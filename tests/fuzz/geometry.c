/* Sections of the geometry; see `src/deltamesh/_geometry`. */
#include <string.h>

#include "fuzz.h"

enum { GREEDY = 2, RANDOM = 1, MOST_BITS = 30, MOST_EXPONENT = 120, MOST_UNIT = 64 };

/* Vertices of the faces alone, their components, and the extra bits of their coordinates. */
typedef struct {
    graph near;
    int64_t components, *labels, *extra, *exponents; /* the last NULL where all steps are alike */
} solid;

static void decode_steps(bytes payload, solid *v)
{
    const int64_t count = read_byte(&payload);
    require(count >= 2, "different steps");
    const bytes distinct = read_bytes(&payload, count);
    int64_t labels, lowest = MOST_EXPONENT;
    for (int64_t k = 0; k < count; k++) {
        require(distinct.at[k] <= MOST_EXPONENT, "an exponent");
        require(!memchr(distinct.at, distinct.at[k], (size_t)k), "an exponent that comes twice");
        lowest = distinct.at[k] < lowest ? distinct.at[k] : lowest;
    }
    require(lowest == 0, "no vertex of the coarsest step");
    v->exponents = decode_labels(payload, v->near, &labels);
    require(labels <= count && (labels == count || !allowed.strict), "labels of steps");
    for (int64_t i = 0; i < v->near.n; i++) {
        v->exponents[i] = distinct.at[v->exponents[i]];
        v->extra[i] = (v->exponents[i] + 3) / 4;
    }
    tell("STEP", v->exponents, v->near.n);
}

/* The lowest vertex of each component. */
static int64_t *lowest_of(const solid *v)
{
    int64_t *const lowest = take_numbers(v->components);
    for (int64_t i = v->near.n - 1; i >= 0; i--)
        lowest[v->labels[i]] = i;
    return lowest;
}

static int64_t *random_anchors(const solid *v, uint64_t seed)
{
    const int64_t n = v->near.n;
    int64_t *const keys = take_numbers(n), *const anchors = take_numbers(n), at = v->components;
    for (int64_t i = 0; i < n; i++) {
        uint64_t z = seed + (uint64_t)(i + 1) * 0x9E3779B97F4A7C15u;
        z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
        z = (z ^ z >> 27) * 0x94D049BB133111EBu;
        keys[i] = (int64_t)((z ^ z >> 31) ^ (uint64_t)1 << 63); /* in the order without a sign */
    }
    const int64_t *const order = order_of(keys, n);
    int64_t *const found = take_zeros(v->components);
    for (int64_t k = 0; k < n; k++) {
        const int64_t label = v->labels[order[k]];
        if (!found[label])
            anchors[label] = order[k], found[label] = 1;
        else
            anchors[at++] = order[k];
    }
    return anchors;
}

static int64_t *anchors_of(const container *file, const solid *v)
{
    const int64_t k = file->anchor_count, n = v->near.n;
    require(k >= v->components && k <= n, "a component without an anchor");
    if (file->anchor_method == RANDOM)
        return random_anchors(v, file->seed);
    int64_t *const anchors = take_numbers(k);
    check(dm_farthest_points(ROWS_OF(v->near), lowest_of(v), v->components, anchors, k,
                             take_numbers(n), take_numbers(n)),
          "dm_farthest_points");
    return anchors;
}

static int64_t *read_grid_bits(bytes *payload)
{
    int64_t *const bits = take_numbers(3);
    for (int axis = 0; axis < 3; axis++) {
        bits[axis] = read_byte(payload);
        require(bits[axis] <= MOST_BITS, "bits of a grid");
    }
    return bits;
}

static int64_t *extra_of(const solid *v, const int64_t *vertices, int64_t count)
{
    int64_t *const extra = take_numbers(count);
    for (int64_t k = 0; k < count; k++)
        extra[k] = v->extra[vertices[k]];
    return extra;
}

static const int64_t *decode_anchors(const container *file, const solid *v, int64_t isolated)
{
    bytes payload = file->sections[ANCH];
    const int64_t *const bits = read_grid_bits(&payload);
    const int64_t k = file->anchor_count;
    int64_t *const positions = take_zeros(3 * k), *const others = take_zeros(3 * isolated);
    int64_t *anchors = take_zeros(k), *const covered = take_zeros(v->components);
    dm_coder *const c = decoder_of("points", 0, payload);
    if (file->anchor_method == GREEDY)
        check(dm_code_gaps(c, anchors, k, v->near.n), "dm_code_gaps");
    else
        anchors = anchors_of(file, v);
    for (int64_t i = 0; i < k; i++)
        covered[v->labels[anchors[i]]] = 1;
    for (int64_t i = 0; i < v->components; i++)
        require(covered[i] == 1, "a component without an anchor");
    check(dm_code_points(c, positions, k, bits, extra_of(v, anchors, k)), "dm_code_points");
    if (isolated > 0)
        check(dm_code_sorted_points(c, others, isolated, bits), "dm_code_sorted_points");
    check_end(c);
    tell("anchors", anchors, k);
    tell("ANCH", positions, 3 * k);
    tell("isolated", others, 3 * isolated);
    return anchors;
}

/* What the cells of anchors have lost in whose components there are others. */
static void decode_cells(const container *file, const solid *v, const int64_t *anchors)
{
    bytes payload = file->sections[CELL];
    const int64_t stages = file->method == 2 ? 2 : 1, k = file->anchor_count;
    int64_t *const held = take_zeros(v->components), *const units = take_numbers(stages);
    int64_t rows = 0, some = 0;
    for (int64_t i = 0; i < k; i++)
        held[v->labels[anchors[i]]]++;
    for (int64_t i = 0; i < k; i++)
        rows += held[v->labels[anchors[i]]] > 1 ? stages : 0;
    require(file->interpolated && rows > 0, "vectors of cells that have none");
    for (int64_t i = 0; i < stages; i++) {
        units[i] = read_byte(&payload) - MOST_UNIT / 2;
        require(units[i] <= MOST_UNIT / 2, "a unit");
    }
    const graph none = {.n = rows, .entries = 0, .indptr = take_zeros(rows + 1),
                        .indices = take_numbers(0)};
    int64_t *const values = decode_vectors(payload, none);
    for (int64_t i = 0; i < 3 * rows; i++)
        some |= values[i] != 0;
    require(some || !allowed.strict, "no cell has lost anything");
    int64_t *const nearest = take_numbers(v->near.n);
    check(dm_nearest(ROWS_OF(v->near), anchors, k, nearest, take_numbers(v->near.n)),
          "dm_nearest");
    for (int64_t i = 0; i < v->near.n; i++)
        insist(nearest[i] >= 0 && v->labels[anchors[nearest[i]]] == v->labels[i], "a cell");
    tell("units", units, stages);
    tell("CELL", values, 3 * rows);
}

static void decode_deltas(const container *file, const solid *v)
{
    int64_t *deltas = take_zeros(3 * v->near.n);
    require(file->sections[DELT].at != NULL, "DELT is missing");
    if (file->has_step)
        deltas = decode_vectors(file->sections[DELT], v->near);
    else
        require(left_of(&file->sections[DELT]) == 0, "deltas in a file of 0 bits");
    tell("DELT", deltas, 3 * v->near.n);
    if (file->sections[FIXS].at) {
        require(file->has_step, "corrections in a file of 0 bits");
        tell("FIXS", decode_vectors(file->sections[FIXS], v->near), 3 * v->near.n);
    }
    if (file->method != 2)
        return;
    require(file->sections[NORM].at != NULL, "NORM is missing");
    int64_t *const refinements = take_zeros(v->near.n);
    dm_coder *const c = decoder_of("vectors", 0, file->sections[NORM]);
    check(dm_code_refinements(c, ROWS_OF(v->near), deltas, refinements), "dm_code_refinements");
    check_end(c);
    tell("NORM", refinements, v->near.n);
}

static void decode_cartesian(bytes payload, const solid *v, const elements *surface)
{
    if (!v->exponents) {
        tell("CART", decode_three(payload, surface), 3 * surface->near.n);
        return;
    }
    const int64_t *const first = lowest_of(v), count = v->components;
    for (int64_t i = 0; i < v->near.n; i++)
        require(v->exponents[i] == v->exponents[first[v->labels[i]]] || !allowed.strict,
                "steps that differ within a component");
    const int64_t *const bits = read_grid_bits(&payload);
    int64_t *const roots = take_zeros(3 * count);
    const bytes stream = read_bytes(&payload, read_varint(&payload));
    dm_coder *const c = decoder_of("points", 0, stream);
    check(dm_code_points(c, roots, count, bits, extra_of(v, first, count)), "dm_code_points");
    check_end(c);
    int64_t *const values = decode_three(payload, surface);
    for (int64_t i = 0; i < v->near.n; i++)
        for (int axis = 0; axis < 3; axis++)
            values[3 * i + axis] += roots[3 * v->labels[i] + axis];
    tell("CART", values, 3 * surface->near.n);
}

void decode_geometry(const container *file, const structure *s, const elements *surface)
{
    if (file->method == 3) {
        int width;
        require(file->sections[EXAC].at != NULL && !file->sections[STEP].at, "EXAC is missing");
        decode_exact(file->sections[EXAC], surface, &width);
        return;
    }
    solid v = {.near = surface->near};
    v.near.n = s->used;
    v.near.indptr = copy_of(surface->near.indptr, s->used + 1);
    v.labels = take_numbers(s->used), v.extra = take_zeros(s->used);
    check(dm_label_components(ROWS_OF(v.near), v.labels, take_numbers(s->used),
                              &v.components), "dm_label_components");
    if (file->sections[STEP].at) {
        require(file->has_step, "steps by vertex in a file of 0 bits");
        decode_steps(file->sections[STEP], &v);
    }
    if (file->method == 1) {
        require(file->sections[CART].at != NULL, "CART is missing");
        decode_cartesian(file->sections[CART], &v, surface);
        return;
    }
    require(file->sections[ANCH].at != NULL, "ANCH is missing");
    const int64_t *const anchors = decode_anchors(file, &v, s->isolated);
    decode_deltas(file, &v);
    if (file->sections[CELL].at)
        decode_cells(file, &v, anchors);
    if (file->sections[POSE].at)
        decode_poses(file->sections[POSE], v.near, anchors, file->anchor_count);
}
