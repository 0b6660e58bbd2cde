/* Model of wedges. */
#ifndef DELTAMESH_WEDGES_H
#define DELTAMESH_WEDGES_H

#include "models.h"

/* The kind of a corner, by its relation to the one that it is expected to be like: across an edge,
   the first of a further fan, in a repeat of a face, in a degenerate face. */
enum { DM_ACROSS, DM_FAN, DM_REPEAT, DM_DEGENERATE };

/* The first slot of each input of the mixers: its range is indexed by its contexts. */
#define WEDGES_RANGES(R)                                                                           \
    R(SAME_BY_KIND, 4 * 4 * 4)                                                                     \
    R(SAME_BY_SEAMS, 4 * 4 * 4 * 4)                                                                \
    R(SAME_BY_UNKNOWN, 4 * 4 * 4 * 4)                                                              \
    R(SAME_BY_DISTANCE, 4 * 8 * 8)                                                                 \
    R(SAME_BY_COUNT, 4 * 4 * 4 * 2 * 2)                                                            \
    R(NEW_BY_KIND, 4 * 4 * 4)                                                                      \
    R(NEW_BY_COUNT, 16 * 4)                                                                        \
    R(MORE_BY_LAST, 4 * 4)                                                                         \
    R(MORE_BY_NUMBER, 16)
enum { WEDGES_RANGES(DM_RANGE) WEDGES_SLOTS };

enum { DM_SAME_MIXER, DM_NEW_WEDGE_MIXER, DM_MORE_MIXER, DM_WEDGE_MIXERS };
enum { DM_SAME_INPUTS = 5, DM_NEW_WEDGE_INPUTS = 2, DM_MORE_INPUTS = 2 };

#endif
