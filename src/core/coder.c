/* Range coder with mixing: its beginning and its end; see `coder.h`. */
#include "coder.h"

#include <stddef.h>

/* Store a byte; never past the end of the buffer, though no model writes that much. */
static void put_byte(dm_coder *c, uint64_t byte)
{
    const int64_t at = c->position++;
    if (at >= 0 && at < c->size)
        c->data[at] = (uint8_t)(byte & 0xFF);
}

void dm_shift_low(dm_coder *c)
{
    if (c->low < 0xFF000000u || c->low > DM_MASK32) {
        const uint64_t carry = c->low >> 32;
        put_byte(c, c->cache + carry);
        for (; c->pending > 0; c->pending--)
            put_byte(c, 0xFF + carry);
        c->cache = c->low >> 24 & 0xFF;
    } else {
        c->pending++;
    }
    c->low = c->low << 8 & DM_MASK32;
}

/* The number in [low, low + span) that ends in the most zero bytes; span >= DM_TOP. */
static uint64_t roundest(uint64_t low, uint64_t span)
{
    const uint64_t rounded = (low + DM_MASK32) & ~DM_MASK32;
    return rounded < low + span ? rounded : (low + DM_TOP - 1) & ~(DM_TOP - 1);
}

/* Small files learn faster from a mixer whose weights sum up to a little more than 1, as its inputs
   are all too careful at first, than from one that starts at zero. A single input has weight 1. */
static int64_t first_weight(int64_t inputs)
{
    return inputs == 1 ? 65536 : (2 * 65536 * 6 + 5 * inputs) / (10 * inputs); /* of a sum of 1.2 */
}

int dm_start(dm_coder *c, uint32_t *slots, int64_t slot_count, dm_mixer *mixers,
             int64_t mixer_count, const dm_mixers *kinds, int64_t kinds_count, uint8_t *data,
             int64_t size, int64_t decoding)
{
    *c = (dm_coder){.range = DM_MASK32, .decoding = decoding != 0};
    c->slots = slots, c->slot_count = slot_count;
    c->mixers = mixers, c->mixer_count = mixer_count;
    c->data = data, c->size = size;
    for (int64_t i = 0; i < slot_count; i++)
        slots[i] = (uint32_t)1 << (DM_PROBABILITY_BITS - 1 + DM_COUNT_BITS); /* one half */
    int64_t at = 0;
    for (int64_t k = 0; k < kinds_count; k++) {
        const int32_t inputs = kinds[k].inputs, limit = kinds[k].limit;
        if (inputs < 1 || inputs > DM_MAX_INPUTS || limit < 1 || limit > DM_COUNT_MASK)
            return DM_INVALID;
        for (int32_t i = 0; i < kinds[k].count; i++) {
            if (at == mixer_count)
                return DM_INVALID;
            dm_mixer *const m = &mixers[at++];
            for (int j = 0; j < DM_MAX_INPUTS; j++)
                m->weights[j] = first_weight(inputs);
            m->inputs = inputs, m->limit = limit, m->youth = DM_YOUTH, m->unused = 0;
        }
    }
    if (at != mixer_count)
        return DM_INVALID;
    if (decoding)
        for (int i = 0; i < 4; i++)
            c->code = c->code << 8 | dm_next_byte(c);
    else
        c->position = -1; /* the first byte that leaves `low` is always zero: it is not stored */
    return DM_OK;
}

/* Flush, with as many zero bytes at the end as can be, leave these out, return the length. */
int64_t dm_finish(dm_coder *c)
{
    c->low = roundest(c->low, c->range);
    for (int i = 0; i < 5; i++)
        dm_shift_low(c);
    int64_t length = c->position;
    while (length > 0 && length <= c->size && c->data[length - 1] == 0)
        length--;
    return length;
}

/* Whether a decoder has come to where the encoder stopped, with nothing left over.

   The decoder keeps `low` too, but for carries, so that a stream has one form only. */
int dm_is_finished(const dm_coder *c)
{
    const uint64_t low = c->low & DM_MASK32;
    return c->code == roundest(low, c->range) - low;
}

int dm_raw(dm_coder *c, int64_t value, int64_t bits, int64_t *coded)
{
    if (bits < 0 || bits > 63)
        return DM_INVALID;
    *coded = dm_code_raw(c, value, bits);
    return DM_OK;
}

int dm_bit(dm_coder *c, int64_t bit, int64_t mixer, const int64_t *slots, int64_t count,
           int64_t *coded)
{
    if (mixer < 0 || mixer >= c->mixer_count || count != c->mixers[mixer].inputs)
        return DM_INVALID;
    for (int64_t i = 0; i < count; i++)
        if (slots[i] < 0 || slots[i] >= c->slot_count)
            return DM_INVALID;
    *coded = dm_code_bit(c, bit, mixer, slots);
    return DM_OK;
}
