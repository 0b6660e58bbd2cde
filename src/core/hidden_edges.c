/* Hidden edges between triangles: the triangles on both sides are merged into one polygon.

   Every half-edge has at most one candidate that it may be merged with, its opposite where the
   surface is a manifold; further pairs are explicit (`merged_pairs.c`). The contexts are those of a
   quad mesh: a triangle has one hidden edge, an inner vertex has four edges that are seen, one of
   the border three, and hidden edges of neighbours run in parallel. */
#include "hidden_edges.h"

#include "coder.h"
#include "graphs.h"
#include "halfedges.h"

/* The status of an edge. */
enum { OPEN, SEEN, HIDDEN };

typedef struct {
    const int64_t *corners, *candidate;
    int64_t *edges;      /* (3 faces,): the status of the edge of each half-edge */
    int64_t *open_pairs; /* (faces,): those of a polygon, twice those within it */
    int64_t *seen, *left, *border; /* (vertices,): edges, edges not coded, whether on a border */
} edged_mesh;

/* Two counts at a vertex of a quad mesh as one: edges to be hidden, edges not coded.

   The former is -1 to 3, plus 1; the latter, without the `own` one, at most 3. */
static int64_t spare(const edged_mesh *m, int64_t v, int64_t own)
{
    const int64_t hidden = m->seen[v] + m->left[v] + m->border[v] - 4;
    return 4 * (dm_clamp(hidden, -1, 3) + 1) + dm_clamp(m->left[v] - own, 0, 3);
}

/* The status beyond an edge: 0 unknown, 4 if it is hidden itself.

   Else that of the triangle there: 1 if its edge after the shared one is hidden (before it, unless
   `forward`), else 2 if the third one is, else 3. */
static int64_t behind(const edged_mesh *m, int64_t e, int forward)
{
    const int64_t g = m->candidate[e];
    if (g < 0 || m->edges[e] == OPEN)
        return 0;
    if (m->edges[e] == HIDDEN)
        return 4;
    const int64_t one = forward ? dm_next(g) : dm_previous(g);
    const int64_t other = forward ? dm_previous(g) : dm_next(g);
    return m->edges[one] == HIDDEN ? 1 : (m->edges[other] == HIDDEN ? 2 : 3);
}

/* The status beyond the two other edges of a triangle, 0 to 24.

   Where triangles form a lattice, a half turn about the middle of an edge takes one to the other: h
   is hidden where the edge that this takes it to is. */
static int64_t around(const edged_mesh *m, int64_t h)
{
    return 5 * behind(m, dm_next(h), 0) + behind(m, dm_previous(h), 1);
}

/* Count the edges of each vertex and each triangle before any is coded. */
static void count_edges(const edged_mesh *m, int64_t halfedges)
{
    for (int64_t h = 0; h < halfedges; h++) {
        const int64_t a = m->corners[h];
        m->edges[h] = OPEN;
        if (m->candidate[h] >= 0) {
            m->open_pairs[h / 3]++;
            m->left[a]++; /* a pair is counted once at each of its ends */
            continue;
        }
        m->edges[h] = SEEN;
        const int64_t b = m->corners[dm_next(h)];
        m->seen[a]++;
        m->seen[b]++;
        m->border[a] = m->border[b] = 1;
    }
}

/* Code one pair of half-edges h and g of polygons r and s. */
static int64_t code_pair(dm_coder *c, const edged_mesh *m, const dm_polygons *p, int64_t h,
                         int64_t g, int64_t r, int64_t s)
{
    const int64_t x = dm_corners_class(p->size[r]), y = dm_corners_class(p->size[s]);
    const int64_t i = dm_clamp(m->open_pairs[r], 1, 4), j = dm_clamp(m->open_pairs[s], 1, 4);
    const int64_t joined = 2 * (x > 0) + (y > 0);
    const int64_t ends = 20 * spare(m, m->corners[h], 1) + spare(m, m->corners[g], 1);
    const int64_t apexes = 20 * spare(m, m->corners[dm_previous(h)], 0) +
                           spare(m, m->corners[dm_previous(g)], 0);
    const int64_t beyond = 25 * around(m, h) + around(m, g);
    const int64_t at[] = {
        HIDE_BY_SIZES + 64 * x + 16 * y + 4 * (i - 1) + j - 1,
        HIDE_BY_ENDS + 4 * ends + joined,
        HIDE_BY_APEXES + 4 * apexes + joined,
        HIDE_BY_BEYOND + 4 * beyond + joined,
    };
    return dm_code_bit(c, p->merged[h] == g, DM_HIDE_MIXER, at);
}

/* Code which half-edges are merged with their candidates.

   corners (3 faces,): the vertices of triangles, below `vertices`. candidate (3 faces,): the
   half-edge that each may be merged with, -1 for none. merged (3 faces,): the half-edge that each is
   merged with, -1 for none; when decoding, -1, and filled in. Others than the candidates are
   ignored. parent, size (faces,): the forest of polygons, every triangle alone, and the corners of
   each root's. least, most: bounds of the corners of a polygon. more: whether explicit pairs of
   half-edges follow. Scratch: edges (3 faces,), open_pairs (faces,), counts (3, vertices). */
int dm_code_hidden(dm_coder *c, const int64_t *corners, int64_t faces, int64_t vertices,
                   const int64_t *candidate, int64_t *merged, int64_t *parent, int64_t *size,
                   int64_t least, int64_t most, int64_t more, int64_t *edges, int64_t *open_pairs,
                   int64_t *counts)
{
    const int64_t halfedges = 3 * faces;
    if (!dm_has_memory(c, HIDDEN_SLOTS, DM_HIDDEN_MIXERS) ||
        !dm_all_in(corners, halfedges, 0, vertices) ||
        !dm_all_in(candidate, halfedges, -1, halfedges) || !dm_all_in(parent, faces, 0, faces))
        return DM_INVALID;
    const edged_mesh m = {corners, candidate,         edges,
                          open_pairs, counts, counts + vertices, counts + 2 * vertices};
    dm_polygons p = {faces, merged, parent, size};
    for (int64_t k = 0; k < 3 * vertices; k++)
        counts[k] = 0;
    for (int64_t f = 0; f < faces; f++)
        open_pairs[f] = 0;
    count_edges(&m, halfedges);
    for (int64_t h = 0; h < halfedges; h++) {
        const int64_t g = candidate[h];
        if (g < 0 || g / 3 > h / 3 || edges[h] != OPEN)
            continue;
        const int64_t r = dm_root_of(&p, h / 3), s = dm_root_of(&p, g / 3);
        int64_t bit;
        if (r == s || size[r] + size[s] - 2 > most)
            bit = 0;
        else if (!more && ((size[r] < least && open_pairs[r] == 1) ||
                           (size[s] < least && open_pairs[s] == 1)))
            bit = 1;
        else
            bit = code_pair(c, &m, &p, h, g, r, s);
        open_pairs[r]--;
        open_pairs[s]--;
        m.left[corners[h]]--;
        m.left[corners[g]]--;
        edges[h] = edges[g] = bit ? HIDDEN : SEEN;
        if (bit) {
            dm_join(&p, h, g, r, s);
            open_pairs[r] += open_pairs[s];
        } else {
            m.seen[corners[h]]++;
            m.seen[corners[g]]++;
        }
    }
    return DM_OK;
}
