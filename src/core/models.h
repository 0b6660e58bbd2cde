/* Models: the slots of each context as named ranges, one after the other, and the mixers. */
#ifndef DELTAMESH_MODELS_H
#define DELTAMESH_MODELS_H

#include "deltamesh_core.h"

/* A list of ranges is a macro LIST(R) of R(NAME, size); these make of it enumerators, the first
   slot of each range, and rows of the table that tests compare with the format. */
#define DM_RANGE(name, size) name, name##_LAST = name + (size)-1,
#define DM_RANGE_ROW(name, size) {#name, name},

#define DM_COUNT(array) ((int64_t)(sizeof(array) / sizeof((array)[0])))

/* Whether a coder has the memory of a model. */
static inline int dm_has_memory(const dm_coder *c, int64_t slots, int64_t mixers)
{
    return c->slot_count >= slots && c->mixer_count >= mixers;
}

#endif
