/* Adaptive binary range coder whose probabilities are mixed from several contexts.

   The arithmetic coder is the carry-propagating range coder of LZMA (Martin, "Range encoding: an
   algorithm for removing redundancy from a digitised message", 1979; Pavlov, LZMA specification).
   A bit is predicted by several adaptive probabilities, one a context, which a gated linear mixer
   joins in the logistic domain (Mahoney, "Adaptive weighing of context models for lossless data
   compression", 2005, section 3). Everything is an integer: encoder and decoder cannot drift apart.

   One function serves both directions: it returns the bit that it was given (encoding) or the bit
   that it has read (decoding), so that a model is written down once for both. */
#ifndef DELTAMESH_CODER_H
#define DELTAMESH_CODER_H

#include "deltamesh_core.h"
#include "integers.h"
#include "models.h"

#define DM_TOP ((uint64_t)1 << 24) /* the range stays at or above it, and keeps 8 bits above 2^16 */
#define DM_MASK32 (((uint64_t)1 << 32) - 1)

enum {
    DM_PROBABILITY_BITS = 22, /* of a slot; 10 bits below it count the observations */
    DM_COUNT_BITS = 10,
    DM_COUNT_MASK = (1 << DM_COUNT_BITS) - 1,
    DM_YOUTH = 300, /* then a mixer learns half as fast: 0.2 % smaller than either speed alone */
};

static inline uint64_t dm_next_byte(dm_coder *c)
{
    const int64_t at = c->position++;
    return at < c->size ? c->data[at] : 0; /* the encoder leaves trailing zeros out */
}

/* Move the top byte of `low` out, holding back bytes that a carry may still change. */
void dm_shift_low(dm_coder *c);

/* Code one bit whose probability of being one is p / 65536. */
static inline int64_t dm_code_with(dm_coder *c, int64_t bit, uint64_t p)
{
    const uint64_t bound = (c->range >> 16) * p;
    if (c->decoding) {
        bit = c->code < bound;
        if (!bit)
            c->code -= bound;
    }
    if (!bit)
        c->low += bound;
    c->range = bit ? bound : c->range - bound;
    while (c->range < DM_TOP) {
        c->range <<= 8;
        if (c->decoding) {
            /* Four bytes of 0xFF at the beginning are beyond the range: all bits are zeros then,
               and the code, which no end of a stream equals, stays beyond. */
            const uint64_t byte = dm_next_byte(c);
            c->code = c->code >> 55 ? c->code : c->code << 8 | byte;
            c->low = c->low << 8 & DM_MASK32;
        } else {
            dm_shift_low(c);
        }
    }
    return bit;
}

/* Code a number of up to 63 bits, all equally likely, the high bit first. */
static inline int64_t dm_code_raw(dm_coder *c, int64_t value, int64_t bits)
{
    uint64_t result = 0;
    for (int64_t shift = bits - 1; shift >= 0; shift--)
        result = result << 1 | (uint64_t)dm_code_with(c, value >> shift & 1, 32768);
    return (int64_t)result;
}

/* Code one bit, predicted by the slots `at`, as many as the mixer has inputs, and learn from it. */
static inline int64_t dm_code_bit(dm_coder *c, int64_t bit, int64_t mixer, const int64_t *at)
{
    dm_mixer *const m = &c->mixers[mixer];
    uint32_t *const slots = c->slots;
    const int32_t inputs = m->inputs;
    int64_t stretched[DM_MAX_INPUTS], dot = 0;
    for (int32_t i = 0; i < inputs; i++) {
        stretched[i] = dm_stretch[slots[at[i]] >> (DM_PROBABILITY_BITS - 12 + DM_COUNT_BITS)];
        dot += m->weights[i] * stretched[i];
    }
    const int64_t p = dm_squash[dm_clamp(dot >> 16, -2047, 2047) + 2048];
    bit = dm_code_with(c, bit, (uint64_t)p);
    const int64_t error = (bit << 16) - p;
    const int32_t young = m->youth > 0;
    m->youth -= young;
    const int shift = young ? 14 : 15;
    const uint32_t limit = (uint32_t)m->limit;
    for (int32_t i = 0; i < inputs; i++) {
        m->weights[i] += (stretched[i] * error + ((int64_t)1 << (shift - 1))) >> shift;
        const uint32_t slot = slots[at[i]], count = slot & DM_COUNT_MASK;
        int64_t probability = slot >> DM_COUNT_BITS;
        probability += (((bit << DM_PROBABILITY_BITS) - probability) * dm_rate[count]) >> 16;
        slots[at[i]] =
            (uint32_t)probability << DM_COUNT_BITS | (count + 1 < limit ? count + 1 : limit);
    }
    return bit;
}

/* Code a number >= 1: its length in adaptive unary, then its bits below the highest.

   The unary has a slot for each of at most `most` bits, from `first` on, and one mixer. */
static inline int64_t dm_code_number(dm_coder *c, int64_t value, int64_t first, int64_t mixer,
                                     int64_t most)
{
    const int64_t bits = dm_max(dm_bits(value) - 1, 0);
    int64_t k = 0;
    while (k < most) {
        const int64_t at = first + k;
        if (!dm_code_bit(c, bits > k, mixer, &at))
            break;
        k++;
    }
    const uint64_t top = (uint64_t)1 << k;
    return (int64_t)(top | (uint64_t)dm_code_raw(c, (int64_t)((uint64_t)value & (top - 1)), k));
}

/* Code a number in [0, bound), all equally likely, in the fewest bits or one more; bound >= 1. */
static inline int64_t dm_code_below(dm_coder *c, int64_t value, int64_t bound)
{
    const int64_t bits = dm_max(dm_bits(bound) - 1, 0);
    const int64_t few = dm_subtract((int64_t)((uint64_t)2 << bits), bound); /* with `bits` bits */
    if (c->decoding) {
        const int64_t result = dm_code_raw(c, 0, bits);
        return result < few ? result : 2 * result + dm_code_raw(c, 0, 1) - few;
    }
    dm_code_raw(c, value < few ? value : value + few, value < few ? bits : bits + 1);
    return value;
}

#endif
