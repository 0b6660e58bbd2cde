/* Quantized positions, predicted by parallelograms and neighbours.

   Each vertex has several predictions, the mean of all parallelograms that are known first (Touma &
   Gotsman, "Triangle Mesh Compression", Graphics Interface 1998; Cohen-Or, Cohen, Irony, "Multi-way
   Geometry Encoding", 2002), and the others for where parallelograms mislead: fans of slivers
   around a hub, rows of vertices along a crease. Which one counts is settled for each axis by the
   errors that all had at vertices of the same class; where Draco sends flags for the parallelograms
   that it leaves out, nothing is sent. The parallelogram within a quad is better than those across
   its edges (Isenburg & Alliez, "Compressing polygon mesh geometry with parallelogram prediction",
   IEEE Visualization 2002): where there is one, it is the first prediction, and the mean of all the
   last. The coordinates of the vertices around are candidates (see `signed_integers.h`): on machine
   parts most coordinates are those of a neighbour. */
#include "parallelogram.h"

#include "graphs.h"

enum { MEAN, NEAR, LINE, GATE, AROUND };

/* Errors of a prediction are remembered over some 2^DECAY vertices of a class. Another than the
   mean of the parallelograms is taken only if it errs by less than a third as much: per axis,
   choices are noisy. Of the factors 1.25, 1.5, 2, 3 and 5, 3 makes the smallest files on the mean.
 */
enum { DECAY = 8, MARGIN = 3 };

/* The mesh that positions are coded on. */
typedef struct {
    const int32_t *indptr, *indices, *first, *corners, *within;
    const int64_t *values;
} grid_mesh;

/* What is predicted at a vertex: the predictions, the candidates' positions, and the class. */
typedef struct {
    int64_t predictions[3][DM_PREDICTIONS], positions[3][DM_CANDIDATES], kind;
} prediction;

/* What was learnt: errors of the predictions, and how often the candidates were right. */
typedef struct {
    int64_t errors[3][DM_CLASSES][DM_PREDICTIONS], fortunes[3][DM_CANDIDATES];
} experience;

/* Sum up the residuals of the known neighbours. */
static void look_around(const grid_mesh *mesh, const int64_t *residuals, int64_t i, dm_known *known)
{
    for (int64_t at = mesh->indptr[i]; at < mesh->indptr[i + 1]; at++) {
        const int64_t j = mesh->indices[at];
        if (j >= i)
            break; /* neighbours ascend */
        known->neighbours++;
        for (int axis = 0; axis < 3; axis++) {
            known->sum[axis] += residuals[3 * j + axis];
            known->absolute[axis] += dm_size(residuals[3 * j + axis]);
        }
    }
    for (int axis = 0; axis < 3; axis++)
        known->last[axis] = i > 0 ? residuals[3 * (i - 1) + axis] : 0;
}

/* The sum of the distances along the axes. */
static int64_t distance(const int64_t *values, int64_t i, int64_t j)
{
    int64_t total = 0;
    for (int axis = 0; axis < 3; axis++)
        total += dm_size(values[3 * i + axis] - values[3 * j + axis]);
    return total;
}

/* The mean of the known neighbours; 0 without any, as within a polygon. */
static int64_t neighbour_mean(const grid_mesh *mesh, int64_t i, int axis)
{
    int64_t total = 0, count = 0;
    for (int64_t at = mesh->indptr[i]; at < mesh->indptr[i + 1]; at++) {
        if (mesh->indices[at] < i) {
            total = dm_add(total, mesh->values[INT64_C(3) * mesh->indices[at] + axis]);
            count++;
        }
    }
    return count > 0 ? dm_quotient(total, count) : 0;
}

/* The parallelogram whose triangle has the most equal sides at its apex, and these in eighths. */
static int64_t find_gate(const grid_mesh *mesh, int64_t first, int64_t end, int64_t *shape)
{
    int64_t gate = first;
    *shape = -1;
    for (int64_t at = first; at < end; at++) {
        const int32_t *const corner = mesh->corners + 3 * at;
        const int64_t one = distance(mesh->values, corner[0], corner[2]);
        const int64_t other = distance(mesh->values, corner[1], corner[2]);
        const int64_t found = 8 * dm_min(one, other) / dm_max(dm_max(one, other), 1);
        if (found > *shape)
            gate = at, *shape = found;
    }
    return gate;
}

/* Predict where there is no parallelogram. */
static void predict_alone(const grid_mesh *mesh, int64_t i, const dm_known *known, prediction *p)
{
    const int64_t before = dm_max(i - 1, 0);
    int64_t last = before;
    for (int64_t at = mesh->indptr[i]; at < mesh->indptr[i + 1]; at++)
        if (mesh->indices[at] < i)
            last = mesh->indices[at];
    for (int axis = 0; axis < 3; axis++) {
        const int64_t previous = i > 0 ? mesh->values[3 * before + axis] : 0;
        int64_t near = i > 0 ? mesh->values[3 * last + axis] : 0, mean = previous;
        if (known->neighbours > 0)
            mean = neighbour_mean(mesh, i, axis);
        else
            near = previous;
        for (int k = 0; k < DM_PREDICTIONS; k++)
            p->predictions[axis][k] = mean;
        p->predictions[axis][NEAR] = near;
        p->predictions[axis][LINE] = previous;
        p->positions[axis][0] = near;
        p->positions[axis][1] = previous;
        p->positions[axis][2] = mean;
    }
    p->kind = dm_min(known->neighbours, 3);
}

/* Set the predictions, the candidates' positions, the class, and more of what is known. */
static void predict(const grid_mesh *mesh, int64_t i, dm_known *known, prediction *p)
{
    const int64_t *const values = mesh->values;
    const int64_t begin = mesh->first[i], count = mesh->first[i + 1] - begin;
    known->kind = dm_min(count, 3);
    if (count == 0) {
        predict_alone(mesh, i, known, p);
        return;
    }
    const int64_t inside = mesh->within[i], best = inside > 0 ? inside : count;
    int64_t shape;
    const int32_t *const gate = mesh->corners + 3 * find_gate(mesh, begin, begin + best, &shape);
    const int64_t o = gate[2];
    const int turned = distance(values, gate[1], o) < distance(values, gate[0], o);
    const int64_t a = gate[turned ? 1 : 0], b = gate[turned ? 0 : 1];
    int64_t spread = 0;
    for (int axis = 0; axis < 3; axis++) {
        int64_t total = 0, some = 0, low = 4 * DM_GRID_BOUND, high = -4 * DM_GRID_BOUND;
        for (int64_t at = begin; at < begin + count; at++) {
            const int32_t *const corner = mesh->corners + 3 * at;
            const int64_t point = values[INT64_C(3) * corner[0] + axis] +
                                  values[INT64_C(3) * corner[1] + axis] -
                                  values[INT64_C(3) * corner[2] + axis];
            total = dm_add(total, point);
            if (at - begin < best)
                some = dm_add(some, point);
            low = dm_min(low, point), high = dm_max(high, point);
        }
        const int64_t near = values[3 * a + axis], far = values[3 * b + axis];
        const int64_t apex = values[3 * o + axis];
        int64_t *const found = p->predictions[axis];
        found[MEAN] = dm_quotient(dm_add(dm_times(2, some), best), 2 * best);
        found[NEAR] = near;
        found[LINE] = 2 * near - apex;
        found[GATE] = near + far - apex;
        found[AROUND] = inside > 0 ? dm_quotient(dm_add(dm_times(2, total), count), 2 * count)
                                   : neighbour_mean(mesh, i, axis);
        p->positions[axis][0] = near;
        p->positions[axis][1] = far;
        p->positions[axis][2] = apex;
        known->hint[axis] = high - low;
        spread += high - low;
    }
    known->hint_all = dm_level(spread) / 2;
    p->kind = 4 + (dm_min(count, 3) + (inside > 0 ? 4 : 0)) * DM_SHAPES + shape;
}

/* The prediction with the least error. */
static int64_t choose(const int64_t *errors, int inside)
{
    int64_t chosen = 0;
    for (int64_t k = 1; k < DM_PREDICTIONS; k++) {
        const int64_t margin = chosen == MEAN && !(inside && k == AROUND) ? MARGIN : 1;
        if (errors[k] * margin < errors[chosen])
            chosen = k;
    }
    return chosen;
}

/* Code one position, `value` and `residual` (3,), and learn from it. */
static void code_position(dm_coder *c, const prediction *p, const dm_known *known, experience *e,
                          int64_t *value, int64_t *residual)
{
    int64_t magnitudes[DM_MAGNITUDES + 1], signs[DM_SIGNS + 1];
    int64_t numbers[DM_CANDIDATES], histories[DM_CANDIDATES], spent = 0, along = 0;
    const dm_candidates candidates = {numbers, histories, DM_CANDIDATES};
    const int64_t total = dm_total(known);
    for (int axis = 0; axis < 3; axis++) {
        const int64_t *const predictions = p->predictions[axis];
        int64_t *const errors = e->errors[axis][p->kind], *const fortunes = e->fortunes[axis];
        const int64_t chosen = choose(errors, p->kind >= DM_INSIDE);
        const int64_t base = predictions[chosen];
        dm_set_magnitudes(magnitudes, known, axis, total, spent);
        const int64_t step = dm_level(dm_size(predictions[MEAN] - predictions[NEAR])) / 2;
        magnitudes[DM_MAGNITUDES] = (p->kind * DM_PREDICTIONS + chosen) * 8 + dm_min(step, 7);
        dm_set_signs(signs, known, axis, along);
        signs[DM_SIGNS] = dm_side(predictions[NEAR] - base);
        for (int k = 0; k < DM_CANDIDATES; k++) {
            numbers[k] = p->positions[axis][k] - base;
            histories[k] = 2 * fortunes[k] + (numbers[k] == 0);
        }
        const int64_t r = dm_code_signed(c, value[axis] - base, axis, magnitudes,
                                         DM_MAGNITUDES + 1, signs, DM_SIGNS + 1, &candidates);
        residual[axis] = r;
        value[axis] = dm_clamp(base + r, -DM_GRID_BOUND, DM_GRID_BOUND);
        for (int k = 0; k < DM_CANDIDATES; k++)
            fortunes[k] = (2 * fortunes[k] + (r == numbers[k])) & 15;
        for (int k = 0; k < DM_PREDICTIONS; k++)
            errors[k] += 16 * dm_size(base + r - predictions[k]) - (errors[k] >> DECAY);
        spent += dm_size(r);
        along = dm_add(along, dm_times(known->sum[axis], r));
    }
}

static int is_mesh(const grid_mesh *mesh, int64_t n, int64_t entries, int64_t count)
{
    int good = dm_is_graph(mesh->indptr, n, mesh->indices, entries) &&
               dm_are_short_bounds(mesh->first, n, count) &&
               dm_are_shorts_in(mesh->corners, 3 * count, 0, n);
    for (int64_t i = 0; good && i < n; i++)
        good = mesh->within[i] >= 0 && mesh->within[i] <= mesh->first[i + 1] - mesh->first[i];
    return good;
}

/* Code `values` (n, 3), filled in when decoding; `residuals` (n, 3) is scratch.

   corners[first[i]] to corners[first[i + 1]] (count, 3) are the vertices (a, b, o), all below i, of
   the triangles (a, b, o) across an edge of a triangle (a, b, i); the first within[i] are quads
   (a, o, b, i) of the mesh. Neighbours ascend in the rows of the graph. */
int dm_code_positions(dm_coder *c, const int32_t *indptr, int64_t n, const int32_t *indices,
                      int64_t entries, const int32_t *first, const int32_t *corners, int64_t count,
                      const int32_t *within, int64_t *values, int64_t *residuals)
{
    const grid_mesh mesh = {indptr, indices, first, corners, within, values};
    if (!dm_has_memory(c, DM_HASH_SLOTS, 3 * DM_AXIS_MIXERS) || !is_mesh(&mesh, n, entries, count))
        return DM_INVALID;
    experience e = {0};
    for (int64_t i = 0; i < n; i++)
        for (int axis = 0; axis < 3; axis++)
            residuals[3 * i + axis] = 0;
    for (int64_t i = 0; i < n; i++) {
        dm_known known = {0};
        prediction p;
        look_around(&mesh, residuals, i, &known);
        predict(&mesh, i, &known, &p);
        code_position(c, &p, &known, &e, values + 3 * i, residuals + 3 * i);
    }
    return DM_OK;
}

/* Predict one vertex: predictions (3, 5), positions (3, 3), hints (3,) and the class, for tests. */
int dm_predict(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
               const int32_t *first, const int32_t *corners, int64_t count, const int32_t *within,
               const int64_t *values, int64_t i, int64_t *predictions, int64_t *positions,
               int64_t *hints, int64_t *kind)
{
    const grid_mesh mesh = {indptr, indices, first, corners, within, values};
    if (i < 0 || i >= n || !is_mesh(&mesh, n, entries, count))
        return DM_INVALID;
    dm_known known = {0};
    prediction p;
    for (int64_t at = indptr[i]; at < indptr[i + 1]; at++)
        known.neighbours += indices[at] < i;
    predict(&mesh, i, &known, &p);
    for (int axis = 0; axis < 3; axis++) {
        for (int k = 0; k < DM_PREDICTIONS; k++)
            predictions[DM_PREDICTIONS * axis + k] = p.predictions[axis][k];
        for (int k = 0; k < DM_CANDIDATES; k++)
            positions[DM_CANDIDATES * axis + k] = p.positions[axis][k];
        hints[axis] = known.hint[axis];
    }
    *kind = p.kind;
    return DM_OK;
}
