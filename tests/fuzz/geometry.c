/* Sections of the geometry; see `src/deltamesh/_geometry`. */
#include <string.h>

#include "fuzz.h"

enum { GREEDY = 2, RANDOM = 1, MOST_BITS = 30, MOST_EXPONENT = 120, MOST_UNIT = 64 };
/* Of a frame: bits of its flags, the bytes between its grid and its maps, and its largest numbers. */
enum { KEY = 1, HAS_CELLS = 2, HAS_FIXES = 4, BETWEEN = 8 + 5 * 4 + 8, MOST_HALVINGS = 30 };
enum { CRC = 4, MOST_RUN = 255 };

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

static graph without_edges(int64_t n)
{
    return (graph){.n = n, .entries = 0, .indptr = take_zeros(n + 1), .indices = take_numbers(0)};
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
    int64_t *const values = decode_vectors(payload, without_edges(rows));
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

/* The linear maps of a frame, each smoothed into those of its neighbours. */
static void decode_maps(bytes payload, const solid *v, int64_t maps, int64_t rounds)
{
    const int64_t n = v->near.n, places = 10 * n;
    require(maps >= v->components && maps <= n, "a component without a map");
    int64_t *const rows = decode_vectors(payload, without_edges(3 * maps)), some = 0;
    for (int64_t i = 0; i < 9 * maps; i++)
        some |= rows[i] != 0;
    require(some || !allowed.strict, "no map moves anything");
    int64_t *const centres = take_numbers(maps), *const nearest = take_numbers(n);
    check(dm_farthest_points(ROWS_OF(v->near), lowest_of(v), v->components, centres, maps,
                             take_numbers(n), take_numbers(n)),
          "dm_farthest_points");
    check(dm_nearest(ROWS_OF(v->near), centres, maps, nearest, take_numbers(n)), "dm_nearest");
    double *const each = take_bytes((size_t)places * sizeof(double));
    for (int64_t i = 0; i < places; i++)
        each[i] = i % 10 == 9 ? 1 : (double)rows[9 * nearest[i / 10] + i % 10];
    check(dm_smooth(ROWS_OF(v->near), each, 10, rounds,
                    take_bytes((size_t)places * sizeof(double))),
          "dm_smooth");
    tell("MAPS", rows, 9 * maps);
}

/* A frame of a sequence: the streams of the geometry again, as seen from another frame. */
static void decode_frame(bytes record, int64_t index, const container *file, const solid *v,
                         const elements *surface, const int64_t *anchors)
{
    static const int OF_ANCHORS[] = {ANCH, DELT, NORM}, OF_GRID[] = {CART};
    const int on_grid = file->method == 1, last = file->method == 2 ? 3 : 2;
    const int64_t flags = read_byte(&record);
    require(flags <= (KEY | HAS_CELLS | HAS_FIXES) && !(flags & KEY && index == 1), "flags");
    require(!(flags & HAS_CELLS) || file->interpolated, "vectors of cells that have none");
    require(!(flags & HAS_FIXES) || !on_grid, "corrections in a Cartesian file");
    require(read_byte(&record) <= MOST_HALVINGS, "halvings of a grid");
    read_bytes(&record, BETWEEN);
    const int64_t maps = read_varint(&record), rounds = maps ? read_byte(&record) : 0;
    require(!maps || (!on_grid && read_byte(&record) <= MOST_BITS), "maps");
    int streams[6], count = 0, moving = maps > 0;
    for (int k = 0; k < (on_grid ? 1 : last); k++)
        streams[count++] = on_grid ? OF_GRID[k] : OF_ANCHORS[k];
    if (flags & HAS_CELLS)
        streams[count++] = CELL;
    if (flags & HAS_FIXES)
        streams[count++] = FIXS;
    container one = *file;
    one.sections[CELL].at = one.sections[FIXS].at = NULL;
    const int64_t size_of_maps = moving ? read_varint(&record) : 0;
    int64_t sizes[6];
    for (int k = 0; k < count; k++)
        sizes[k] = read_varint(&record);
    const bytes of_maps = read_bytes(&record, size_of_maps);
    for (int k = 0; k < count; k++)
        one.sections[streams[k]] = read_bytes(&record, sizes[k]);
    require(left_of(&record) == 0, "bytes after the last stream");
    tell("FRAM", &index, 1);
    if (moving)
        decode_maps(of_maps, v, maps, rounds);
    if (on_grid) {
        tell("CART", decode_three(one.sections[CART], surface), 3 * surface->near.n);
        return;
    }
    const int64_t k = file->anchor_count, isolated = surface->near.n - v->near.n;
    int64_t *const points = decode_vectors(one.sections[ANCH], without_edges(k + isolated));
    tell("ANCH", points, 3 * k);
    tell("isolated", points + 3 * k, 3 * isolated);
    decode_deltas(&one, v);
    if (flags & HAS_CELLS)
        decode_cells(&one, v, anchors);
}

static void decode_frames(const container *file, const solid *v, const elements *surface,
                          const int64_t *anchors)
{
    bytes payload = file->sections[FRAM];
    require(file->has_step, "frames in a file of 0 bits");
    read_bytes(&payload, 8); /* the rate */
    const int64_t count = read_varint(&payload);
    require(count > 0 && count <= left_of(&payload), "a number of frames");
    int64_t *const sizes = take_numbers(count), run = 0;
    for (int64_t i = 0; i < count; i++)
        sizes[i] = read_varint(&payload);
    for (int64_t i = 0; i < count; i++) {
        bytes record = read_bytes(&payload, sizes[i]);
        require(left_of(&record) > CRC, "truncated");
        run = *record.at & KEY ? 0 : run + 1;
        require(run <= MOST_RUN, "too many frames since a key frame");
        record.end -= CRC; /* a checksum, whatever it is */
        decode_frame(record, i + 1, file, v, surface, anchors);
    }
    require(left_of(&payload) == 0, "bytes after the last frame");
    tell("FRAM", &(int64_t){0}, 1); /* what follows is of frame 0 */
}

void decode_geometry(const container *file, const structure *s, const elements *surface)
{
    if (file->method == 3) {
        int width;
        require(file->sections[EXAC].at != NULL && !file->sections[STEP].at, "EXAC is missing");
        require(!file->sections[FRAM].at, "frames in a lossless file");
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
        if (file->sections[FRAM].at)
            decode_frames(file, &v, surface, NULL);
        return;
    }
    require(file->sections[ANCH].at != NULL, "ANCH is missing");
    const int64_t *const anchors = decode_anchors(file, &v, s->isolated);
    decode_deltas(file, &v);
    if (file->sections[CELL].at)
        decode_cells(file, &v, anchors);
    if (file->sections[POSE].at)
        decode_poses(file->sections[POSE], v.near, anchors, file->anchor_count);
    if (file->sections[FRAM].at)
        decode_frames(file, &v, surface, anchors);
}
