/* Walk over two meshes at once. */
#include "deltamesh_core.h"

/* Map source to target, one to one, and log a new pair; return the new count or -1. */
static int64_t assign(int64_t source, int64_t target, int64_t *mapping, int64_t *inverse,
                      int64_t *log, int64_t count)
{
    if (mapping[source] == target)
        return count;
    if (mapping[source] >= 0 || inverse[target] >= 0)
        return -1;
    mapping[source] = target;
    inverse[target] = source;
    log[count] = source;
    return count + 1;
}

int dm_assign(int64_t source, int64_t target, int64_t *mapping, int64_t n, int64_t *inverse,
              int64_t other_n, int64_t *log, int64_t *count)
{
    if (source < 0 || source >= n || target < 0 || target >= other_n || *count < 0 || *count >= n)
        return DM_INVALID;
    const int64_t found = assign(source, target, mapping, inverse, log, *count);
    if (found < 0)
        return DM_CORRUPT;
    *count = found;
    return DM_OK;
}

/* A mesh, and what is found of its patch. */
typedef struct {
    const int64_t *corners, *opposite, *colours;
    int64_t *vertices, *half_edges, *vertex_log, *face_log;
    int64_t vertex_count, face_count;
} walk;

/* Map a face of one mesh onto the face of the other whose half-edge `start` corresponds to its first
   one; return whether they agree. */
static int map_face(walk *w, const walk *o, int64_t f, int64_t start)
{
    const int64_t e = start / 3;
    if (w->half_edges[f] == start)
        return 1;
    if (w->half_edges[f] >= 0 || o->half_edges[e] >= 0)
        return 0;
    w->half_edges[f] = start;
    o->half_edges[e] = f;
    w->face_log[w->face_count++] = f;
    for (int64_t i = 0; i < 3; i++) {
        const int64_t a = w->corners[3 * f + i], b = o->corners[3 * e + (start + i) % 3];
        if (w->colours[a] != o->colours[b])
            return 0;
        const int64_t count =
            assign(a, b, w->vertices, o->vertices, w->vertex_log, w->vertex_count);
        if (count < 0)
            return 0;
        w->vertex_count = count;
    }
    return 1;
}

static void undo(const walk *w, const walk *o)
{
    for (int64_t i = 0; i < w->vertex_count; i++) {
        const int64_t v = w->vertex_log[i];
        o->vertices[w->vertices[v]] = -1;
        w->vertices[v] = -1;
    }
    for (int64_t i = 0; i < w->face_count; i++) {
        const int64_t f = w->face_log[i];
        o->half_edges[w->half_edges[f] / 3] = -1;
        w->half_edges[f] = -1;
    }
}

/* Map the patch around a half-edge of one mesh onto that around a half-edge of another.

   Half-edge h runs from corners[h] to the next corner of face h / 3; opposite[h] is the one
   half-edge that runs back along it, or -1 at a boundary, at an edge of three faces, or between
   faces of different winding. A patch is the faces that can be reached over opposites.

   corners, other_corners (3 faces,), colours (n,); vertices of different colour cannot correspond.
   vertices (n,), half_edges (faces,): the maps so far, -1 where there is none, with their inverses;
   changed in place, and back again when the patches differ (DM_CORRUPT). A face's half-edges are
   mapped together, only that of its first corner is kept: entry 3 f at half_edges[f]. Scratch:
   vertex_log (n,), face_log (faces,). The arrays are not checked, as there may be as many patches as
   faces. */
int dm_propagate(const int64_t *corners, const int64_t *opposite, int64_t faces,
                 const int64_t *colours, int64_t n, const int64_t *other_corners,
                 const int64_t *other_opposite, int64_t other_faces, const int64_t *other_colours,
                 int64_t other_n, int64_t half_edge, int64_t other_half_edge, int64_t *vertices,
                 int64_t *inverse_vertices, int64_t *half_edges, int64_t *inverse_half_edges,
                 int64_t *vertex_log, int64_t *face_log)
{
    walk w = {corners, opposite, colours, vertices, half_edges, vertex_log, face_log, 0, 0};
    const walk o = {.corners = other_corners,
                    .opposite = other_opposite,
                    .colours = other_colours,
                    .vertices = inverse_vertices,
                    .half_edges = inverse_half_edges};
    if (half_edge < 0 || half_edge >= 3 * faces || other_half_edge < 0 ||
        other_half_edge >= 3 * other_faces || n < 1 || other_n < 1)
        return DM_INVALID;
    /* Opposites find the face of a half-edge that is to be mapped; this pair starts the first. */
    int64_t h = half_edge, g = other_half_edge, head = 0;
    for (;;) {
        int same = map_face(&w, &o, h / 3, 3 * (g / 3) + (g % 3 + 3 - h % 3) % 3);
        /* On to the next half-edge of the logged faces that has an opposite. */
        h = -1;
        for (; same && h < 0 && head < 3 * w.face_count; head++) {
            const int64_t f = w.face_log[head / 3], at = head % 3, start = half_edges[f];
            h = opposite[3 * f + at];
            g = other_opposite[start / 3 * 3 + (start + at) % 3];
            same = (h < 0) == (g < 0);
        }
        if (!same) {
            undo(&w, &o);
            return DM_CORRUPT;
        }
        if (h < 0)
            return DM_OK;
    }
}
