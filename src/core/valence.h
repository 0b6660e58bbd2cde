/* Valences, joins and the ends of joins that the region grower codes, and their contexts.

   Contexts are numbers that encoder and decoder both know: valences of visited vertices around the
   gate, free edges along the front, the valences coded last. */
#ifndef DELTAMESH_VALENCE_H
#define DELTAMESH_VALENCE_H

#include "coder.h"
#include "front.h"

enum {
    DM_VALENCE_INPUTS = 8,
    DM_TREE = 18, /* nodes of the tree of a valence, see valence.c */
    DM_JOIN_CONTEXT = 64,
    DM_NUMBER_SLOTS = 48,
};

/* The trees of one context after the other: nothing; the valences at the pivot and its successor;
   free edges at the pivot, its successor, its predecessor; the valences at the successor and behind
   the gate; the two coded last; the valences of two known neighbours (the predecessor of the pivot
   and the successor, if the new vertex closes the pivot; else the successor and the one coded last);
   three valences of the visited face; the sum of four valences around. */
#define VALENCE_TREES(R)                                                                           \
    R(NOTHING, 1)                                                                                  \
    R(PAIR, 16 * 16)                                                                               \
    R(FREE, 8 * 8 * 8)                                                                             \
    R(BEHIND, 16 * 16)                                                                             \
    R(LAST_TWO, 16 * 16)                                                                           \
    R(NEAR_PAIR, 2 * 16 * 16)                                                                      \
    R(FACE, 2 * 512)                                                                               \
    R(TOTAL, 32 * 2)
enum { VALENCE_TREES(DM_RANGE) CONTEXTS };

/* Slots: the trees, then those of everything rarer. */
#define VALENCE_RANGES(R)                                                                          \
    R(VALENCE_TREE, CONTEXTS * DM_TREE)                                                            \
    R(JOIN_FLAG, 3 * DM_JOIN_CONTEXT)                                                              \
    R(LOOP_FLAG, 1)                                                                                \
    R(NEAR_FLAG, 1)                                                                                \
    R(NEAR_TREE, 64)                                                                               \
    R(SIDE_TREE, 64)                                                                               \
    R(NUMBER, 3 * DM_NUMBER_SLOTS)
enum { VALENCE_RANGES(DM_RANGE) VALENCE_SLOTS };

/* Mixers: one for each node of the tree, twice; then those of the rarer bits. A join is too rare to
   forget one. */
enum {
    DM_LENGTH_MIXER = 2 * DM_TREE,
    DM_JOIN_MIXER,
    DM_LOOP_MIXER,
    DM_NEAR_MIXER,
    DM_TARGET_MIXER,
    DM_SIDE_MIXER,
    DM_VALENCE_MIXERS
};

/* Kinds of the rarer numbers. */
enum { DM_OF_VALENCE, DM_OF_LOOP, DM_OF_SIDE };

enum { DM_VALENCE_CAP = 15 };

/* What the valence model remembers: the two valences coded last; the tree of each context. */
typedef struct {
    int64_t recent[2], trees[DM_VALENCE_INPUTS];
} dm_valence_model;

void dm_set_prior(dm_coder *c);
int64_t dm_code_count(dm_coder *c, int64_t value, int64_t kind);
int64_t dm_code_valence(dm_coder *c, int64_t valence, const dm_valence_model *model, int64_t mixer);
int64_t dm_seed_contexts(dm_valence_model *model);
int64_t dm_gate_contexts(const dm_front *front, int64_t pivot, const dm_new_vertex *vertices,
                         dm_valence_model *model);
int dm_code_join_flag(dm_coder *c, const dm_front *front, int64_t pivot, int is_join);
int dm_code_loop_flag(dm_coder *c, int is_loop);
int64_t dm_code_target(dm_coder *c, const dm_front *front, int64_t pivot, int64_t target);
int64_t dm_code_side(dm_coder *c, int64_t free, int64_t side);

#endif
