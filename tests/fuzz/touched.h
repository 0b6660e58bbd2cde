/* Included before every source of the core. Each slot of a coder that a bit is about to change for
   the first time is noted, so that the next stream finds megabytes of slots as new without writing
   them all anew; and bits are counted, so that an execution ends where there are too many. What a
   kernel reads and writes stays as it is. */
#ifndef DELTAMESH_FUZZ_TOUCHED_H
#define DELTAMESH_FUZZ_TOUCHED_H

#include "coder.h"

#define FRESH_SLOT ((uint32_t)1 << (DM_PROBABILITY_BITS - 1 + DM_COUNT_BITS))

/* Models of fewer slots are written anew for each stream. */
enum { FEW_SLOTS = 1 << 16 };

void note_touched(uint32_t *slot);
void count_bit(void);

static inline int64_t code_noted_bit(dm_coder *c, int64_t bit, int64_t mixer, const int64_t *at)
{
    count_bit();
    if (c->slot_count > FEW_SLOTS)
        for (int32_t i = 0; i < c->mixers[mixer].inputs; i++)
            if (c->slots[at[i]] == FRESH_SLOT)
                note_touched(&c->slots[at[i]]);
    return dm_code_bit(c, bit, mixer, at);
}

#ifndef NOTES_NOTHING
#define dm_code_bit(c, bit, mixer, at) code_noted_bit(c, bit, mixer, at)
#endif

#endif
