/* Model of stitches. */
#ifndef DELTAMESH_STITCHING_H
#define DELTAMESH_STITCHING_H

#include "models.h"

enum { DM_MAX_BITS = 40 }; /* of a number: counts are below 2^40 */

/* The first slot of each input of the mixers: its range is indexed by its contexts. */
#define STITCHING_RANGES(R)                                                                        \
    R(STITCHED_BY_LOWER, 2 * 4 * 4)                                                                \
    R(STITCHED_BY_BEFORE, 2 * 4 * 2)                                                               \
    R(STITCHED_BY_VOTES, 2 * 8 * 2)                                                                \
    R(MATCHES_BY_RANK, 8 * 16)                                                                     \
    R(MATCHES_BY_RIVAL, 8 * 8)                                                                     \
    R(REVERSED_BY_BEFORE, 2 * 2)                                                                   \
    R(REVERSED_BY_AROUND, 4 * 4)                                                                   \
    R(REVERSED_BY_BOTH, 4 * 4 * 4)                                                                 \
    R(REPEATED_BY_LAST, 2 * 4 * 4)                                                                 \
    R(REPEATED_BY_AROUND, 2 * 4 * 4)                                                               \
    R(NUMBER_AT, DM_MAX_BITS)                                                                      \
    R(ADJACENT_AT, 1)
enum { STITCHING_RANGES(DM_RANGE) STITCHING_SLOTS };

enum {
    DM_STITCHED_MIXER,
    DM_MATCHES_MIXER,
    DM_REVERSED_MIXER,
    DM_REPEATED_MIXER,
    DM_NUMBER_MIXER,
    DM_ADJACENT_MIXER,
    DM_STITCHING_MIXERS
};

#endif
