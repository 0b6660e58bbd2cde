/* Diagonals of quads, chosen walking over the surface. */
#include "deltamesh_core.h"
#include "graphs.h"

/* Choose one of two diagonals for each quad, breadth first, by a vote of its neighbours.

   start (quads + 1,), near (entries,): the neighbours of each quad. unlike (entries,): 1 if the
   diagonals of both should differ, else 0. cut (quads,): 0 or 1 where it is given, else -1: filled
   in. Scratch: votes (quads, 2), queued and queue (quads,). */
int dm_choose_diagonals(const int64_t *start, int64_t quads, const int64_t *near,
                        const int64_t *unlike, int64_t entries, int64_t *cut, int64_t *votes,
                        uint8_t *queued, int64_t *queue)
{
    if (!dm_is_matrix(start, quads, near, entries) || !dm_all_in(unlike, entries, 0, 2) ||
        !dm_all_in(cut, quads, -1, 2))
        return DM_INVALID;
    for (int64_t q = 0; q < quads; q++)
        votes[2 * q] = votes[2 * q + 1] = 0, queued[q] = 0;
    int64_t head = 0, tail = 0;
    for (int64_t seed = 0; seed < quads; seed++) {
        if (!queued[seed])
            queued[seed] = 1, queue[tail++] = seed;
        for (; head < tail; head++) {
            const int64_t q = queue[head];
            if (cut[q] < 0)
                cut[q] = votes[2 * q + 1] > votes[2 * q] ? 1 : 0;
            for (int64_t at = start[q]; at < start[q + 1]; at++) {
                const int64_t r = near[at];
                votes[2 * r + (cut[q] ^ unlike[at])]++;
                if (!queued[r])
                    queued[r] = 1, queue[tail++] = r;
            }
        }
    }
    return DM_OK;
}
