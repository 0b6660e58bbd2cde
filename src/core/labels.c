/* Labels of elements: most equal that of a neighbour, or continue as labels did before.

   The labels of the known neighbours are candidates, the one that most of them have first; then the
   label of the element before; then what followed the last time that the labels were as they are
   now, the match model of Mahoney ("Adaptive weighing of context models for lossless data
   compression", 2005); then the labels ahead, those of the known neighbours of unknown ones. A bit
   for each candidate says whether it is the label. Another label is new, which is the next number,
   or its number is coded from the low bit up, without the bits that would lead beyond the labels:
   no stream can name a label that does not exist. */
#include "labels.h"

#include "graphs.h"
#include "signed_integers.h"

enum {
    NEIGHBOURS = 8, /* that are looked at, the latest ones */
    AHEAD = 16,     /* labels ahead that are looked at, the first ones */
    CANDIDATES = NEIGHBOURS + AHEAD + 2,
    LONGEST = 15, /* of a match, as a context */
};

/* Contexts are hashed by these numbers and those that follow them, as many as inputs. */
enum { CANDIDATE = 0, NEW = 8, DIGIT = 12, FOLLOWER = 16 };

typedef struct {
    const int32_t *indptr, *indices;
    int64_t *labels;
} labelled;

/* What the labels around an element, and those before it, say. */
typedef struct {
    int64_t candidates[CANDIDATES], votes[CANDIDATES], ahead[AHEAD];
    int64_t found, known, front; /* candidates, neighbours that have voted, labels ahead */
    int64_t match, length, fared, expected, hits, news, seen;
} surroundings;

/* One context of two; products wrap around. */
static int64_t joined(int64_t a, int64_t b) { return dm_add(dm_times(a, 0x2C1B3C6D), b); }

static int64_t slot(int64_t number, int64_t context)
{
    return dm_hashed(number, 0, context) & (DM_LABEL_SLOTS - 1);
}

/* Move candidate k up past those with fewer votes. */
static void rise(surroundings *s, int64_t k)
{
    for (; k > 0 && s->votes[k - 1] < s->votes[k]; k--) {
        const int64_t candidate = s->candidates[k], votes = s->votes[k];
        s->candidates[k] = s->candidates[k - 1], s->votes[k] = s->votes[k - 1];
        s->candidates[k - 1] = candidate, s->votes[k - 1] = votes;
    }
}

/* Order the labels of the latest known neighbours by votes; the places left have none. */
static void vote(const labelled *e, int64_t i, surroundings *s)
{
    for (int k = 0; k < CANDIDATES; k++)
        s->votes[k] = 0;
    int64_t end = e->indptr[i];
    while (end < e->indptr[i + 1] && e->indices[end] < i)
        end++;
    const int64_t begin = dm_max(end - NEIGHBOURS, e->indptr[i]);
    for (int64_t at = end - 1; at >= begin; at--) {
        const int64_t label = e->labels[e->indices[at]];
        int64_t k = 0;
        while (s->votes[k] > 0 && s->candidates[k] != label)
            k++;
        s->candidates[k] = label;
        s->votes[k]++;
        rise(s, k);
    }
    s->known = end - begin;
}

/* Find the labels of the known neighbours of unknown ones. */
static void look_ahead(const labelled *e, int64_t i, surroundings *s)
{
    s->front = 0;
    for (int64_t at = e->indptr[i]; at < e->indptr[i + 1]; at++) {
        const int64_t u = e->indices[at];
        if (u < i)
            continue;
        for (int64_t by = e->indptr[u]; by < e->indptr[u + 1]; by++) {
            if (e->indices[by] >= i || s->front == AHEAD)
                break;
            s->ahead[s->front++] = e->labels[e->indices[by]];
        }
    }
}

/* Add a label to the candidates, unless it is there or none. */
static void add(surroundings *s, int64_t label)
{
    int64_t k = 0;
    while (k < s->found && s->candidates[k] != label)
        k++;
    if (k == s->found && label >= 0)
        s->candidates[s->found++] = label;
}

/* Collect the candidates. */
static void collect(const labelled *e, int64_t i, surroundings *s)
{
    s->expected = s->match >= 0 ? e->labels[s->match] : -1;
    vote(e, i, s);
    look_ahead(e, i, s);
    s->found = 0;
    while (s->votes[s->found] > 0)
        s->found++;
    add(s, i > 0 ? e->labels[i - 1] : -1);
    add(s, s->expected);
    for (int64_t at = 0; at < s->front; at++)
        add(s, s->ahead[at]);
}

/* Code which candidate a label is; return it, -1 for none. */
static int64_t code_candidate(dm_coder *c, const labelled *e, int64_t i, const surroundings *s)
{
    const int64_t actual = e->labels[i];
    const int64_t before = i > 0 ? e->labels[i - 1] : -1, earlier = i > 1 ? e->labels[i - 2] : -1;
    int64_t at[DM_CANDIDATE_INPUTS];
    for (int64_t k = 0; k < s->found; k++) {
        const int64_t label = s->candidates[k], votes = s->votes[k];
        const int64_t rank = dm_min(k, 3), rivals = dm_min(s->found - k, 4);
        const int64_t other = s->found > 1 ? s->candidates[k == 0 ? 1 : 0] : -1;
        const int64_t matched = s->expected < 0 ? 0 : (s->expected == label ? 1 : 2);
        const int64_t last = label == before;
        const int64_t share = votes == 0 ? 0 : (votes < s->known ? 1 : 2);
        int64_t same = 0;
        for (int64_t j = 0; j < s->front; j++)
            same += s->ahead[j] == label;
        const int64_t differ = s->front - same;
        const int64_t agreement = (dm_min(votes, 7) * 16 + s->known) * 8 + rivals;
        at[0] = slot(CANDIDATE, (agreement * 4 + rank) * 2 + last);
        const int64_t trust = (dm_min(s->length, LONGEST) * 8 + s->fared) * 3 + matched;
        at[1] = slot(CANDIDATE + 1, trust * 4 + rank);
        at[2] = slot(CANDIDATE + 2, joined(joined(label, before), earlier));
        const int64_t front = (dm_min(same, 3) * 4 + dm_min(differ, 3)) * 2 + last;
        at[3] = slot(CANDIDATE + 3, joined(joined(label, other), front));
        at[4] = slot(CANDIDATE + 4, (front * 8 + dm_min(votes, 7)) * 4 + dm_min(s->known, 3));
        const int64_t record = (s->hits * 4 + rank) * 3 + share;
        at[5] = slot(CANDIDATE + 5,
                     (record * 2 + last) * 9 + dm_min(same, 2) * 3 + dm_min(differ, 2));
        const int64_t run = ((matched * 2 + last) * 3 + share) * 8 + dm_min(s->length, 7);
        at[6] = slot(CANDIDATE + 6, run);
        if (dm_code_bit(c, actual == label, DM_CANDIDATE_MIXER + dm_min(k, 2), at))
            return label;
    }
    return -1;
}

/* Code a label that no candidate is: `seen`, which is new, or one below. */
static int64_t code_other(dm_coder *c, const labelled *e, int64_t i, const surroundings *s)
{
    const int64_t seen = s->seen, actual = e->labels[i];
    if (s->found == seen) /* all are candidates */
        return seen;
    const int64_t before = i > 0 ? e->labels[i - 1] : -1;
    int64_t at[DM_NEW_INPUTS];
    at[0] = slot(NEW, s->news);
    at[1] = slot(NEW + 1, (s->news & 3) * 2 + (before == seen - 1));
    at[2] = slot(NEW + 2, before);
    if (dm_code_bit(c, actual == seen, DM_NEW_MIXER, at))
        return seen;
    int64_t result = 0;
    for (int64_t j = 0; j < DM_LABEL_DIGITS && (result | (int64_t)1 << j) < seen; j++) {
        const int64_t node = (int64_t)1 << j | result;
        at[0] = slot(DIGIT, node);
        at[1] = slot(DIGIT + 1, joined(node, before));
        at[2] = slot(DIGIT + 2, joined(node, s->candidates[0]));
        result |= dm_code_bit(c, actual >> j & 1, DM_DIGIT_MIXER + j, at) << j;
    }
    return result;
}

/* Follow the match, or find the next one. */
static void follow(const labelled *e, int64_t i, surroundings *s, int64_t *followers)
{
    const int64_t label = e->labels[i];
    if (s->match >= 0) {
        const int right = label == s->expected;
        s->fared = (2 * s->fared + right) & 7;
        s->length = right ? s->length + 1 : 0;
        s->match = right ? s->match + 1 : -1;
    }
    if (i < 3)
        return;
    int64_t context = label;
    for (int64_t k = 1; k < 4; k++)
        context = joined(context, e->labels[i - k]);
    const int64_t at = dm_hashed(FOLLOWER, 0, context) & (DM_FOLLOWERS - 1);
    if (s->match < 0)
        s->match = followers[at];
    followers[at] = i + 1;
}

/* Code `labels` (n,), filled in when decoding, and set how many there are.

   They are numbered in the order of their first elements. Neighbours ascend in the rows of the
   graph. `followers` (DM_FOLLOWERS,) is scratch. */
int dm_code_labels(dm_coder *c, const int32_t *indptr, int64_t n, const int32_t *indices,
                   int64_t entries, int64_t *labels, int64_t *followers, int64_t *seen)
{
    if (!dm_has_memory(c, DM_LABEL_SLOTS, DM_DIGIT_MIXER + DM_LABEL_DIGITS) ||
        !dm_is_graph(indptr, n, indices, entries))
        return DM_INVALID;
    const labelled e = {indptr, indices, labels};
    surroundings s = {.match = -1};
    for (int64_t at = 0; at < DM_FOLLOWERS; at++)
        followers[at] = -1;
    for (int64_t i = 0; i < n; i++) {
        collect(&e, i, &s);
        int64_t label = code_candidate(c, &e, i, &s);
        if (s.found > 0)
            s.hits = (2 * s.hits + (label >= 0 && label == s.candidates[0])) & 63;
        if (label < 0) {
            label = code_other(c, &e, i, &s);
            for (int64_t k = 0; k < s.found; k++)
                if (s.candidates[k] == label)
                    return DM_CORRUPT;
            s.news = (2 * s.news + (label == s.seen)) & 15;
            s.seen = dm_max(s.seen, label + 1);
        }
        labels[i] = label;
        follow(&e, i, &s, followers);
    }
    *seen = s.seen;
    return DM_OK;
}
