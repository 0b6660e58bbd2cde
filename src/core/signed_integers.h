/* Signed integers in bits that several contexts predict.

   A number is the length of |v| in unary, the sign, the bits below the highest: an Exp-Golomb code
   (Teuhola, "A compression method for clustered bit-vectors", 1978) of which each bit has adaptive
   probabilities, as in CABAC (Marpe, Schwarz, Wiegand, 2003), here mixed from several contexts:

   - those of the caller: levels of the magnitudes around, signs around;
   - the number so far. Where numbers repeat, as in models of machine parts, all their bits are
     learnt; where the low bits are noise, such a context stays near one half, and so weighs
     nothing;
   - candidates, numbers that this one may equal. As long as its bits agree with a candidate, that
     predicts the next one, the better the more often it was right recently: the match model of
     Mahoney, "Adaptive weighing of context models for lossless data compression", 2005.

   Contexts are hashed into one table: a collision costs bits, nothing else. */
#ifndef DELTAMESH_SIGNED_INTEGERS_H
#define DELTAMESH_SIGNED_INTEGERS_H

#include "coder.h"

enum {
    DM_LENGTHS = 32, /* |v| < 2^31: checked before a value reaches the coder */
    DM_LEVELS = 32,
    DM_HASH_LIMIT = 255, /* of the counts: best on the mean from 127, 255, 500, 1000 */
    DM_HASH_SLOTS = 1 << 20, /* 2^18 cost 0.1 % more bytes, 2^22 save none */
    DM_MANTISSAS = 3, /* contexts of a mantissa, beside the candidates */
    /* Mixers of one axis: one for each bit of the length, each of the mantissa, the sign. */
    DM_AXIS_MIXERS = 2 * DM_LENGTHS + 1,
};

/* Mixers of numbers of one axis with so many contexts and candidates. */
#define DM_MIXERS_OF_AXIS(lengths, signs, candidates)                                              \
    {DM_LENGTHS, (lengths) + (candidates), DM_HASH_LIMIT},                                         \
        {DM_LENGTHS, DM_MANTISSAS + (candidates), DM_HASH_LIMIT},                                  \
    {                                                                                              \
        1, (signs) + (candidates), DM_HASH_LIMIT                                                   \
    }

/* Two levels an octave: 0 for 0, 1 for 1, 3, 4 for 2, 3, then 5 and 6 for 4 to 7. */
static inline int64_t dm_level(int64_t x)
{
    if (x <= 0)
        return 0;
    const int64_t n = dm_bits(x) - 1;
    const int64_t half = n > 0 ? x >> (n - 1) & 1 : 0;
    return dm_min(1 + 2 * n + half, DM_LEVELS - 1);
}

/* The slot of a context, of that number and axis; products are modulo 2^32. */
static inline int64_t dm_hashed(int64_t number, int64_t axis, int64_t context)
{
    uint32_t h = (uint32_t)(4 * number + axis) * 0x9E3779B1u +
                 (uint32_t)((uint64_t)context & 0x7FFFFFFF) * 0x85EBCA6Bu;
    h ^= h >> 15;
    h *= 0x2C1B3C6Du;
    h ^= h >> 13;
    return h & (DM_HASH_SLOTS - 1);
}

/* Numbers that a number may be, and how each of them has fared, from 0 to 31. */
typedef struct {
    const int64_t *numbers, *histories;
    int64_t count;
} dm_candidates;

/* Code a number, |value| < 2^31, or return the one that was read.

   `axis`, 0 to 2, selects a model. Contexts of the length and of the sign are below 2^31; with the
   candidates there are at most DM_MAX_INPUTS of each. */
int64_t dm_code_signed(dm_coder *c, int64_t value, int64_t axis, const int64_t *lengths,
                       int64_t length_count, const int64_t *signs, int64_t sign_count,
                       const dm_candidates *candidates);

#endif
