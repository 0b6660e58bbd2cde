/* Valences, joins and the ends of joins; see `valence.h`. */
#include "valence.h"

/* A valence is coded along a tree: is it 6; is it less; is it 5, 4, 3; is it 7, 8, ... 18. Above that
   come the bits of v - 18. Part of the format, as is all below. */
enum { NODE_SIX, NODE_LESS, NODE_BELOW, NODE_ABOVE = NODE_BELOW + 3, UNARY_END = 18 };

enum {
    NEAR_BITS = 5,
    NEAR = 1 << (NEAR_BITS - 1), /* a join is addressed along the front that far, then anywhere */
    MAX_BITS = 40,               /* of a number: counts are below 2^40 */
};

/* A slot that expects a one with a probability in percent, as if it had seen `count` bits. */
static uint32_t expecting(uint32_t percent, uint32_t count)
{
    const uint64_t one = (uint64_t)1 << DM_PROBABILITY_BITS;
    return (uint32_t)(percent * one / 100) << DM_COUNT_BITS | count;
}

/* Set the first slots as they begin; small meshes gain 2 %.

   Those of the tree are the shares of its nodes in the valences of irregular meshes. */
void dm_set_prior(dm_coder *c)
{
    static const uint8_t SHARES[DM_TREE] = {35, 55, 68, 80, 95, 62, 55, 55, 55,
                                            55, 55, 55, 55, 55, 55, 55, 55, 50};
    for (int64_t tree = 0; tree < CONTEXTS; tree++)
        for (int64_t node = 0; node < DM_TREE; node++)
            c->slots[VALENCE_TREE + tree * DM_TREE + node] = expecting(SHARES[node], 1);
    for (int64_t k = JOIN_FLAG; k <= JOIN_FLAG_LAST; k++)
        c->slots[k] = expecting(1, 2);
}

/* Code a number >= 1 of one of the rarer kinds. */
int64_t dm_code_count(dm_coder *c, int64_t value, int64_t kind)
{
    return dm_code_number(c, value, NUMBER + kind * DM_NUMBER_SLOTS, DM_LENGTH_MIXER, MAX_BITS);
}

static int ask(dm_coder *c, const dm_valence_model *model, int64_t node, int64_t mixer, int answer)
{
    int64_t at[DM_VALENCE_INPUTS];
    for (int i = 0; i < DM_VALENCE_INPUTS; i++)
        at[i] = model->trees[i] + node;
    return dm_code_bit(c, answer, mixer + node, at) == 1;
}

/* Code a valence >= 2 with one tree for each context. */
int64_t dm_code_valence(dm_coder *c, int64_t valence, const dm_valence_model *model, int64_t mixer)
{
    if (ask(c, model, NODE_SIX, mixer, valence == 6))
        return 6;
    if (ask(c, model, NODE_LESS, mixer, valence < 6)) {
        for (int64_t k = 0; k < 3; k++)
            if (ask(c, model, NODE_BELOW + k, mixer, valence == 5 - k))
                return 5 - k;
        return 2;
    }
    for (int64_t k = 7; k <= UNARY_END; k++)
        if (ask(c, model, NODE_ABOVE + k - 7, mixer, valence == k))
            return k;
    return UNARY_END + dm_code_count(c, valence - UNARY_END, DM_OF_VALENCE);
}

/* Set the contexts of the vertices of a first face: none is known; return the mixer. */
int64_t dm_seed_contexts(dm_valence_model *model)
{
    for (int i = 0; i < DM_VALENCE_INPUTS; i++)
        model->trees[i] = 0;
    return 0;
}

static int64_t three_bits(int64_t valence) { return dm_clamp(valence - 3, 0, 7); }

/* Set the contexts of a vertex that is new at the gate of a pivot; return the mixer. */
int64_t dm_gate_contexts(const dm_front *front, int64_t pivot, const dm_new_vertex *vertices,
                         dm_valence_model *model)
{
    const dm_node *const at = &front->nodes[pivot];
    const dm_node *const after = &front->nodes[at->successor];
    const dm_node *const before = &front->nodes[at->predecessor];
    const int64_t at_pivot = dm_min(vertices[at->vertex].valence, DM_VALENCE_CAP);
    const int64_t at_after = dm_min(vertices[after->vertex].valence, DM_VALENCE_CAP);
    const int64_t at_before = dm_min(vertices[before->vertex].valence, DM_VALENCE_CAP);
    const int64_t behind = dm_min(vertices[at->behind].valence, DM_VALENCE_CAP);
    const int64_t free = dm_min(at->free, 7);
    const int64_t free_after = dm_min(after->free, 7), free_before = dm_min(before->free, 7);
    const int64_t closes = free == 1; /* the new vertex will be a neighbour of `before`, too */
    const int64_t pair =
        closes ? at_before * 16 + at_after : 256 + at_after * 16 + model->recent[0];
    const int64_t face =
        three_bits(at_after) * 64 + three_bits(at_pivot) * 8 + three_bits(behind);
    const int64_t total = dm_clamp(at_pivot + at_after + at_before + behind - 16, 0, 31);
    model->trees[0] = 0;
    model->trees[1] = DM_TREE * (PAIR + at_pivot * 16 + at_after);
    model->trees[2] = DM_TREE * (FREE + free * 64 + free_after * 8 + free_before);
    model->trees[3] = DM_TREE * (BEHIND + at_after * 16 + behind);
    model->trees[4] = DM_TREE * (LAST_TWO + model->recent[0] * 16 + model->recent[1]);
    model->trees[5] = DM_TREE * (NEAR_PAIR + pair);
    model->trees[6] = DM_TREE * (FACE + face + 512 * closes);
    model->trees[7] = DM_TREE * (TOTAL + 2 * total + closes);
    return DM_TREE * closes;
}

/* The free edges beyond the first, at most 3; on a crafted front there may be none. */
static int64_t two_bits(const dm_front *front, int64_t node)
{
    return dm_clamp(front->nodes[node].free - 1, 0, 3);
}

/* Code whether the vertex at the gate is on a front already. */
int dm_code_join_flag(dm_coder *c, const dm_front *front, int64_t pivot, int is_join)
{
    const dm_node *const nodes = front->nodes;
    const int64_t a1 = nodes[pivot].successor, b1 = nodes[pivot].predecessor;
    const int64_t a2 = nodes[a1].successor, b2 = nodes[b1].predecessor;
    const int64_t a3 = nodes[a2].successor, b3 = nodes[b2].predecessor;
    const int64_t ahead = two_bits(front, a1) * 16 + two_bits(front, a2) * 4;
    const int64_t back = two_bits(front, pivot) * 16 + two_bits(front, b1) * 4;
    const int64_t at[] = {
        JOIN_FLAG + ahead + two_bits(front, a3),
        JOIN_FLAG + DM_JOIN_CONTEXT + back + two_bits(front, b2),
        JOIN_FLAG + 2 * DM_JOIN_CONTEXT + ahead + two_bits(front, b3),
    };
    return dm_code_bit(c, is_join ? 1 : 0, DM_JOIN_MIXER, at) == 1;
}

/* Code whether a new vertex is one that closes a boundary loop. */
int dm_code_loop_flag(dm_coder *c, int is_loop)
{
    const int64_t at = LOOP_FLAG;
    return dm_code_bit(c, is_loop ? 1 : 0, DM_LOOP_MIXER, &at) == 1;
}

/* Code a number of that many bits, the high bit first, each in the context of those before. */
static int64_t code_tree(dm_coder *c, int64_t value, int64_t bits, int64_t first, int64_t mixer)
{
    int64_t node = 1;
    for (int64_t shift = bits - 1; shift >= 0; shift--) {
        const int64_t at = first + node;
        node = 2 * node + dm_code_bit(c, value >> shift & 1, mixer, &at);
    }
    return node - ((int64_t)1 << bits);
}

/* Code the node that a join goes to; a decoder may read one that does not fit. */
int64_t dm_code_target(dm_coder *c, const dm_front *front, int64_t pivot, int64_t target)
{
    const dm_node *const nodes = front->nodes;
    int64_t near = -1, ahead = nodes[pivot].successor, back = pivot;
    const int64_t first = ahead;
    if (!c->decoding) {
        for (int64_t k = 0; k < NEAR; k++) {
            ahead = nodes[ahead].successor, back = nodes[back].predecessor;
            if (ahead == target || back == target) {
                near = 2 * k + (ahead == target ? 0 : 1);
                break;
            }
        }
    }
    const int64_t at = NEAR_FLAG;
    if (!dm_code_bit(c, near >= 0, DM_NEAR_MIXER, &at))
        return front->live[dm_code_below(c, nodes[dm_max(target, 0)].index, front->live_count)];
    near = code_tree(c, near, NEAR_BITS, NEAR_TREE, DM_TARGET_MIXER);
    int64_t node = near & 1 ? pivot : first;
    for (int64_t k = 0; k <= near >> 1; k++)
        node = near & 1 ? nodes[node].predecessor : nodes[node].successor;
    return node;
}

/* Code how many of the free edges of a node that splits stay on the pivot's front. */
int64_t dm_code_side(dm_coder *c, int64_t free, int64_t side)
{
    if (free >= 8)
        return dm_code_count(c, side + 1, DM_OF_SIDE) - 1;
    if (free == 0)
        return 0;
    return code_tree(c, side, 3, SIDE_TREE + 8 * free, DM_SIDE_MIXER);
}

int dm_below(dm_coder *c, int64_t value, int64_t bound, int64_t *coded)
{
    if (bound < 1 || bound > (int64_t)1 << 61 || (!c->decoding && (value < 0 || value >= bound)))
        return DM_INVALID;
    *coded = dm_code_below(c, value, bound);
    return DM_OK;
}
