/* Cuts of a triangle complex along edges, until it is an oriented manifold. */
#include <string.h>

#include "deltamesh_core.h"
#include "graphs.h"
#include "halfedges.h"
#include "integers.h"

/* The root of a face, and whether the face is reversed against it, halving paths on the way. */
static int64_t find(int64_t *parent, uint8_t *reversed, int64_t f, uint8_t *odd)
{
    *odd = 0;
    while (parent[f] != f) {
        const int64_t up = parent[f];
        reversed[f] ^= reversed[up];
        parent[f] = parent[up];
        *odd ^= reversed[f];
        f = parent[f];
    }
    return f;
}

/* Reverse faces so that as many pairs as possible agree: union-find with parities.

   first, second (pairs,): half-edges on one edge; `twisted` where they run the same way. parent
   (faces,): at first each face itself, ends as the root of each face's component. reversed (faces,):
   at first 0, ends as whether to reverse the face: fewer than half of each component. Scratch: size,
   against (faces,). */
int dm_orient(const int64_t *first, const int64_t *second, const uint8_t *twisted, int64_t pairs,
              int64_t *parent, uint8_t *reversed, int64_t faces, int64_t *size, int64_t *against)
{
    uint8_t odd, other;
    if (!dm_all_in(first, pairs, 0, 3 * faces) || !dm_all_in(second, pairs, 0, 3 * faces))
        return DM_INVALID;
    for (int64_t f = 0; f < faces; f++) {
        if (parent[f] != f || reversed[f])
            return DM_INVALID;
        size[f] = against[f] = 0;
    }
    for (int64_t k = 0; k < pairs; k++) {
        const int64_t f = find(parent, reversed, first[k] / 3, &odd);
        const int64_t g = find(parent, reversed, second[k] / 3, &other);
        if (f != g) { /* the root is the first face of its component */
            const int64_t low = dm_min(f, g), high = dm_max(f, g);
            parent[high] = low;
            reversed[high] = (uint8_t)(odd ^ other ^ (twisted[k] ? 1 : 0));
        }
    }
    for (int64_t f = 0; f < faces; f++) {
        const int64_t root = find(parent, reversed, f, &odd);
        parent[f] = root;
        reversed[f] = odd;
        size[root]++;
        against[root] += odd;
    }
    for (int64_t f = 0; f < faces; f++)
        reversed[f] ^= 2 * against[parent[f]] > size[parent[f]];
    return DM_OK;
}

/* Pair half-edges of edges with many faces: those of one component, then across components.

   order (length,): half-edges by edge and by component; edge i has those from bounds[i] on. forward
   (3 faces,), component (faces,). opposite (3 faces,): filled in. Scratch: waiting (2, length). */
int dm_pair_up(const int64_t *order, int64_t length, const int64_t *bounds, int64_t edges,
               const uint8_t *forward, const int64_t *component, int64_t *opposite, int64_t faces,
               int64_t *waiting)
{
    if (!dm_are_bounds(bounds, edges, length) || !dm_all_in(order, length, 0, 3 * faces))
        return DM_INVALID;
    for (int64_t i = 0; i < edges; i++) {
        for (int across = 0; across < 2; across++) {
            int64_t count[2] = {0, 0}, last = -1;
            for (int64_t at = bounds[i]; at < bounds[i + 1]; at++) {
                const int64_t h = order[at];
                if (opposite[h] >= 0)
                    continue;
                if (!across && component[h / 3] != last) {
                    count[0] = count[1] = 0;
                    last = component[h / 3];
                }
                const int along = forward[h] ? 1 : 0;
                if (count[1 - along] > 0) {
                    const int64_t g = waiting[(1 - along) * length + --count[1 - along]];
                    opposite[h] = g, opposite[g] = h;
                } else {
                    waiting[along * length + count[along]++] = h;
                }
            }
        }
    }
    return DM_OK;
}

/* Label the fans of corners in the order of first corners, and set how many there are. */
int dm_label_fans(const int64_t *restrict opposite, int64_t halfedges, int64_t *restrict label,
                  int64_t *count)
{
    int64_t fans = 0;
    if (halfedges % 3 != 0)
        return DM_INVALID;
    memset(label, 0xFF, (size_t)halfedges * sizeof(*label)); /* -1 */
    for (int64_t h = 0; h < halfedges; h++) {
        if (label[h] >= 0)
            continue;
        int64_t g = h, left = halfedges;
        do {
            const int64_t other = opposite[g];
            label[g] = fans;
            if (other >= halfedges)
                return DM_INVALID;
            g = other < 0 ? -1 : dm_next(other);
        } while (g >= 0 && g != h && --left > 0);
        g = g < 0 ? h : -1; /* an open fan goes on at the other side of its first corner */
        for (; left > 0 && g >= 0; left--) {
            if (g >= halfedges)
                return DM_INVALID;
            label[g] = fans;
            g = opposite[dm_previous(g)];
        }
        fans++;
    }
    *count = fans;
    return DM_OK;
}

/* The corner at which the fan of a corner begins, itself if the fan is closed. */
static int64_t first_of_fan(const int64_t *opposite, int64_t h)
{
    int64_t g = h;
    while (opposite[dm_previous(g)] >= 0) {
        g = opposite[dm_previous(g)];
        if (g == h)
            break;
    }
    return g;
}

/* Cut an edge open, before its half-edge h. */
static void open_edge(int64_t *opposite, int64_t h)
{
    opposite[opposite[h]] = -1;
    opposite[h] = -1;
}

/* Whether half-edges are opposite to each other, so that walks around a corner end. */
static int are_opposites(const int64_t *opposite, int64_t halfedges)
{
    int good = halfedges % 3 == 0 && dm_all_in(opposite, halfedges, -1, halfedges);
    for (int64_t h = 0; good && h < halfedges; h++)
        good = opposite[h] < 0 || opposite[opposite[h]] == h;
    return good;
}

/* Cut fans that meet a neighbour twice, as at both sides of a slit, into runs that do not.

   A manifold of triangles may have one edge only between two of its vertices. `label` (halfedges,)
   and `count` are those of `dm_label_fans`. Scratch: seen (count + halfedges,), done (halfedges,). */
int dm_break_slits(int64_t *opposite, int64_t halfedges, int64_t *label, int64_t count,
                   int64_t *seen, uint8_t *done)
{
    if (!are_opposites(opposite, halfedges) || !dm_all_in(label, halfedges, 0, count))
        return DM_INVALID;
    for (int64_t k = 0; k < count + halfedges; k++)
        seen[k] = -1;
    for (int64_t h = 0; h < halfedges; h++)
        done[h] = 0; /* not by label: cuts split further fans, too */
    int64_t run = 0, fresh = count;
    for (int64_t h = 0; h < halfedges; h++) {
        if (done[h])
            continue;
        const int64_t first = first_of_fan(opposite, h), before = dm_previous(first);
        const int closed = opposite[before] >= 0;
        int64_t cuts = 0, c = first;
        run++;
        seen[label[before]] = run;
        for (;;) {
            done[c] = 1;
            const int64_t after = opposite[c] >= 0 ? dm_next(opposite[c]) : -1;
            const int64_t out = label[dm_next(c)];
            const int ends = closed && after == first && cuts == 0; /* the spoke it began with */
            if (seen[out] == run && !ends && fresh < count + halfedges) {
                open_edge(opposite, dm_previous(c));
                cuts++;
                run++;
                fresh++;
                seen[label[dm_previous(c)]] = run;
            }
            seen[out] = run;
            if (cuts > 0)
                label[c] = fresh - 1; /* its neighbours can distinguish this run from the others */
            if (after < 0 || after == first)
                break;
            c = after;
        }
        if (cuts > 0 && opposite[before] >= 0)
            open_edge(opposite, before);
    }
    return DM_OK;
}
