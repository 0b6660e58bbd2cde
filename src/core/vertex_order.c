/* Order of the vertices of a mesh, in steps (`steps.h`). */
#include "graphs.h"
#include "steps.h"

/* Indices into `around`: the ranks of the oldest and the newest neighbour of a vertex, -1 without;
   the number of those that have one. */
enum { OLDEST, NEWEST, RANKED, COLUMNS };

typedef struct {
    const int32_t *indptr, *indices;
    const int64_t *mirror;
    int64_t key; /* OLDEST or NEWEST: which neighbour is the anchor of a vertex */
    int64_t *around; /* (n, COLUMNS) */
    dm_remaining left;
    dm_rings rings;
} ordered_mesh;

/* Rings of the entries of each row, in their order. */
static void fill_rings(const ordered_mesh *m, int64_t n)
{
    for (int64_t v = 0; v < n; v++) {
        const int64_t first = m->indptr[v], end = m->indptr[v + 1];
        m->rings.start[v] = first < end ? first : -1;
        for (int64_t e = first; e < end; e++) {
            m->rings.after[e] = e + 1 < end ? e + 1 : first;
            m->rings.before[e] = e > first ? e - 1 : end - 1;
        }
    }
}

/* Find the neighbours of `hub`, of rank `anchor`, that are left and have it for an anchor. */
static int64_t find_around(const ordered_mesh *m, int64_t hub, int64_t anchor, int64_t *found)
{
    int64_t count = 0, e = m->rings.start[hub];
    for (int k = 0; k < DM_SCANNED && e >= 0 && count < DM_STEP_CANDIDATES; k++) {
        if (m->around[(int64_t)COLUMNS * m->indices[e] + m->key] == anchor)
            found[count++] = m->indices[e];
        e = m->rings.after[e];
        if (e == m->rings.start[hub])
            break;
    }
    return count;
}

/* Code which of the vertices found is meant, one bit for each but the last. */
static int64_t choose(dm_coder *c, dm_steps *s, const ordered_mesh *m, const int64_t *last,
                      const int64_t *found, int64_t count, int64_t rank, int64_t vertex)
{
    for (int64_t k = 0; k < count; k++) {
        const int64_t *const of = m->around + COLUMNS * found[k];
        const int64_t old = dm_near(of[OLDEST], last[OLDEST]);
        const int64_t newest = dm_near(of[NEWEST], last[NEWEST]);
        const int64_t touches = of[NEWEST] == rank - 1, kind = 2 * old + touches;
        const int64_t degree = dm_min(of[RANKED], 3);
        if (k < count - 1) {
            const int64_t at[] = {
                CHOOSE + 4 * kind + degree,
                CHOOSE + DM_CHOOSE_SIZE + 16 * kind + s->choice,
                CHOOSE + 2 * DM_CHOOSE_SIZE + 24 * degree + 6 * dm_min(k, 3) + newest,
            };
            if (!dm_code_bit(c, found[k] == vertex, DM_CHOOSE_VERTEX_MIXER, at))
                continue;
        }
        s->choice = kind;
        return found[k];
    }
    return -1;
}

/* Give a vertex its rank, and bring `around` and the rings up to date. */
static void rank_vertex(ordered_mesh *m, int64_t vertex, int64_t rank)
{
    dm_take_away(&m->left, vertex);
    for (int64_t e = m->indptr[vertex]; e < m->indptr[vertex + 1]; e++) {
        const int64_t w = m->indices[e];
        int64_t *const of = m->around + COLUMNS * w;
        dm_take_off(&m->rings, w, m->mirror[e]);
        if (of[OLDEST] < 0)
            of[OLDEST] = rank;
        of[NEWEST] = rank;
        of[RANKED]++;
    }
}

static int are_mirrored(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                        const int64_t *mirror)
{
    if (!dm_is_graph(indptr, n, indices, entries) || !dm_all_in(mirror, entries, 0, entries))
        return 0;
    int good = 1;
    for (int64_t v = 0; v < n; v++)
        for (int64_t e = indptr[v]; e < indptr[v + 1]; e++)
            good &= mirror[e] >= indptr[indices[e]] && mirror[e] < indptr[indices[e] + 1] &&
                    mirror[mirror[e]] == e;
    return good;
}

/* Code the vertex of each rank, `order` (n,), filled in when decoding.

   Neighbours ascend in the rows of the graph; entry e, of row v, is the edge from v to indices[e],
   and mirror[e] the entry of the edge back. The anchor of a vertex is the newest or the oldest of
   its neighbours that have a rank. At most `stop` ranks are coded. Scratch: sums, onwards (n + 1,);
   after, before (entries,); start (n,); around (n, 3). */
int dm_code_vertices(dm_coder *c, const int32_t *indptr, int64_t n, const int32_t *indices,
                     int64_t entries, const int64_t *mirror, int64_t newest, int64_t *order,
                     int64_t margin, int64_t stop, int64_t *sums, int64_t *onwards, int64_t *after,
                     int64_t *before, int64_t *start, int64_t *around)
{
    if (!dm_has_memory(c, STEPS_SLOTS, DM_STEPS_MIXERS) || newest < 0 || newest > 1 ||
        !are_mirrored(indptr, n, indices, entries, mirror))
        return DM_INVALID;
    ordered_mesh m = {indptr, indices,           mirror,
                      newest, around,            {n, sums, onwards},
                      {after, before, start}};
    dm_all_of(n, sums, onwards);
    fill_rings(&m, n);
    for (int64_t v = 0; v < n; v++)
        around[COLUMNS * v] = around[COLUMNS * v + 1] = -1, around[COLUMNS * v + RANKED] = 0;
    dm_steps s = {0};
    int64_t found[DM_STEP_CANDIDATES], last[COLUMNS] = {0}; /* the latter of the vertex before */
    int64_t previous = -1;
    for (int64_t i = 0; i < dm_min(n, stop); i++) {
        int64_t vertex = c->decoding ? -1 : order[i], step = DM_STEP_NEXT, trail = -1;
        if (!c->decoding && (vertex < 0 || vertex >= n || onwards[vertex] != vertex))
            return DM_INVALID;
        const int64_t following = dm_first_left(&m.left, previous + 1);
        if (!c->decoding && vertex != following) {
            const int64_t anchor = around[COLUMNS * vertex + m.key];
            step = DM_STEP_ANY;
            trail = anchor >= 0 ? dm_trail_of(&s, anchor, n - i, margin) : -1;
            if (trail >= 0) {
                const int64_t count = find_around(&m, order[anchor], anchor, found);
                if (dm_index_of(found, count, vertex) >= 0)
                    step = DM_STEP_NEAR;
            }
        }
        const int64_t *const of = around + COLUMNS * following;
        const int64_t follows = dm_min(of[RANKED], 1) * (of[NEWEST] == i - 1 ? 2 : 1);
        step = dm_code_step(c, step, &s, follows, i > 0);
        if (step == DM_STEP_NEXT) {
            vertex = following;
        } else if (step == DM_STEP_NEAR) {
            int64_t anchor = c->decoding ? 0 : around[COLUMNS * vertex + m.key];
            anchor = dm_code_anchor(c, anchor, trail, &s);
            if (anchor < 0 || anchor >= i)
                return DM_CORRUPT;
            const int64_t count = find_around(&m, order[anchor], anchor, found);
            if (count == 0)
                return DM_CORRUPT;
            vertex = choose(c, &s, &m, last, found, count, i, vertex);
        } else {
            vertex = dm_code_any(c, &m.left, vertex, n - i);
        }
        order[i] = vertex;
        for (int k = 0; k < COLUMNS; k++)
            last[k] = around[COLUMNS * vertex + k];
        dm_follow(&s, last[m.key] >= 0 ? last[m.key] : i);
        rank_vertex(&m, vertex, i);
        previous = vertex;
    }
    return DM_OK;
}
