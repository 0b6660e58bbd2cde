/* Wedges, classes of corners at a point: split vertices, or the two sides of a seam.

   The corners of a point are visited fan by fan in their rotational order. A corner is in the wedge
   of the one before unless a seam runs between them, along the edge that they share; a seam at one
   end of an edge mostly goes on at the other. */
#include "wedges.h"

#include "coder.h"
#include "graphs.h"
#include "halfedges.h"

/* The status of an edge at its other end: not visited, no seam, a seam, no edge. */
enum { UNKNOWN, SMOOTH, SEAM, OPEN };

/* Put the corners of each point into rotational order, fan by fan.

   opposite (3 faces,), of a manifold; corners (3 faces,), its vertices, below n; by_point (n,), the
   vertices in the order of their points; ring (3 faces,), the corners; spoke: the half-edge that
   leads on to each from the corner before, -1 at the first of a fan; closing: that from the last of
   a closed fan to the first. `first` (n,) is scratch. */
int dm_fill_rings(const int64_t *opposite, const int64_t *corners, int64_t faces,
                  const int64_t *by_point, int64_t n, int64_t *ring, int64_t *spoke,
                  int64_t *closing, int64_t *first)
{
    const int64_t halfedges = 3 * faces;
    if (!dm_all_in(opposite, halfedges, -1, halfedges) || !dm_all_in(corners, halfedges, 0, n) ||
        !dm_all_in(by_point, n, 0, n))
        return DM_INVALID;
    for (int64_t v = 0; v < n; v++)
        first[v] = -1;
    for (int64_t h = 0; h < halfedges; h++) {
        const int64_t v = corners[h];
        if (first[v] < 0 || opposite[dm_previous(h)] < 0)
            first[v] = h;
    }
    int64_t at = 0;
    for (int64_t k = 0; k < n; k++) {
        const int64_t start = first[by_point[k]];
        if (start < 0)
            return DM_INVALID;
        const int64_t closed = opposite[dm_previous(start)];
        for (int64_t h = start, g = -1;;) {
            if (at == halfedges)
                return DM_INVALID;
            ring[at] = h, spoke[at] = g, closing[at] = closed;
            at++;
            g = h;
            if (opposite[h] < 0)
                break;
            h = dm_next(opposite[h]);
            if (h == start)
                break;
        }
    }
    return at == halfedges ? DM_OK : DM_INVALID;
}

/* Corners in the order of their points, what is known of their edges, and scratch. */
typedef struct {
    const int64_t *opposite, *bounds, *ring, *spoke, *closing, *like, *kind;
    int64_t *seams;         /* of each half-edge: the status of its edge at this end */
    int64_t *ahead, *left;  /* of each corner: see `look_ahead` */
    int64_t *met, *number;  /* the last point that had each label, and which it is there */
} wedge_mesh;

static int64_t status(const wedge_mesh *m, int64_t h)
{
    return h >= 0 && m->opposite[h] >= 0 ? m->seams[m->opposite[h]] : OPEN;
}

/* How many seams are known that run into a point.

   For each corner, set how many corners further the next of them is (0: none before the end) and
   how many edges from there on nothing is known of. */
static int64_t look_ahead(const wedge_mesh *m, int64_t first, int64_t end)
{
    int64_t seen = 0, unknown = 0, distance = 0;
    for (int64_t i = end - 1; i >= first; i--) {
        const int64_t far = status(m, m->spoke[i]);
        if (m->spoke[i] < 0 && m->closing[i] >= 0)
            seen += status(m, m->closing[i]) == SEAM;
        seen += far == SEAM;
        unknown += far == UNKNOWN;
        m->ahead[i] = distance, m->left[i] = unknown;
        if (far == SEAM)
            distance = 1;
        else if (distance > 0)
            distance++;
    }
    return seen;
}

/* Code a wedge that is not the expected one: a new one, or one of the others. */
static int64_t code_other(dm_coder *c, int64_t actual, int64_t expected, int64_t count,
                          int64_t known, int64_t far)
{
    if (count == 1)
        return 1;
    const int64_t at[] = {NEW_BY_KIND + known, NEW_BY_COUNT + 4 * dm_min(count, 15) + far};
    if (dm_code_bit(c, actual == count, DM_NEW_WEDGE_MIXER, at))
        return count;
    const int64_t other = dm_code_below(c, actual - (actual > expected), count - 1);
    return other + (other >= expected);
}

/* What was coded last: two answers; whether the point before has several wedges. */
typedef struct {
    int64_t recent, several;
} wedge_memory;

/* Code the wedges of one point, from `base` on; return how many there are. */
static int64_t code_point(dm_coder *c, const wedge_mesh *m, int64_t p, int64_t base,
                          int64_t *wedges, int encoding, wedge_memory *memory)
{
    const int64_t first = m->bounds[p], end = m->bounds[p + 1];
    const int64_t seen = dm_min(look_ahead(m, first, end), 3);
    int64_t start = 0, count = 0, changes = 0, behind = 0;
    for (int64_t i = first; i < end; i++) {
        const int64_t corner = m->ring[i], kind = m->kind[i];
        int64_t actual = 0;
        if (encoding) {
            const int64_t label = wedges[corner];
            if (m->met[label] != p)
                m->met[label] = p, m->number[label] = count;
            actual = m->number[label];
        }
        if (m->like[i] >= 0) {
            const int64_t expected = wedges[m->like[i]] - base;
            const int64_t far = status(m, m->spoke[i]), back = status(m, m->closing[i]);
            const int64_t known = kind * 16 + dm_clamp(count, 1, 4) - 1;
            const int64_t found = 64 * far + 16 * seen + 4 * dm_min(changes, 3);
            const int64_t distance = 64 * far + 8 * dm_min(behind, 7) + dm_min(m->ahead[i], 7);
            const int64_t at[DM_SAME_INPUTS] = {
                SAME_BY_KIND + (kind * 4 + far) * 4 + memory->recent,
                SAME_BY_SEAMS + found + kind,
                SAME_BY_UNKNOWN + found + dm_min(m->left[i], 3),
                SAME_BY_DISTANCE + distance,
                SAME_BY_COUNT + 4 * known + 2 * memory->several + (back == SEAM),
            };
            const int64_t same = dm_code_bit(c, actual == expected, DM_SAME_MIXER, at);
            memory->recent = 2 * (memory->recent & 1) + same;
            behind += behind > 0;
            if (same) {
                actual = expected;
            } else {
                actual = code_other(c, actual, expected, count, known + 4 * back, far);
                changes++;
                behind = 1;
            }
            if (m->spoke[i] >= 0)
                m->seams[m->spoke[i]] = same ? SMOOTH : SEAM;
        }
        if (m->spoke[i] < 0)
            start = actual;
        if (m->closing[i] >= 0)
            m->seams[m->closing[i]] = start == actual ? SMOOTH : SEAM;
        count = dm_max(count, actual + 1);
        wedges[corner] = base + actual;
    }
    memory->several = count > 1;
    return count;
}

/* Code the wedges of corners, and set how many there are, over all points.

   bounds (points + 1,): where the corners of each point begin in ring, spoke, closing, like (the
   corner that each is expected to be like, -1 for the first of a point) and kind (length,).
   wedges (length,), of each corner: any numbers below `labels` when encoding, which are compared at
   one point only; replaced by numbers that ascend with the points and the visits. labels: 0 when
   decoding. Scratch: seams (halfedges,), met and number (labels,), ahead and left (length,). */
int dm_code_wedges(dm_coder *c, const int64_t *opposite, int64_t halfedges, const int64_t *bounds,
                   int64_t points, const int64_t *ring, const int64_t *spoke,
                   const int64_t *closing, const int64_t *like, const int64_t *kind,
                   int64_t length, int64_t *wedges, int64_t labels, int64_t *seams, int64_t *met,
                   int64_t *number, int64_t *ahead, int64_t *left, int64_t *total)
{
    if (!dm_has_memory(c, WEDGES_SLOTS, DM_WEDGE_MIXERS) ||
        !dm_all_in(opposite, halfedges, -1, halfedges) || !dm_are_bounds(bounds, points, length) ||
        !dm_is_permutation(ring, length, ahead) || !dm_all_in(spoke, length, -1, halfedges) ||
        !dm_all_in(closing, length, -1, halfedges) || !dm_all_in(like, length, -1, length) ||
        !dm_all_in(kind, length, 0, 4) || (labels > 0 && !dm_all_in(wedges, length, 0, labels)))
        return DM_INVALID;
    const wedge_mesh m = {opposite, bounds, ring, spoke, closing, like, kind,
                          seams,    ahead,  left, met,   number};
    wedge_memory memory = {0};
    for (int64_t h = 0; h < halfedges; h++)
        seams[h] = UNKNOWN;
    for (int64_t label = 0; label < labels; label++)
        met[label] = -1;
    *total = 0;
    for (int64_t p = 0; p < points; p++)
        *total += code_point(c, &m, p, *total, wedges, labels > 0, &memory);
    return DM_OK;
}

/* Code the number of isolated vertices at each point (points,), filled in when decoding.

   Their sum has to be the total. */
int dm_code_isolated(dm_coder *c, int64_t *isolated, int64_t points, int64_t total)
{
    if (!dm_has_memory(c, WEDGES_SLOTS, DM_WEDGE_MIXERS))
        return DM_INVALID;
    int64_t last = 0;
    for (int64_t p = 0; p < points; p++) {
        int64_t k = 0;
        for (; total > 0; total--) {
            const int64_t at[] = {MORE_BY_LAST + dm_min(k, 3) * 4 + dm_min(last, 3),
                                  MORE_BY_NUMBER + dm_min(k, 15)};
            if (!dm_code_bit(c, isolated[p] > k, DM_MORE_MIXER, at))
                break;
            k++;
        }
        isolated[p] = last = k;
    }
    return total == 0 ? DM_OK : DM_CORRUPT;
}
