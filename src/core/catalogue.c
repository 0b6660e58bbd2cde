/* Models and constants by their names, for those who cannot include the headers. */
#include <stddef.h>
#include <string.h>

#include "choices.h"
#include "closest.h"
#include "coder.h"
#include "exact.h"
#include "grid.h"
#include "hidden_edges.h"
#include "labels.h"
#include "multigrid.h"
#include "parallelogram.h"
#include "points.h"
#include "rotation.h"
#include "stitching.h"
#include "supernodes.h"
#include "valence.h"
#include "wedges.h"

static const dm_mixers VECTOR[] = {DM_VECTOR_MIXERS, DM_VECTOR_MIXERS, DM_VECTOR_MIXERS};
static const dm_mixers POSITION[] = {DM_POSITION_MIXERS, DM_POSITION_MIXERS, DM_POSITION_MIXERS};
static const dm_mixers LABEL[] = {{3, DM_CANDIDATE_INPUTS, DM_LABEL_LIMIT},
                                  {1, DM_NEW_INPUTS, DM_LABEL_LIMIT},
                                  {DM_LABEL_DIGITS, DM_DIGIT_INPUTS, DM_LABEL_LIMIT}};
static const dm_mixers POINT[] = {{2, 1, 255}};
static const dm_mixers CHOICE[] = {{1, 1, 255}};
static const dm_mixers WEDGE[] = {
    {1, DM_SAME_INPUTS, 255}, {1, DM_NEW_WEDGE_INPUTS, 255}, {1, DM_MORE_INPUTS, 255}};
static const dm_mixers STITCH[] = {{1, 3, 255}, {1, 2, 255}, {1, 3, 255},
                                   {1, 2, 255}, {1, 1, 255}, {1, 1, 255}};
static const dm_mixers HIDE[] = {{1, 4, 255}, {1, 3, 255}, {1, 2, 255}};
static const dm_mixers VALENCE[] = {{2 * DM_TREE, DM_VALENCE_INPUTS, 500}, {1, 1, 255},
                                    {1, 3, 1000}, {1, 1, 1000}, {3, 1, 255}};
static const dm_mixers ORDER[] = {
    DM_VECTOR_MIXERS, {5, DM_STEP_INPUTS, 255}, {1, DM_TRACK_INPUTS, 255}, {1, DM_STEP_INPUTS, 255}};
/* The mixers of one axis, then those of one format: a coder has three of the former. */
static const dm_mixers EXACT_AXIS[] = {{DM_AXIS_CHOICE_MIXERS, DM_CHOICES, DM_EXACT_LIMIT}};
static const dm_mixers EXACT_FORMAT[] = {{DM_DISTANCE_LENGTHS, DM_EXACT_MAGNITUDES, DM_EXACT_LIMIT},
                                         {1, DM_EXACT_MANTISSAS, DM_EXACT_LIMIT},
                                         {1, DM_EXACT_SIGNS, DM_EXACT_LIMIT}};

static const dm_range HASHED[] = {{"HASHED", 0}};
static const dm_range POINT_SLOTS[] = {POINTS_RANGES(DM_RANGE_ROW)};
static const dm_range CHOICE_SLOTS[] = {CHOICES_RANGES(DM_RANGE_ROW)};
static const dm_range WEDGE_SLOTS[] = {WEDGES_RANGES(DM_RANGE_ROW)};
static const dm_range STITCH_SLOTS[] = {STITCHING_RANGES(DM_RANGE_ROW)};
static const dm_range HIDE_SLOTS[] = {HIDDEN_RANGES(DM_RANGE_ROW)};
static const dm_range TREE_SLOTS[] = {
    VALENCE_TREES(DM_RANGE_ROW){"CONTEXTS", CONTEXTS}, VALENCE_RANGES(DM_RANGE_ROW)};
static const dm_range ORDER_SLOTS[] = {STEPS_RANGES(DM_RANGE_ROW)};
static const dm_range AXIS_RANGES[] = {EXACT_AXIS_RANGES(DM_RANGE_ROW)};
static const dm_range FORMAT_RANGES[] = {EXACT_FORMAT_RANGES(DM_RANGE_ROW)};

#define MODEL(name, slots, mixers, ranges)                                                         \
    {                                                                                              \
        name, slots, mixers, DM_COUNT(mixers), ranges, DM_COUNT(ranges)                            \
    }

static const dm_model MODELS[] = {
    MODEL("vectors", DM_HASH_SLOTS, VECTOR, HASHED),
    MODEL("positions", DM_HASH_SLOTS, POSITION, HASHED),
    MODEL("labels", DM_LABEL_SLOTS, LABEL, HASHED),
    MODEL("points", POINTS_SLOTS, POINT, POINT_SLOTS),
    MODEL("choices", CHOICES_SLOTS, CHOICE, CHOICE_SLOTS),
    MODEL("wedges", WEDGES_SLOTS, WEDGE, WEDGE_SLOTS),
    MODEL("stitching", STITCHING_SLOTS, STITCH, STITCH_SLOTS),
    MODEL("hidden_edges", HIDDEN_SLOTS, HIDE, HIDE_SLOTS),
    MODEL("valence", VALENCE_SLOTS, VALENCE, TREE_SLOTS),
    MODEL("steps", STEPS_SLOTS, ORDER, ORDER_SLOTS),
    MODEL("exact_axis", AXIS_SLOTS, EXACT_AXIS, AXIS_RANGES),
    MODEL("exact_format", FORMAT_SLOTS, EXACT_FORMAT, FORMAT_RANGES),
};

#define CONSTANT(name) {#name, name}

static const dm_constant CONSTANTS[] = {
    CONSTANT(DM_OK),
    CONSTANT(DM_CORRUPT),
    CONSTANT(DM_INVALID),
    CONSTANT(DM_BUCKETS),
    CONSTANT(DM_FORMAT_SIZE),
    CONSTANT(DM_AXIS_SIZE),
    CONSTANT(DM_MAX_INPUTS),
    CONSTANT(DM_PROBABILITY_BITS),
    CONSTANT(DM_COUNT_BITS),
    CONSTANT(DM_LENGTHS),
    CONSTANT(DM_MANTISSAS),
    CONSTANT(DM_HASH_LIMIT),
    CONSTANT(DM_HASH_SLOTS),
    CONSTANT(DM_GRID_BOUND),
    CONSTANT(DM_PREDICTIONS),
    CONSTANT(DM_CANDIDATES),
    CONSTANT(DM_CLASSES),
    CONSTANT(DM_FOLLOWERS),
    CONSTANT(DM_ACROSS),
    CONSTANT(DM_FAN),
    CONSTANT(DM_REPEAT),
    CONSTANT(DM_DEGENERATE),
    CONSTANT(DM_FIRST),
    CONSTANT(DM_OLDEST),
    CONSTANT(DM_NEWEST),
    CONSTANT(DM_EXACT_BOUND),
    CONSTANT(DM_FIRST_FORMAT),
    CONSTANT(DM_SECOND_FORMAT),
    CONSTANT(DM_RAW),
    CONSTANT(DM_NEGATIVE_ZERO),
    CONSTANT(DM_LEAF),
    CONSTANT(DM_WIDEST),
    CONSTANT(DM_TILE),
    CONSTANT(DM_COORDINATES),
    CONSTANT(DM_LANES),
    CONSTANT(DM_MAX_LEVELS),
    CONSTANT(DM_MAX_DENSE),
    CONSTANT(DM_BLOCK),
};

const dm_model *dm_find_model(const char *name)
{
    for (int64_t k = 0; k < DM_COUNT(MODELS); k++)
        if (strcmp(MODELS[k].name, name) == 0)
            return &MODELS[k];
    return NULL;
}

int dm_find_constant(const char *name, int64_t *value)
{
    for (int64_t k = 0; k < DM_COUNT(CONSTANTS); k++) {
        if (strcmp(CONSTANTS[k].name, name) == 0) {
            *value = CONSTANTS[k].value;
            return DM_OK;
        }
    }
    return DM_INVALID;
}

#ifndef DM_SOURCES
#define DM_SOURCES ""
#endif

const char *dm_sources(void) { return DM_SOURCES; }
