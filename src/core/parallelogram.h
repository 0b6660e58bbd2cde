/* Model of quantized positions. */
#ifndef DELTAMESH_PARALLELOGRAM_H
#define DELTAMESH_PARALLELOGRAM_H

#include "residual.h"

/* Positions of a file that an encoder has written are below 2^31; extrapolation in a crafted one
   must not leave the integers. */
#define DM_GRID_BOUND ((int64_t)1 << 40)

enum {
    /* The mean of the parallelograms, the gate's near end, the line from the apex through that, the
       gate's parallelogram, the mean of the known neighbours. */
    DM_PREDICTIONS = 5,
    DM_CANDIDATES = 3, /* the ends of the gate, and the apex */
    /* Vertices are of a class by how many parallelograms they have (or, having none, neighbours),
       and by the shape of the gate's triangle: the shorter of the two sides at its apex over the
       longer, in eighths. */
    DM_SHAPES = 10,
    DM_INSIDE = 4 * DM_SHAPES + 4, /* the first class of those that are predicted within quads */
    DM_CLASSES = DM_INSIDE + 4 * DM_SHAPES,
};

/* The mixers of one axis. */
#define DM_POSITION_MIXERS DM_MIXERS_OF_AXIS(DM_MAGNITUDES + 1, DM_SIGNS + 1, DM_CANDIDATES)

#endif
