/* Steps over a mesh; see `steps.h`. */
#include "steps.h"

enum { REACH = 12 };

/* The best trail to code an anchor from, -1 where a number below `left` takes less. */
int64_t dm_trail_of(const dm_steps *s, int64_t anchor, int64_t left, int64_t margin)
{
    int64_t best = -1, least = dm_bits(left) - margin;
    for (int64_t k = 0; k < DM_TRAILS; k++) {
        const int64_t bits = dm_bits(dm_size(anchor - s->trails[k].anchor));
        const int64_t cost = 3 * bits / 2 + (k == 0 ? 3 : 7);
        if (cost < least)
            best = k, least = cost;
    }
    return best;
}

/* Bring the trail that comes by an anchor to the front; without one, the last begins anew. */
void dm_follow(dm_steps *s, int64_t anchor)
{
    int64_t k = 0;
    while (k < DM_TRAILS - 1 && dm_size(anchor - s->trails[k].anchor) > REACH)
        k++;
    dm_trail trail = {anchor, anchor - s->trails[k].anchor, s->trails[k].distance};
    if (dm_size(trail.distance) > REACH)
        trail.distance = trail.before = 0;
    for (; k > 0; k--)
        s->trails[k] = s->trails[k - 1];
    s->trails[0] = trail;
}

/* Code the kind of a step; `follows`, below 4, relates the next element left to the last. */
int64_t dm_code_step(dm_coder *c, int64_t step, dm_steps *s, int64_t follows, int has_anchor)
{
    const int64_t far = dm_level(dm_size(s->trails[0].distance)) / 2, asked = has_anchor ? 2 : 1;
    int64_t kind = DM_STEP_ANY;
    for (int64_t k = 0; k < asked; k++) {
        const int64_t base = STEP + k * DM_STEP_INPUTS * DM_STEP_SIZE;
        const int64_t at[] = {
            base + s->history,
            base + DM_STEP_SIZE + 4 * (s->history % 9) + follows,
            base + 2 * DM_STEP_SIZE + 16 * (s->history % 3) + far,
        };
        if (dm_code_bit(c, step == k, DM_STEP_MIXER + k, at)) {
            kind = k;
            break;
        }
    }
    s->history = s->history % 27 * 3 + kind;
    return kind;
}

/* Code the rank of an anchor: a trail, and the distance from there. */
int64_t dm_code_anchor(dm_coder *c, int64_t anchor, int64_t trail, dm_steps *s)
{
    int64_t node = 1;
    for (int64_t shift = DM_TRAIL_BITS - 1; shift >= 0; shift--) {
        const int64_t at[] = {
            TRACK + DM_TRAILS * s->trail + node,
            TRACK + DM_TRACK_SIZE + DM_TRAILS * (s->history / 3 % 9) + node,
        };
        node = 2 * node + dm_code_bit(c, trail >> shift & 1, DM_TRACK_MIXER, at);
    }
    s->trail = node - DM_TRAILS;
    const dm_trail *const from = &s->trails[s->trail];
    const int64_t first = from->distance, second = from->before;
    const dm_known known = {
        .sum = {first + second},
        .absolute = {dm_size(first) + dm_size(second)},
        .last = {first},
        .hint = {dm_size(second)},
        .neighbours = 2,
        .kind = dm_min(s->trail, 3),
    };
    int64_t distance = anchor - from->anchor;
    dm_code_vector(c, &distance, 1, &known);
    return from->anchor + distance;
}
