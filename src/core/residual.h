/* Vectors of one or three signed integers at vertices, and the contexts of their numbers.

   The contexts are levels, half logarithms of magnitudes around: those of the neighbours, of the
   other coordinates of the vertex, and of the vertex before. */
#ifndef DELTAMESH_RESIDUAL_H
#define DELTAMESH_RESIDUAL_H

#include "signed_integers.h"

/* Contexts of the length and of the sign. */
enum { DM_MAGNITUDES = 6, DM_SIGNS = 3 };

/* The mixers of one axis. */
#define DM_VECTOR_MIXERS DM_MIXERS_OF_AXIS(DM_MAGNITUDES, DM_SIGNS, 0)

/* What a caller knows about a vertex. */
typedef struct {
    int64_t sum[3];      /* over the known neighbours */
    int64_t absolute[3]; /* the sum of their magnitudes */
    int64_t last[3];     /* the value of the vertex before */
    int64_t hint[3];     /* a magnitude of the caller's choice */
    int64_t neighbours;  /* the number of known ones */
    int64_t kind;        /* a small class of the caller's choice, below 4 */
    int64_t hint_all;    /* another one, below 16 */
    int64_t spent;       /* the magnitude that the vertex has before its first coordinate */
} dm_known;

/* Set the contexts of a length, DM_MAGNITUDES of them; `total` sums up k->absolute. */
static inline void dm_set_magnitudes(int64_t *contexts, const dm_known *k, int axis, int64_t total,
                                     int64_t spent)
{
    const int64_t count = dm_max(k->neighbours, 1), kind = k->kind;
    const int64_t here = dm_level(dm_quotient(dm_times(4, k->absolute[axis]), count));
    const int64_t around = dm_level(dm_quotient(dm_times(4, total), count));
    const int64_t before = dm_level(spent);
    contexts[0] = here * 4 + kind;
    contexts[1] = around * DM_LEVELS + before;
    contexts[2] = here * DM_LEVELS + dm_level(dm_size(k->last[axis]));
    contexts[3] = dm_level(k->hint[axis]) * DM_LEVELS + here;
    contexts[4] = (around * 16 + k->hint_all) * 4 + kind;
    contexts[5] = (here / 2 * 16 + before / 2) * 4 + kind;
}

/* Set the contexts of a sign, DM_SIGNS of them. */
static inline void dm_set_signs(int64_t *contexts, const dm_known *k, int axis, int64_t along)
{
    const int64_t mean = k->sum[axis], positive = mean > 0;
    const int64_t size =
        dm_level(dm_quotient(dm_times(4, dm_size(mean)), dm_max(k->neighbours, 1)));
    const int64_t agrees = dm_side(along), side = dm_side(k->last[axis]);
    contexts[0] = positive * DM_LEVELS + size;
    contexts[1] = (agrees * 2 + positive) * DM_LEVELS + size;
    contexts[2] = ((side * 3 + agrees) * 2 + positive) * 8 + size / 4;
}

static inline int64_t dm_total(const dm_known *k)
{
    return dm_add(dm_add(k->absolute[0], k->absolute[1]), k->absolute[2]);
}

/* Code a vector of `axes` numbers, 1 or 3, in place when decoding. */
void dm_code_vector(dm_coder *c, int64_t *value, int axes, const dm_known *known);

#endif
