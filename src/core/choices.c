/* Sequences of different numbers, most of which are the next one left. */
#include "choices.h"

#include "coder.h"
#include "remaining.h"

/* Code `length` different numbers below `count`, filled in when decoding; at most so many.

   A number that is the next one left has to be coded so. `sums`, `onwards` (count + 1,) are scratch.
 */
int dm_code_choices(dm_coder *c, int64_t *numbers, int64_t length, int64_t count, int64_t *sums,
                    int64_t *onwards)
{
    if (!dm_has_memory(c, CHOICES_SLOTS, 1) || length > count)
        return DM_INVALID;
    dm_all_of(count, sums, onwards);
    dm_remaining left = {count, sums, onwards};
    int64_t previous = -1, history = 0;
    for (int64_t i = 0; i < length; i++) {
        const int64_t following = dm_first_left(&left, previous + 1);
        int64_t number = numbers[i];
        if (!c->decoding && (number < 0 || number >= count || onwards[number] != number))
            return DM_INVALID;
        const int64_t at = CHOICES_BY_HISTORY + history;
        const int64_t bit = dm_code_bit(c, number == following, 0, &at);
        if (bit) {
            number = following;
        } else {
            const int64_t rank = c->decoding ? 0 : dm_left_below(&left, number);
            number = dm_of_rank(&left, dm_code_below(c, rank, count - i));
            if (number == following)
                return DM_CORRUPT;
        }
        dm_take_away(&left, number);
        numbers[i] = previous = number;
        history = (2 * history + bit) % 8;
    }
    return DM_OK;
}
