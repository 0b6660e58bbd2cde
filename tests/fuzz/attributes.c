/* Section ATTR; see `src/deltamesh/_attributes` and
   `formats/deltamesh_formats/container/attribute_table.py`. */
#include "fuzz.h"

enum { VERTEX, CORNER, FACE };              /* domains */
enum { INTEGER, EXACT_CODING, GRID, OCTAHEDRAL }; /* codings */
enum { PARTLY = 2, PALETTE = 4, MIXED = 8, FIRST_NONE = 64 };
enum { OWN_WEDGES, POLYGON_OWNERS, WEDGES_OF };
enum { BOOL = 0, FLOAT16 = 9, COMPLEX64 = 12, TYPES = 14, MOST_ATTRIBUTES = 16 };

typedef struct {
    int64_t domain, type, flags, coding, width, wedges, palette, bits, limbs, streams, first;
    int64_t *own; /* the wedges of its own */
} entry;

/* The sizes of all streams, those of the first attribute first. */
typedef struct {
    entry entries[MOST_ATTRIBUTES];
    int64_t count, streams, *sizes;
} table;

static int64_t columns_of(const entry *e)
{
    if (e->coding == OCTAHEDRAL)
        return 3;
    const int64_t limbs = e->coding == INTEGER ? e->limbs : 1;
    require(e->width < 1 << 20, "a width beyond the bytes of a file");
    return e->width * (e->type >= COMPLEX64 ? 2 : 1) * limbs;
}

static void read_entry(bytes *payload, table *t)
{
    entry *const e = &t->entries[t->count];
    read_bytes(payload, read_varint(payload)); /* its name */
    const int64_t what = read_byte(payload);
    e->flags = read_byte(payload);
    e->domain = what & 3, e->type = what >> 4, e->coding = e->flags >> 4 & 3;
    require(e->domain <= FACE && e->type < TYPES && e->flags < 2 * FIRST_NONE, "an attribute");
    e->width = read_varint(payload);
    e->wedges = e->domain == CORNER ? read_varint(payload) : OWN_WEDGES;
    e->palette = e->flags & PALETTE ? read_varint(payload) : -1;
    if (e->coding == INTEGER) {
        read_bytes(payload, 8);
        e->bits = read_byte(payload), e->limbs = read_byte(payload);
        require(e->bits >= 1 && e->bits <= 29 && e->limbs >= 1 &&
                e->limbs <= (63 + e->bits) / e->bits, "limbs");
    } else if (e->coding != EXACT_CODING) {
        e->bits = read_byte(payload);
        read_bytes(payload, 8);
    }
    if (e->coding == GRID) {
        require(e->width < left_of(payload), "numbers of an attribute");
        read_bytes(payload, 8 * (1 + e->width));
    }
    const int is_float = e->type >= FLOAT16, is_complex = e->type >= COMPLEX64;
    require(e->coding == INTEGER ? !is_float : is_float, "a type with a coding");
    require(e->coding == EXACT_CODING || !is_complex, "a complex type with a coding");
    require(e->coding != OCTAHEDRAL || (e->width == 3 && e->palette < 0), "normals");
    require(e->palette != 0 && (!(e->flags & FIRST_NONE) || e->flags & PARTLY), "owners");
    if (e->domain == CORNER && e->wedges >= WEDGES_OF) {
        require(e->wedges - WEDGES_OF < t->count, "wedges of an attribute");
        const entry *const other = &t->entries[e->wedges - WEDGES_OF];
        require(other->domain == CORNER && other->wedges == OWN_WEDGES, "wedges of an attribute");
    }
    e->streams = (e->domain == CORNER && e->wedges == OWN_WEDGES) + (e->flags & PARTLY ? 1 : 0) +
                 (e->palette >= 0) + (columns_of(e) + 2) / 3;
    require(e->streams <= left_of(payload), "sizes of streams");
    require(t->streams + e->streams <= allowed.streams, "limits");
    e->first = t->streams;
    for (int64_t k = 0; k < e->streams; k++)
        t->sizes[t->streams++] = read_varint(payload);
}

static int64_t *decode_own_wedges(bytes payload, const structure *s)
{
    const corner_rings r = corners_of(s);
    int64_t *const wedges = take_numbers(r.length);
    dm_coder *const c = decoder_of("wedges", 0, payload);
    decode_wedges(c, s, &r, wedges);
    check_end(c);
    for (int64_t h = 0; h < r.length; h++)
        require(wedges[s->corners[s->of_corners[h]]] == wedges[h], "a corner in two wedges");
    return wedges;
}

static elements owners_of(const table *t, entry *e, const structure *s, const elements *surface,
                          bytes *payload, const int64_t **size)
{
    if (e->domain == VERTEX)
        return vertices_of(s, surface);
    if (e->domain == FACE || e->wedges == POLYGON_OWNERS)
        return polygons_of(s);
    if (e->wedges == OWN_WEDGES)
        e->own = decode_own_wedges(read_bytes(payload, *(*size)++), s);
    const int64_t *const wedges = e->own ? e->own : t->entries[e->wedges - WEDGES_OF].own;
    const int64_t count = largest_of(wedges, 3 * s->triangles) + 1;
    const graph near = graph_of_faces(wedges, s->triangles, count);
    return elements_of(near, wedges, s->triangles, take_numbers(0), 0, NULL);
}

static void decode_normals(bytes payload, const elements *e)
{
    const int64_t bits = read_byte(&payload), plan = read_byte(&payload);
    require(bits >= 2 && bits <= 30 && plan >> 2 <= 1, "normals");
    int64_t *const codes = plan >> 2 ? decode_three(payload, e) : decode_vectors(payload, e->near);
    tell("normals", codes, 3 * e->near.n);
}

static void decode_attribute(const table *t, entry *e, const structure *s,
                             const elements *surface, bytes *payload)
{
    const int64_t *size = t->sizes + e->first, *const end = size + e->streams;
    elements owners = owners_of(t, e, s, surface, payload, &size);
    int64_t *has = NULL, labels;
    if (e->flags & PARTLY) {
        has = decode_labels(read_bytes(payload, *size++), owners.near, &labels);
        require(labels <= 2, "presence label above 1");
        for (int64_t i = 0; i < owners.near.n; i++)
            has[i] = (has[i] == 1) == ((e->flags & FIRST_NONE) != 0);
    }
    if (e->coding == OCTAHEDRAL) {
        decode_normals(read_bytes(payload, *size++), &owners);
        return;
    }
    if (has)
        owners = among(owners, has);
    if (e->palette >= 0) {
        decode_labels(read_bytes(payload, *size++), owners.near, &labels);
        require(allowed.strict ? labels == e->palette : e->palette <= owners.near.n, "palette");
        const graph alone = {e->palette, 0, take_zeros(e->palette + 1), take_numbers(0)};
        owners = without_parallelograms(alone);
    }
    while (size < end) {
        const bytes stream = read_bytes(payload, *size++);
        int width = 32;
        int64_t *const codes = e->coding == EXACT_CODING ? decode_exact(stream, &owners, &width)
                                                         : decode_three(stream, &owners);
        if (e->coding != EXACT_CODING)
            tell("columns", codes, 3 * owners.near.n);
    }
}

void decode_attributes(bytes payload, const structure *s, const elements *surface)
{
    table *const t = take_bytes(sizeof(table));
    *t = (table){.sizes = take_numbers(allowed.streams)};
    const int64_t count = read_varint(&payload);
    require(count > 0 && count <= MOST_ATTRIBUTES, "a table of attributes");
    for (; t->count < count; t->count++)
        read_entry(&payload, t);
    int64_t total = 0;
    for (int64_t k = 0; k < t->streams; k++) {
        require(t->sizes[k] <= left_of(&payload), "sizes of streams");
        total += t->sizes[k];
    }
    require(total == left_of(&payload) || !allowed.strict, "bytes after the last attribute");
    for (int64_t k = 0; k < count; k++)
        decode_attribute(t, &t->entries[k], s, surface, &payload);
}
