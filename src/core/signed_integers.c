/* Signed integers in bits that several contexts predict; see `signed_integers.h`. */
#include "signed_integers.h"

/* Contexts of each kind of bit have 16 numbers, those of the candidates the last 8 of them. */
enum { LENGTH = 0, SIGN = 16, MANTISSA = 32, MATCHES = 8 };

/* Bits of a mantissa that see each other and the caller's first context. */
enum { MODELLED = 3 };

/* Code the length in unary; candidates say whether they are shorter. */
static int64_t code_length(dm_coder *c, int64_t length, int64_t axis, const int64_t *contexts,
                           int64_t many, const dm_candidates *candidates, int64_t mixer)
{
    int64_t slots[DM_MAX_INPUTS], at[DM_MAX_INPUTS], others[DM_MAX_INPUTS], k = 0;
    for (int64_t i = 0; i < many; i++)
        slots[i] = dm_hashed(LENGTH + i, axis, contexts[i]);
    for (int64_t i = 0; i < candidates->count; i++)
        others[i] = dm_bits(dm_size(candidates->numbers[i]));
    while (k < DM_LENGTHS - 1) {
        for (int64_t i = 0; i < many; i++)
            at[i] = (slots[i] + k) & (DM_HASH_SLOTS - 1);
        for (int64_t i = 0; i < candidates->count; i++) {
            const int64_t side = others[i] < k ? 0 : (others[i] == k ? 1 : 2);
            const int64_t match = (candidates->histories[i] * 3 + side) * DM_LENGTHS + k;
            at[many + i] = dm_hashed(LENGTH + MATCHES + i, axis, match);
        }
        if (!dm_code_bit(c, length > k, mixer + k, at))
            break;
        k++;
    }
    return k;
}

static int64_t code_sign(dm_coder *c, int64_t negative, int64_t length, int64_t axis,
                         const int64_t *contexts, int64_t many, const dm_candidates *candidates,
                         int64_t mixer)
{
    int64_t at[DM_MAX_INPUTS];
    for (int64_t i = 0; i < many; i++)
        at[i] = dm_hashed(SIGN + i, axis, contexts[i]);
    for (int64_t i = 0; i < candidates->count; i++) {
        const int64_t other = candidates->numbers[i];
        const int agrees = dm_bits(dm_size(other)) == length;
        const int64_t expected = agrees ? (other < 0 ? 2 : 1) : 0;
        at[many + i] = dm_hashed(SIGN + MATCHES + i, axis, candidates->histories[i] * 3 + expected);
    }
    return dm_code_bit(c, negative, mixer, at);
}

/* Code the bits of a magnitude below its highest, the high ones first. */
static int64_t code_mantissa(dm_coder *c, int64_t magnitude, int64_t length, int64_t negative,
                             int64_t axis, int64_t context, const dm_candidates *candidates,
                             int64_t mixer)
{
    int64_t at[DM_MAX_INPUTS], result = 1; /* the bits so far */
    for (int64_t j = 0; j < length - 1; j++) {
        const int64_t shift = length - 2 - j;
        const int64_t node = length * 8 + (j < MODELLED ? result : 0);
        const int64_t near = j < MODELLED ? context : 0;
        const int64_t place = node * DM_LENGTHS + j;
        at[0] = dm_hashed(MANTISSA, axis, place);
        at[1] = dm_hashed(MANTISSA + 1, axis, dm_add(place * 1024, near));
        at[2] = dm_hashed(MANTISSA + 2, axis, (result * DM_LENGTHS + length) * 2 + negative);
        for (int64_t i = 0; i < candidates->count; i++) {
            const int64_t number = candidates->numbers[i], other = dm_size(number);
            const int agrees = (number < 0) == (negative == 1) && other >> (shift + 1) == result;
            const int64_t expected = agrees ? 1 + (other >> shift & 1) : 0;
            const int64_t match = (candidates->histories[i] * 4 + dm_min(j, 3)) * 3 + expected;
            at[DM_MANTISSAS + i] = dm_hashed(MANTISSA + MATCHES + i, axis, match);
        }
        result = 2 * result + dm_code_bit(c, magnitude >> shift & 1, mixer + j, at);
    }
    return result;
}

int64_t dm_code_signed(dm_coder *c, int64_t value, int64_t axis, const int64_t *lengths,
                       int64_t length_count, const int64_t *signs, int64_t sign_count,
                       const dm_candidates *candidates)
{
    const int64_t mixer = axis * DM_AXIS_MIXERS, size = dm_size(value);
    const int64_t length =
        code_length(c, dm_bits(size), axis, lengths, length_count, candidates, mixer);
    if (length == 0)
        return 0;
    const int64_t negative = code_sign(c, value < 0, length, axis, signs, sign_count, candidates,
                                       mixer + 2 * DM_LENGTHS);
    const int64_t magnitude = code_mantissa(c, size, length, negative, axis, lengths[0], candidates,
                                            mixer + DM_LENGTHS);
    return negative ? -magnitude : magnitude;
}

int64_t dm_level_of(int64_t x) { return dm_level(x); }

int64_t dm_slot_of(int64_t number, int64_t axis, int64_t context)
{
    return dm_hashed(number, axis, context);
}

int dm_signed(dm_coder *c, int64_t value, int64_t axis, const int64_t *lengths,
              int64_t length_count, const int64_t *signs, int64_t sign_count,
              const int64_t *candidates, const int64_t *histories, int64_t candidate_count,
              int64_t *coded)
{
    const int64_t mixer = axis * DM_AXIS_MIXERS;
    if (axis < 0 || axis > 2 ||
        !dm_has_memory(c, DM_HASH_SLOTS, (axis + 1) * DM_AXIS_MIXERS) || length_count < 1 ||
        c->mixers[mixer].inputs != length_count + candidate_count ||
        c->mixers[mixer + DM_LENGTHS].inputs != DM_MANTISSAS + candidate_count ||
        c->mixers[mixer + 2 * DM_LENGTHS].inputs != sign_count + candidate_count)
        return DM_INVALID;
    const dm_candidates others = {candidates, histories, candidate_count};
    *coded =
        dm_code_signed(c, value, axis, lengths, length_count, signs, sign_count, &others);
    return DM_OK;
}
