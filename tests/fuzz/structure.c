/* Sections CONN, STCH and COPY: triangles over points and over vertices. */
#include <string.h>

#include "fuzz.h"

/* The numbers of points, and of vertices and faces of the manifold, before any is decoded. */
static void read_counts(const container *file, structure *s)
{
    s->vertices = file->vertices, s->triangles = file->triangles, s->isolated = file->isolated;
    s->count = s->vertices, s->m = s->triangles;
    if (file->sections[COPY].at) {
        bytes payload = file->sections[COPY];
        s->count = read_varint(&payload);
        const int64_t further = read_varint(&payload);
        require(s->isolated <= s->count && s->count < s->vertices, "counts of COPY");
        require(further <= s->vertices - s->count, "counts of COPY");
    }
    s->n = s->used = s->count - s->isolated;
    if (file->sections[STCH].at) {
        bytes payload = file->sections[STCH];
        s->n = read_varint(&payload);
        s->m = read_varint(&payload);
    }
    require(s->m <= s->triangles && s->n <= 3 * s->m && s->n >= s->used, "counts of STCH");
}

static void decode_manifold(bytes payload, structure *s)
{
    const int64_t loops = read_varint(&payload), border = read_varint(&payload);
    const int64_t joins = read_varint(&payload);
    require(loops <= border && border <= 3 * s->m && joins <= s->m + border, "counts of CONN");
    const int64_t n = s->n + loops, m = s->m + border, capacity = n + joins;
    dm_front *const front = take_bytes(sizeof(dm_front));
    dm_new_vertex *const vertices = take_bytes((size_t)n * sizeof(dm_new_vertex));
    int64_t *const faces = take_numbers(3 * m), *const index = take_numbers(n);
    memset(vertices, 0, (size_t)n * sizeof(dm_new_vertex));
    dm_start_front(front, take_bytes((size_t)capacity * sizeof(dm_node)), take_numbers(capacity),
                   capacity);
    dm_coder *const c = decoder_of("valence", 0, payload);
    check(dm_grow(c, front, take_bytes(0), 0, take_bytes(0), 0, faces, m, vertices, n,
                  take_numbers(0), loops, s->n), "dm_grow");
    require(front->join_count == joins, "another number of joins");
    check_end(c);
    for (int64_t v = 0, real = 0; v < n; v++) {
        index[v] = vertices[v].is_loop ? -1 : real;
        real += !vertices[v].is_loop;
    }
    int64_t *const seen = take_zeros(s->n), kept = 0;
    s->faces = take_numbers(3 * s->m);
    for (int64_t f = 0; f < m; f++) {
        const int64_t a = index[faces[3 * f]], b = index[faces[3 * f + 1]];
        const int64_t d = index[faces[3 * f + 2]];
        if (a < 0 || b < 0 || d < 0)
            continue;
        require(kept < s->m, "another number of faces");
        memcpy(s->faces + 3 * kept++, (int64_t[]){a, b, d}, 3 * sizeof(a));
        seen[a] = seen[b] = seen[d] = 1;
    }
    require(kept == s->m, "another number of faces");
    for (int64_t v = 0; v < s->n; v++)
        require(seen[v] == 1, "a vertex in no face");
    s->opposite = opposite_of(s->faces, s->m);
    tell("CONN", s->faces, 3 * s->m);
}

/* Whether faces agree in winding across each edge, and each vertex has one fan. */
static int is_sound(const structure *s)
{
    for (int64_t h = 0; h < 3 * s->m; h++) {
        const int64_t g = s->opposite[h];
        if (g >= 0 && (s->faces[g] != s->faces[after_in_face(h)] ||
                       s->faces[after_in_face(g)] != s->faces[h]))
            return 0;
    }
    int64_t fans;
    check(dm_label_fans(s->opposite, 3 * s->m, take_numbers(3 * s->m), &fans), "dm_label_fans");
    return fans == s->n;
}

static void stitch_trivially(structure *s)
{
    s->points = take_numbers(s->n);
    for (int64_t v = 0; v < s->n; v++)
        s->points[v] = v;
    s->reversed = take_bytes((size_t)s->m);
    memset(s->reversed, 0, (size_t)s->m);
    s->repeated = take_numbers(0), s->against = take_numbers(0), s->degenerate = take_numbers(0);
    s->trivial = 1;
}

static int64_t *over_points(const structure *s)
{
    int64_t *const faces = take_numbers(3 * s->m);
    for (int64_t h = 0; h < 3 * s->m; h++)
        faces[h] = s->points[s->faces[h]];
    return faces;
}

static void decode_stitches(bytes payload, structure *s)
{
    read_varint(&payload), read_varint(&payload); /* the counts that are known */
    const int64_t any_reversed = read_varint(&payload), total = read_varint(&payload);
    require(any_reversed <= 1 && total <= s->triangles - s->m, "counts of STCH");
    uint8_t *const boundary = take_bytes((size_t)s->n);
    memset(boundary, 0, (size_t)s->n);
    for (int64_t h = 0; h < 3 * s->m; h++)
        if (s->opposite[h] < 0)
            boundary[s->faces[h]] = boundary[s->faces[after_in_face(h)]] = 1;
    const graph g = graph_of_faces(s->faces, s->m, s->n);
    stitch_trivially(s);
    s->points = take_zeros(s->n);
    dm_coder *const c = decoder_of("stitching", 0, payload);
    int64_t points = 0;
    check(dm_code_stitches(c, ROWS_OF(g), boundary, s->points,
                           take_numbers(s->n), take_numbers(s->n), take_numbers(s->n), &points),
          "dm_code_stitches");
    require(points == s->used, "another number of points");
    int reversed = 0;
    if (any_reversed)
        check(dm_code_reversed(c, s->opposite, s->m, s->reversed), "dm_code_reversed");
    for (int64_t f = 0; f < s->m; f++)
        reversed |= s->reversed[f];
    require(reversed == any_reversed, "reversed faces");
    int64_t *const repeats = take_zeros(2 * s->m);
    if (total > 0)
        check(dm_code_repeats(c, s->opposite, s->m, repeats, total), "dm_code_repeats");
    s->repeats = total, s->degenerates = s->triangles - s->m - total;
    s->repeated = take_numbers(total), s->against = take_numbers(total);
    for (int64_t k = 0, at = 0; k < 2 * s->m; k++)
        for (int64_t i = 0; i < repeats[k]; i++, at++)
            s->repeated[at] = k / 2, s->against[at] = k % 2;
    s->degenerate = take_zeros(2 * s->degenerates);
    if (s->degenerates > 0) {
        const graph over = graph_of_faces(over_points(s), s->m, s->used);
        check(dm_code_degenerate(c, ROWS_OF(over), s->degenerate,
                                 s->degenerates, s->count), "dm_code_degenerate");
    }
    check_end(c);
    s->trivial = (s->n == 0 || s->points[s->n - 1] == s->n - 1) && !reversed &&
                 s->triangles == s->m;
    require(!s->trivial, "a manifold that needs no stitches");
    tell("STCH", s->points, s->n);
}

/* Exchange the second and the third corner. */
static void reverse(int64_t *face)
{
    const int64_t b = face[1];
    face[1] = face[2], face[2] = b;
}

static void make_complex(structure *s)
{
    int64_t *const faces = s->of_points = take_numbers(3 * s->triangles);
    const int64_t *const own = over_points(s);
    memcpy(faces, own, (size_t)(3 * s->m) * sizeof(*own));
    for (int64_t f = 0; f < s->m; f++)
        if (s->reversed[f])
            reverse(faces + 3 * f);
    int64_t *face = faces + 3 * s->m;
    for (int64_t k = 0; k < s->repeats; k++, face += 3) {
        memcpy(face, faces + 3 * s->repeated[k], 3 * sizeof(*faces));
        if (s->against[k])
            reverse(face);
    }
    for (int64_t k = 0; k < s->degenerates; k++, face += 3) {
        face[0] = face[1] = s->degenerate[2 * k];
        face[2] = s->degenerate[2 * k + 1];
    }
}

/* The vertices of the triangles, at each point those in faces first; further isolated ones. */
static void split(structure *s, const corner_rings *r, const int64_t *wedges, int64_t total,
                  const int64_t *further)
{
    int64_t *const owner = take_zeros(total), *const in_faces = take_zeros(s->count);
    int64_t *const shift = take_numbers(s->count), vertices = 0, before = 0;
    for (int64_t i = 0; i < r->length; i++)
        owner[wedges[i]] = r->of[r->rank[i]];
    for (int64_t k = 0; k < total; k++)
        in_faces[owner[k]]++;
    for (int64_t p = 0; p < s->count; p++) {
        shift[p] = vertices - before;
        vertices += (in_faces[p] > 0 ? in_faces[p] : 1) + further[p];
        before += in_faces[p];
    }
    require(vertices == s->vertices, "another number of vertices");
    s->triangle = take_numbers(r->length), s->point = take_numbers(vertices);
    for (int64_t i = 0; i < r->length; i++)
        s->triangle[i] = wedges[i] + shift[r->of[r->rank[i]]];
    for (int64_t p = 0, v = 0; p < s->count; p++)
        for (int64_t k = (in_faces[p] > 0 ? in_faces[p] : 1) + further[p]; k > 0; k--)
            s->point[v++] = p;
    s->has_split = 1;
}

static void decode_copies(bytes payload, structure *s)
{
    read_varint(&payload); /* the count that is known */
    const int64_t total = read_varint(&payload);
    const corner_rings r = corners_of(s);
    int64_t *const further = take_zeros(s->count), *const wedges = take_numbers(r.length);
    dm_coder *const c = decoder_of("wedges", 0, payload);
    const int64_t count = decode_wedges(c, s, &r, wedges);
    if (total > 0)
        check(dm_code_isolated(c, further, s->count, total), "dm_code_isolated");
    check_end(c);
    split(s, &r, wedges, count, further);
    tell("COPY", s->triangle, r.length);
}

void decode_structure(const container *file, structure *s)
{
    memset(s, 0, sizeof(*s));
    read_counts(file, s);
    const bytes *const sections = file->sections;
    decode_manifold(sections[CONN], s);
    if (sections[STCH].at || sections[COPY].at || sections[POLY].at || sections[ATTR].at)
        require(is_sound(s), "the faces form no manifold");
    if (sections[STCH].at)
        decode_stitches(sections[STCH], s);
    else
        stitch_trivially(s);
    require(s->triangles == s->m + s->repeats + s->degenerates, "another number of triangles");
    make_complex(s);
    if (sections[COPY].at) {
        decode_copies(sections[COPY], s);
    } else {
        s->triangle = s->of_points;
        s->point = take_numbers(s->count);
        for (int64_t v = 0; v < s->count; v++)
            s->point[v] = v;
    }
    if (sections[POLY].at)
        decode_polygons(sections[POLY], s);
    find_outlines(s);
}
