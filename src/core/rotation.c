/* Rotation of a polygon; see `rotation.h`. */
#include "rotation.h"

/* The corner of the face before that has a vertex, 3 if none has. */
static int64_t among(const int64_t *recent, int64_t v)
{
    for (int64_t k = 0; k < 3; k++)
        if (recent[k] == v)
            return k;
    return 3;
}

/* 0 if the rank of v is below that of w, 1 if above, 2 if they are equal. */
static int64_t rising(const int64_t *rank, int64_t v, int64_t w)
{
    const int64_t b = dm_rank_of(rank, v), d = dm_rank_of(rank, w);
    return b < d ? 0 : (d < b ? 1 : 2);
}

/* Code the number of corners, below `gap`, from one of its triangle to the first of a polygon.

   corners (size,) are the vertices of the polygon; at: that corner. */
int64_t dm_code_skipped(dm_coder *c, dm_rotations *r, const int64_t *corners, int64_t size,
                        int64_t at, int64_t gap, int64_t skipped)
{
    for (int64_t k = 0; k < gap - 1; k++) {
        const int64_t v = corners[(at + k) % size], w = corners[(at + k + 1) % size];
        const int64_t rises = rising(r->rank, v, w);
        const int64_t slots[] = {
            SKIP + 12 * among(r->recent[0], v) + 3 * among(r->recent[0], w) + rises,
            SKIP + DM_SKIP_SIZE + r->skips,
            SKIP + 2 * DM_SKIP_SIZE + 12 * dm_min(k, 3) + 4 * rises + r->skips % 4,
        };
        const int64_t bit = dm_code_bit(c, skipped > k, DM_SKIP_MIXER, slots);
        r->skips = (2 * r->skips + bit) & 15;
        if (!bit)
            return k;
    }
    return gap - 1;
}

/* Code the rotation of a face (3,), relative to the corner that its vertices single out. */
int64_t dm_code_rotation(dm_coder *c, dm_rotations *r, const int64_t *face, int64_t rotation)
{
    const int64_t mode = r->mode == DM_FIRST ? DM_OLDEST : r->mode;
    const int64_t base = dm_anchor_corner(face, r->rank, mode, 0);
    int64_t mask = 0, pattern = 0;
    for (int64_t j = 0; j < 3; j++) {
        const int64_t where = among(r->recent[0], face[(base + j) % 3]);
        mask = 2 * mask + (where < 3);
        pattern = 4 * pattern + where;
    }
    const int64_t rises = rising(r->rank, face[(base + 1) % 3], face[(base + 2) % 3]);
    const int64_t straight = (3 - base) % 3, actual = dm_rest(rotation - base, 3);
    int64_t result = 2;
    for (int64_t k = 0; k < 2; k++) {
        const int64_t at = ROTATION + k * DM_STEP_INPUTS * DM_ROTATION_SIZE;
        const int64_t slots[] = {
            at + 3 * pattern + r->rotated[0],
            at + DM_ROTATION_SIZE + 24 * r->rotated[0] + 3 * mask + rises,
            at + 2 * DM_ROTATION_SIZE + 3 * r->rotated[1] + straight,
        };
        if (dm_code_bit(c, actual == k, DM_ROTATION_MIXER + k, slots)) {
            result = k;
            break;
        }
    }
    r->rotated[0] = result;
    r->rotated[1] = r->rotated[1] % 2 * 2 + (result == straight);
    return (base + result) % 3;
}
