/* Section ORDR; see `src/deltamesh/_order/coding.py`. */
#include "fuzz.h"

enum { ANCHOR = 3, NEWEST = 4, POLYGONS_FIRST = 8 };

/* Polygons, each represented by one of its triangles. */
typedef struct {
    int64_t *faces, *corners, *within;
} rows;

static rows rows_of(const structure *s)
{
    rows r = {take_numbers(3 * s->polygons), take_numbers(s->corner_count),
              take_numbers(3 * s->polygons)};
    int64_t *const polygon = take_numbers(s->corner_count), *const seen = take_zeros(s->polygons);
    for (int64_t p = 0; p < s->polygons; p++)
        for (int64_t at = s->offsets[p]; at < s->offsets[p + 1]; at++)
            polygon[at] = p;
    for (int64_t t = 0; t < s->triangles; t++) {
        const int64_t p = polygon[s->of_corners[3 * t]];
        for (int j = 0; j < 3 && !seen[p]; j++) {
            r.faces[3 * p + j] = s->triangle[3 * t + j];
            r.within[3 * p + j] = s->of_corners[3 * t + j] - s->offsets[p];
        }
        seen[p] = 1;
    }
    for (int64_t at = 0; at < s->corner_count; at++)
        r.corners[at] = s->triangle[s->corners[at]];
    return r;
}

static int64_t *decode_vertices(bytes payload, const structure *s, const rows *r, int plan)
{
    int64_t *const after = take_numbers(s->corner_count), n = s->vertices;
    for (int64_t p = 0; p < s->polygons; p++)
        for (int64_t at = s->offsets[p]; at < s->offsets[p + 1]; at++)
            after[at] = r->corners[at + 1 < s->offsets[p + 1] ? at + 1 : s->offsets[p]];
    const graph g = graph_of_pairs(r->corners, after, s->corner_count, n);
    const int64_t *const mirror = inverse_of(order_of(g.indices, g.entries), g.entries);
    int64_t *const order = take_numbers(n);
    dm_coder *const c = decoder_of("steps", 0, payload);
    check(dm_code_vertices(c, ROWS_OF(g), mirror, plan & NEWEST ? 1 : 0, order, 0, n,
                           take_numbers(n + 1), take_numbers(n + 1),
                           take_numbers(g.entries), take_numbers(g.entries), take_numbers(n),
                           take_numbers(3 * n)), "dm_code_vertices");
    check_end(c);
    return order;
}

static void decode_faces(bytes payload, const structure *s, const rows *r, int plan, int64_t *rank)
{
    const int64_t m = s->polygons, n = s->vertices;
    int64_t *const order = take_numbers(m), *const rotations = take_numbers(m), ranked = 0;
    for (int64_t v = 0; v < n; v++)
        ranked += rank[v] >= 0;
    dm_coder *const c = decoder_of("steps", 0, payload);
    check(dm_code_faces(c, r->faces, m, r->corners, s->corner_count, s->offsets, r->within, rank,
                        n, ranked, plan & ANCHOR, order, rotations, 0, m, take_numbers(n),
                        take_numbers(m + 1), take_numbers(m + 1), take_numbers(3 * m),
                        take_numbers(3 * m), take_numbers(n)), "dm_code_faces");
    check_end(c);
    tell("polygons", order, m);
    tell("rotations", rotations, m);
}

void decode_order(bytes payload, const structure *s)
{
    const int plan = read_byte(&payload);
    require(plan < 2 * POLYGONS_FIRST && (plan & ANCHOR) != ANCHOR, "an order plan");
    const bytes of_vertices = read_bytes(&payload, read_varint(&payload));
    const int64_t n = s->vertices;
    rows r = rows_of(s);
    if (!(plan & POLYGONS_FIRST)) {
        int64_t *const order = decode_vertices(of_vertices, s, &r, plan);
        tell("vertices", order, n);
        decode_faces(payload, s, &r, plan, inverse_of(order, n));
        return;
    }
    int64_t *const names = take_numbers(n), unranked = 0;
    for (int64_t v = 0; v < n; v++)
        names[v] = -1;
    decode_faces(payload, s, &r, plan, names);
    for (int64_t v = 0; v < n; v++)
        unranked += names[v] < 0;
    for (int64_t v = 0; v < n; v++)
        if (names[v] < 0)
            names[v] = n - unranked--;
    for (int64_t k = 0; k < 3 * s->polygons; k++)
        r.faces[k] = names[r.faces[k]];
    for (int64_t at = 0; at < s->corner_count; at++)
        r.corners[at] = names[r.corners[at]];
    int64_t *const order = decode_vertices(of_vertices, s, &r, plan);
    const int64_t *const before = inverse_of(names, n);
    for (int64_t v = 0; v < n; v++)
        order[v] = before[order[v]];
    tell("vertices", order, n);
}
