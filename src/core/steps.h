/* Steps over a mesh that both sides know, which code an order of its vertices or faces.

   Each step names the next vertex, or face, of the order in one of three ways: as the next one left
   in coding order; as one at an *anchor*, a vertex that has its rank already, which is coded as the
   distance of its rank from that of an earlier anchor; or as a number among all that are left, which
   costs no more than an order without any pattern has to. The same functions encode and decode.
   Every step takes one element, so that any stream ends. */
#ifndef DELTAMESH_STEPS_H
#define DELTAMESH_STEPS_H

#include "remaining.h"
#include "residual.h"

/* Kinds of steps. */
enum { DM_STEP_NEXT, DM_STEP_NEAR, DM_STEP_ANY };
/* Anchors: the first vertex of a face, or the oldest or newest of the vertices around. */
enum { DM_FIRST, DM_OLDEST, DM_NEWEST };

enum {
    /* Elements of a ring that are looked at: a vertex of a thousand faces must not cost a million
       steps. */
    DM_SCANNED = 64,
    DM_STEP_CANDIDATES = 16,
    DM_TRAIL_BITS = 5,
    DM_TRAILS = 1 << DM_TRAIL_BITS,
};

/* A vertex without a rank counts as after all others: no difference of two ranks is as large as
   DM_LARGEST_RANK, but that of DM_NO_RANK and any rank is larger. */
#define DM_NO_RANK ((int64_t)1 << 60)
#define DM_LARGEST_RANK ((int64_t)1 << 50)

/* Inputs of the mixers, and slots of each of them. */
enum { DM_STEP_INPUTS = 3, DM_TRACK_INPUTS = 2 };
enum {
    DM_STEP_SIZE = 512,
    DM_CHOOSE_SIZE = 512,
    DM_ROTATION_SIZE = 256,
    DM_TRACK_SIZE = 1024,
    DM_SKIP_SIZE = 64,
};

/* Slots: the distances, as vectors of one coordinate; then those of the kinds of steps, of the
   choice at an anchor, of the rotation of a face, of the trails, of the corners skipped before a
   polygon. */
#define STEPS_RANGES(R)                                                                            \
    R(DISTANCE, DM_HASH_SLOTS)                                                                     \
    R(STEP, 2 * DM_STEP_INPUTS * DM_STEP_SIZE)                                                     \
    R(CHOOSE, DM_STEP_INPUTS * DM_CHOOSE_SIZE)                                                     \
    R(ROTATION, 2 * DM_STEP_INPUTS * DM_ROTATION_SIZE)                                             \
    R(TRACK, DM_TRACK_INPUTS * DM_TRACK_SIZE)                                                      \
    R(SKIP, DM_STEP_INPUTS * DM_SKIP_SIZE)
enum { STEPS_RANGES(DM_RANGE) STEPS_SLOTS };

enum {
    DM_STEP_MIXER = DM_AXIS_MIXERS,
    DM_CHOOSE_VERTEX_MIXER = DM_STEP_MIXER + 2,
    DM_ROTATION_MIXER,
    DM_TRACK_MIXER = DM_ROTATION_MIXER + 2,
    DM_SKIP_MIXER,
    DM_STEPS_MIXERS
};

/* An order may alternate between several places of the mesh: the trails, the last one first. Each
   has its last anchor and the last two distances; an anchor within reach of that belongs to it. */
typedef struct {
    int64_t anchor, distance, before;
} dm_trail;

/* What steps remember: the kinds of the last four, as digits; the last trail; the class of the last
   choice at an anchor; the trails. */
typedef struct {
    int64_t history, trail, choice;
    dm_trail trails[DM_TRAILS];
} dm_steps;

/* a - b as one of six classes: at most -2, -1, 0, 1, 2, above. */
static inline int64_t dm_near(int64_t a, int64_t b) { return dm_clamp(a - b, -2, 3) + 2; }

/* Where an element is among the first `count` of those found, -1 if it is not. */
static inline int64_t dm_index_of(const int64_t *found, int64_t count, int64_t element)
{
    for (int64_t k = 0; k < count; k++)
        if (found[k] == element)
            return k;
    return -1;
}

/* Code an element by its number among those that are left. */
static inline int64_t dm_code_any(dm_coder *c, const dm_remaining *left, int64_t element,
                                  int64_t count)
{
    const int64_t rank = c->decoding ? 0 : dm_left_below(left, element);
    return dm_of_rank(left, dm_code_below(c, rank, count));
}

int64_t dm_trail_of(const dm_steps *s, int64_t anchor, int64_t left, int64_t margin);
void dm_follow(dm_steps *s, int64_t anchor);
int64_t dm_code_step(dm_coder *c, int64_t step, dm_steps *s, int64_t follows, int has_anchor);
int64_t dm_code_anchor(dm_coder *c, int64_t anchor, int64_t trail, dm_steps *s);

#endif
