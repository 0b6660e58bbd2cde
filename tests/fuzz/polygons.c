/* Section POLY, and the elements of a structure; see `src/deltamesh/_shape`. */
#include <string.h>

#include "fuzz.h"

/* A half-edge of the manifold as one of the mesh. */
static int64_t of_mesh(const structure *s, int64_t h)
{
    return h - h % 3 + (s->reversed[h / 3] ? 2 - h % 3 : h % 3);
}

static int64_t *merge_candidates(const structure *s)
{
    const int64_t count = 3 * s->triangles, *const start = s->triangle;
    const int64_t n = largest_of(start, count) + 1;
    int64_t *const candidate = take_numbers(count), *const rest = take_numbers(count);
    for (int64_t h = 0; h < count; h++)
        candidate[h] = -1;
    for (int64_t h = 0; h < 3 * s->m; h++) {
        if (s->opposite[h] < 0)
            continue;
        const int64_t one = of_mesh(s, h), other = of_mesh(s, s->opposite[h]);
        if (start[one] == start[after_in_face(other)] && start[after_in_face(one)] == start[other])
            candidate[one] = other;
    }
    int64_t left = 0, *const key = take_numbers(count);
    for (int64_t h = 0; h < count; h++) {
        const int64_t a = start[h], b = start[after_in_face(h)];
        if (candidate[h] >= 0 || a == b)
            continue;
        key[left] = ((a < b ? a : b) * n + (a < b ? b : a)) * 2 + (a > b);
        rest[left++] = h;
    }
    const int64_t *const order = order_of(key, left);
    for (int64_t first = 0, end; first < left; first = end) {
        const int64_t edge = key[order[first]] / 2;
        int64_t forward = 0;
        for (end = first; end < left && key[order[end]] / 2 == edge; end++)
            forward += key[order[end]] % 2 == 0;
        for (int64_t k = 0; k < forward && first + forward + k < end; k++) {
            const int64_t one = rest[order[first + k]], other = rest[order[first + forward + k]];
            candidate[one] = other, candidate[other] = one;
        }
    }
    return candidate;
}

static void decode_pairs(dm_coder *c, const structure *s, const int64_t *candidate,
                         int64_t *parent, int64_t *size, int64_t most, int64_t total)
{
    const int64_t count = 3 * s->triangles, n = largest_of(s->triangle, count) + 1;
    int64_t *const key = take_numbers(count), *const group = take_numbers(count), groups = 0;
    for (int64_t h = 0; h < count; h++)
        key[h] = s->triangle[h] * n + s->triangle[after_in_face(h)];
    int64_t *const order = order_of(key, count), *const keys = take_numbers(count);
    for (int64_t k = 0; k < count; k++) {
        if (k == 0 || key[order[k]] != key[order[k - 1]])
            keys[groups++] = key[order[k]];
        group[order[k]] = groups - 1;
    }
    int64_t *const across = take_numbers(groups);
    for (int64_t g = 0; g < groups; g++) {
        const int64_t back = keys[g] % n * n + keys[g] / n;
        across[g] = -1;
        for (int64_t k = 0; k < groups; k++)
            if (keys[k] == back)
                across[g] = k;
    }
    check(dm_code_explicit_pairs(c, candidate, s->triangles, take_numbers(0), s->merged, parent,
                                 size, most, total, order, group, across,
                                 starts_of(group, count, groups), groups, take_numbers(groups),
                                 take_numbers(count), take_numbers(count)),
          "dm_code_explicit_pairs");
}

void decode_polygons(bytes payload, structure *s)
{
    const int64_t m = s->triangles, count = read_varint(&payload), least = read_varint(&payload);
    const int64_t most = read_varint(&payload), total = read_varint(&payload);
    require(count > 0 && count < m && least >= 3 && least <= most && most <= m + 2 &&
            total <= m - count, "counts of POLY");
    const int64_t *const candidate = merge_candidates(s);
    const int64_t vertices = largest_of(s->triangle, 3 * m) + 1;
    int64_t *const parent = take_numbers(m), *const size = take_numbers(m);
    s->merged = take_numbers(3 * m);
    for (int64_t h = 0; h < 3 * m; h++)
        s->merged[h] = -1;
    for (int64_t f = 0; f < m; f++)
        parent[f] = f, size[f] = 3;
    dm_coder *const c = decoder_of("hidden_edges", 0, payload);
    check(dm_code_hidden(c, s->triangle, m, vertices, candidate, s->merged, parent, size, least,
                         most, total > 0, take_numbers(3 * m), take_numbers(m),
                         take_numbers(3 * vertices)), "dm_code_hidden");
    if (total > 0)
        decode_pairs(c, s, candidate, parent, size, most, total);
    check_end(c);
    int64_t found = 0, smallest = m + 2, largest = 3;
    for (int64_t f = 0; f < m; f++) {
        if (parent[f] != f)
            continue;
        found++;
        smallest = size[f] < smallest ? size[f] : smallest;
        largest = size[f] > largest ? size[f] : largest;
    }
    require(!allowed.strict || (found == count && smallest == least && largest == most), "sizes");
    tell("POLY", s->merged, 3 * m);
}

void find_outlines(structure *s)
{
    const int64_t count = 3 * s->triangles;
    int64_t hidden = 0;
    for (int64_t h = 0; s->merged && h < count; h++)
        hidden += s->merged[h] >= 0;
    s->corner_count = count - hidden, s->polygons = s->triangles - hidden / 2;
    s->corners = take_numbers(s->corner_count), s->offsets = take_numbers(s->polygons + 1);
    s->of_corners = take_numbers(count);
    if (hidden > 0) {
        insist(dm_walk_outlines(s->merged, s->triangles, s->corners, s->corner_count, s->offsets,
                                s->polygons, s->of_corners) == DM_OK, "dm_walk_outlines");
        return;
    }
    for (int64_t h = 0; h < count; h++)
        s->corners[h] = s->of_corners[h] = h;
    for (int64_t p = 0; p <= s->polygons; p++)
        s->offsets[p] = 3 * p;
}

static int64_t *quads_of(const structure *s, int64_t *count)
{
    int64_t *const quads = take_numbers(s->corner_count);
    *count = 0;
    for (int64_t p = 0; p < s->polygons; p++) {
        if (s->offsets[p + 1] - s->offsets[p] != 4)
            continue;
        for (int64_t at = s->offsets[p]; at < s->offsets[p + 1]; at++)
            quads[4 * *count + at - s->offsets[p]] = s->point[s->triangle[s->corners[at]]];
        ++*count;
    }
    return quads;
}

elements surface_of(const structure *s)
{
    int64_t *const faces = take_numbers(3 * s->m), quad_count, count = 0;
    int64_t *const a = take_numbers(3 * s->m), *const b = take_numbers(3 * s->m);
    for (int64_t h = 0; h < 3 * s->m; h++)
        faces[h] = s->points[s->faces[h]];
    for (int64_t h = 0; h < 3 * s->m; h++) {
        const int64_t g = s->opposite[h] < 0 ? -2 : of_mesh(s, s->opposite[h]);
        if (s->merged && s->merged[of_mesh(s, h)] == g)
            continue; /* hidden within a polygon */
        a[count] = faces[h], b[count++] = faces[after_in_face(h)];
    }
    graph near = graph_of_pairs(a, b, count, s->used);
    int64_t *const padding = take_numbers(s->isolated);
    for (int64_t i = 0; i < s->isolated; i++)
        padding[i] = near.entries;
    near.indptr = joined(near.indptr, near.n + 1, padding, s->isolated);
    near.n += s->isolated;
    const int64_t *const quads = quads_of(s, &quad_count);
    return elements_of(near, faces, s->m, quads, quad_count, s->trivial ? s->opposite : NULL);
}

elements vertices_of(const structure *s, const elements *surface)
{
    if (s->trivial && !s->has_split && !s->merged)
        return *surface;
    const graph near = graph_of_faces(s->triangle, s->triangles, s->vertices);
    const int64_t *const opposite = s->trivial && !s->has_split ? s->opposite : NULL;
    return elements_of(near, s->triangle, s->triangles, take_numbers(0), 0, opposite);
}

elements polygons_of(const structure *s)
{
    const int64_t count = 3 * s->triangles;
    int64_t *const polygon = take_numbers(s->corner_count), *const key = take_numbers(count);
    int64_t *const a = take_numbers(count), *const b = take_numbers(count), pairs = 0;
    for (int64_t p = 0; p < s->polygons; p++)
        for (int64_t at = s->offsets[p]; at < s->offsets[p + 1]; at++)
            polygon[at] = p;
    for (int64_t h = 0; h < count; h++) {
        const int64_t v = s->point[s->triangle[h]], w = s->point[s->triangle[after_in_face(h)]];
        key[h] = v == w ? -1 : (v < w ? v : w) * s->count + (v < w ? w : v);
    }
    const int64_t *const order = order_of(key, count);
    for (int64_t k = 0; k + 1 < count; k++) {
        if (key[order[k]] != key[order[k + 1]] || key[order[k]] < 0)
            continue;
        a[pairs] = polygon[s->of_corners[order[k]]];
        b[pairs++] = polygon[s->of_corners[order[k + 1]]];
    }
    /* The sides of triangles (a, b, b) would be the same pairs. */
    return without_parallelograms(graph_of_pairs(a, b, pairs, s->polygons));
}
