/* Stitches of a manifold: vertices at one point, and faces reversed, repeated or degenerate.

   Everything is coded in the order of the manifold, in contexts of its connectivity. Where two banks
   of a cut run side by side, the mate of a vertex, another vertex at its point, is next to the mate
   of its neighbour: the neighbours of the mates of its neighbours are candidates, ranked by how many
   neighbours suggest them. */
#include "stitching.h"

#include "coder.h"
#include "graphs.h"

/* Candidates that are kept, and neighbours of neighbours that are looked at: a bound on the work. */
enum { CANDIDATES = 16, LOOKS = 256 };

typedef struct {
    const int32_t *indptr, *indices;
    const uint8_t *boundary;
    int64_t *points;
    int64_t *latest;  /* of the vertices of each point */
    int64_t *earlier; /* the vertex before, at the point of each vertex */
    int64_t *beside;  /* the last vertex that has a neighbour at each point */
    int64_t candidates[CANDIDATES], votes[CANDIDATES], found;
} stitched_mesh;

/* Count a vote of a vertex w for its point as that of a vertex v. */
static void vote(stitched_mesh *m, int64_t v, int64_t w)
{
    const int64_t point = m->points[w];
    int64_t k = 0;
    while (k < m->found && m->candidates[k] != point)
        k++;
    if (k == CANDIDATES)
        return;
    if (k == m->found)
        m->candidates[k] = point, m->votes[k] = 0, m->found++;
    m->votes[k] += m->boundary[w] == m->boundary[v] ? 2 : 1;
    for (; k > 0 && m->votes[k - 1] < m->votes[k]; k--) {
        const int64_t candidate = m->candidates[k], votes = m->votes[k];
        m->candidates[k] = m->candidates[k - 1], m->votes[k] = m->votes[k - 1];
        m->candidates[k - 1] = candidate, m->votes[k - 1] = votes;
    }
}

/* Find the points that a vertex may be at, in the order of their votes. */
static void find_candidates(stitched_mesh *m, int64_t v)
{
    int64_t looks = 0;
    m->found = 0;
    for (int64_t at = m->indptr[v]; at < m->indptr[v + 1]; at++) {
        const int64_t u = m->indices[at];
        if (u >= v)
            break;
        for (int64_t mate = m->latest[m->points[u]]; mate >= 0 && looks < LOOKS;
             mate = m->earlier[mate]) {
            looks++;
            for (int64_t by = m->indptr[mate]; by < m->indptr[mate + 1]; by++) {
                const int64_t w = m->indices[by];
                if (w >= v || looks == LOOKS)
                    break;
                looks++;
                const int slit = m->boundary[u] && m->boundary[v] && m->boundary[w];
                if (m->beside[m->points[w]] != v && (mate != u || slit))
                    vote(m, v, w);
            }
        }
    }
}

/* Code the point of a vertex, one of those so far; -1: a candidate that was skipped before. */
static int64_t code_match(dm_coder *c, const stitched_mesh *m, int64_t point, int64_t count)
{
    for (int64_t k = 0; k < m->found; k++) {
        const int64_t rank = dm_min(k, 7), votes = dm_min(m->votes[k], 15);
        const int64_t rival = k + 1 < m->found ? dm_min(m->votes[k + 1], 7) : 0;
        const int64_t at[] = {MATCHES_BY_RANK + rank * 16 + votes,
                              MATCHES_BY_RIVAL + dm_min(votes, 7) * 8 + rival};
        if (dm_code_bit(c, m->candidates[k] == point, DM_MATCHES_MIXER, at))
            return m->candidates[k];
    }
    point = dm_code_below(c, point, count);
    for (int64_t k = 0; k < m->found; k++)
        if (m->candidates[k] == point)
            return -1;
    return point;
}

/* Code `points` (n,), filled in when decoding, and set how many there are.

   Points are numbered in the order of their first vertices. `boundary` (n,) is whether vertices are
   on a boundary of the manifold; neighbours ascend in the rows of the graph. `latest`, `earlier` and
   `beside` (n,) are scratch. */
int dm_code_stitches(dm_coder *c, const int32_t *indptr, int64_t n, const int32_t *indices,
                     int64_t entries, const uint8_t *boundary, int64_t *points, int64_t *latest,
                     int64_t *earlier, int64_t *beside, int64_t *count)
{
    if (!dm_has_memory(c, STITCHING_SLOTS, DM_STITCHING_MIXERS) ||
        !dm_is_graph(indptr, n, indices, entries) ||
        (!c->decoding && !dm_all_in(points, n, 0, n)))
        return DM_INVALID;
    stitched_mesh m = {indptr, indices, boundary, points, latest, earlier, beside, {0}, {0}, 0};
    for (int64_t v = 0; v < n; v++)
        latest[v] = earlier[v] = beside[v] = -1;
    int64_t found = 0, last = 0, last_but_one = 0; /* points; whether vertices were stitched */
    for (int64_t v = 0; v < n; v++) {
        int64_t lower = 0, stitched = 0;
        for (int64_t at = indptr[v]; at < indptr[v + 1]; at++) {
            const int64_t u = indices[at];
            if (u >= v)
                break; /* neighbours ascend */
            lower++;
            stitched += earlier[latest[points[u]]] >= 0;
            beside[points[u]] = v;
        }
        find_candidates(&m, v);
        const int64_t best = m.found > 0 ? dm_min(m.votes[0], 7) : 0, edge = boundary[v] ? 1 : 0;
        const int64_t before = last + 2 * last_but_one;
        const int64_t at[] = {
            STITCHED_BY_LOWER + (edge * 4 + dm_min(stitched, 3)) * 4 + dm_min(lower, 3),
            STITCHED_BY_BEFORE + (edge * 4 + before) * 2 + dm_min(stitched, 1),
            STITCHED_BY_VOTES + (edge * 8 + best) * 2 + last,
        };
        last_but_one = last;
        last = v > 0 ? dm_code_bit(c, points[v] < found, DM_STITCHED_MIXER, at) : 0;
        if (last) {
            points[v] = code_match(c, &m, points[v], found);
            if (points[v] < 0 || beside[points[v]] == v)
                return DM_CORRUPT;
        } else {
            points[v] = found++;
        }
        earlier[v] = latest[points[v]];
        latest[points[v]] = v;
    }
    *count = found;
    return DM_OK;
}

/* Code which faces (faces,) are reversed, filled in when decoding. */
int dm_code_reversed(dm_coder *c, const int64_t *opposite, int64_t faces, uint8_t *reversed)
{
    if (!dm_has_memory(c, STITCHING_SLOTS, DM_STITCHING_MIXERS))
        return DM_INVALID;
    for (int64_t f = 0; f < faces; f++) {
        int64_t known = 0, around = 0;
        for (int64_t h = 3 * f; h < 3 * f + 3; h++) {
            if (opposite[h] >= 0 && opposite[h] / 3 < f) {
                known++;
                around += reversed[opposite[h] / 3] ? 1 : 0;
            }
        }
        const int64_t last = f > 0 && reversed[f - 1], before = f > 1 && reversed[f - 2];
        const int64_t at[] = {
            REVERSED_BY_BEFORE + 2 * last + before,
            REVERSED_BY_AROUND + 4 * known + around,
            REVERSED_BY_BOTH + 4 * (4 * known + around) + 2 * last + before,
        };
        reversed[f] = dm_code_bit(c, reversed[f] ? 1 : 0, DM_REVERSED_MIXER, at) == 1;
    }
    return DM_OK;
}

/* Code how often each face is repeated, `repeats` (faces, 2): in its winding, in the opposite one.

   Filled in when decoding; their sum has to be the total. */
int dm_code_repeats(dm_coder *c, const int64_t *opposite, int64_t faces, int64_t *repeats,
                    int64_t total)
{
    if (!dm_has_memory(c, STITCHING_SLOTS, DM_STITCHING_MIXERS))
        return DM_INVALID;
    for (int64_t f = 0; f < faces; f++) {
        for (int winding = 0; winding < 2; winding++) {
            int64_t around = 0, k = 0;
            for (int64_t h = 3 * f; h < 3 * f + 3; h++)
                if (opposite[h] >= 0 && opposite[h] / 3 < f)
                    around = dm_max(around, repeats[2 * (opposite[h] / 3) + winding]);
            const int64_t last = f > 0 ? repeats[2 * (f - 1) + winding] : 0;
            for (; total > 0; total--) {
                const int64_t level = winding * 4 + dm_min(k, 3);
                const int64_t at[] = {REPEATED_BY_LAST + 4 * level + dm_clamp(last, 0, 3),
                                      REPEATED_BY_AROUND + 4 * level + dm_min(around, 3)};
                if (!dm_code_bit(c, repeats[2 * f + winding] > k, DM_REPEATED_MIXER, at))
                    break;
                k++;
            }
            repeats[2 * f + winding] = k;
        }
    }
    return total == 0 ? DM_OK : DM_CORRUPT;
}

/* The index of a vertex among ascending neighbours, -1 if it is none. */
static int64_t find(const int32_t *neighbours, int64_t valence, int64_t vertex)
{
    int64_t low = 0, high = valence;
    while (low < high) {
        const int64_t middle = (low + high) / 2;
        if (neighbours[middle] < vertex)
            low = middle + 1;
        else
            high = middle;
    }
    return low < valence && neighbours[low] == vertex ? low : -1;
}

/* Code faces (a, a, b) as `pairs` (count, 2) of a and b, in ascending order of a.

   Filled in when decoding. They have to ascend below n, the number of points, of which those of the
   graph, `used` of them, come first. */
int dm_code_degenerate(dm_coder *c, const int32_t *indptr, int64_t used, const int32_t *indices,
                       int64_t entries, int64_t *pairs, int64_t count, int64_t n)
{
    if (!dm_has_memory(c, STITCHING_SLOTS, DM_STITCHING_MIXERS) || n < used || used < 0 ||
        !dm_is_graph(indptr, used, indices, entries))
        return DM_INVALID;
    int64_t a = 0, last = -1;
    for (int64_t k = 0; k < count; k++) {
        const int64_t more =
            dm_code_number(c, pairs[2 * k] - a + 1, NUMBER_AT, DM_NUMBER_MIXER, DM_MAX_BITS);
        a += more - 1;
        if (a < 0 || a >= n)
            return DM_CORRUPT;
        const int64_t first = indptr[dm_min(a, used)];
        const int64_t valence = a < used ? indptr[a + 1] - first : 0;
        int64_t b = pairs[2 * k + 1], adjacent = 0;
        const int64_t index = find(indices + first, valence, b);
        if (valence > 0) {
            const int64_t at = ADJACENT_AT;
            adjacent = dm_code_bit(c, index >= 0, DM_ADJACENT_MIXER, &at);
        }
        if (adjacent) {
            b = indices[first + dm_code_below(c, index, valence)];
        } else {
            b = dm_code_below(c, b, n);
            if (find(indices + first, valence, b) >= 0)
                return DM_CORRUPT;
        }
        if (more == 1 && b < last)
            return DM_CORRUPT;
        last = b;
        pairs[2 * k] = a, pairs[2 * k + 1] = b;
    }
    return DM_OK;
}
