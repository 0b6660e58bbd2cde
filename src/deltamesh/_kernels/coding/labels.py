"""Labels of elements: most equal that of a neighbour, or continue as labels did before.

The labels of the known neighbours are candidates, the one that most of them have first; then the
label of the element before; then what followed the last time that the labels were as they are
now, the match model of Mahoney ("Adaptive weighing of context models for lossless data
compression", 2005); then the labels ahead, those of the known neighbours of unknown ones. A bit
for each candidate says whether it is the label. Another label is new, which is the next number, or
its number is coded from the low bit up, without the bits that would lead beyond the labels: no
stream can name a label that does not exist.
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding.coder import CONTEXT, Coder, code_bit
from deltamesh._kernels.coding.models import Model
from deltamesh._kernels.coding.signed_integers import hashed
from deltamesh._kernels.jit import Int, inlined, kernel
from deltamesh_formats.array_types import Ints

NEIGHBOURS = 8  # that are looked at, the latest ones
AHEAD = 16  # labels ahead that are looked at, the first ones
CANDIDATES = NEIGHBOURS + AHEAD + 2
DIGITS = 40  # of a number: more labels than elements there may be
LONGEST = 15  # of a match, as a context

# Contexts are hashed by these numbers and those that follow them, as many as inputs.
CANDIDATE, NEW, DIGIT = 0, 8, 12
INPUTS = (7, 3, 3)
SLOTS = 1 << 18
FOLLOWERS = 1 << 16

# Mixers: of candidates, by their rank, at most 2; of the bit for a new label; of digits.
CANDIDATE_MIXER, NEW_MIXER, DIGIT_MIXER = 0, 3, 4
LIMIT = 255
MIXERS = 3 * ((INPUTS[0], LIMIT),) + ((INPUTS[1], LIMIT),) + DIGITS * ((INPUTS[2], LIMIT),)
MODEL = Model(SLOTS, MIXERS)


@inlined
def _joined(a: Int, b: Int) -> Int:
    """Return one context of two; products wrap around."""
    return np.int64(a) * 0x2C1B3C6D + np.int64(b)


@inlined
def _set(c: Coder, i: Int, number: Int, context: Int) -> None:
    c.state[CONTEXT + i] = hashed(number + i, np.int64(0), context) & (SLOTS - 1)


@kernel
def code_labels(c: Coder, indptr: Ints, indices: Ints, labels: Ints) -> Int:
    """Code `labels` (n,), filled in when decoding; return how many there are, -1: corrupt.

    They are numbered in the order of their first elements. Neighbours ascend.
    """
    followers = np.full(FOLLOWERS, -1, np.int64)
    candidates, votes = np.empty(CANDIDATES, np.int64), np.empty(CANDIDATES, np.int64)
    ahead = np.empty(AHEAD, np.int64)
    seen = np.int64(0)
    match, length, fared = np.int64(-1), np.int64(0), np.int64(0)
    hits, news = np.int64(0), np.int64(0)
    for i in range(len(labels)):
        expected = labels[match] if match >= 0 else np.int64(-1)
        known = _vote(indptr, indices, labels, i, candidates, votes)
        front = ahead[: _look_ahead(indptr, indices, labels, i, ahead)]
        found = _others(labels, i, expected, front, candidates, votes)
        label = _code_candidate(
            c, labels, i, candidates, votes, found, known, front, expected, length, fared, hits
        )
        if found > 0:
            hits = (2 * hits + (label >= 0 and label == candidates[0])) & 63
        if label < 0:
            label = _code_other(c, labels, i, candidates, found, seen, news)
            for k in range(found):
                if candidates[k] == label:
                    return np.int64(-1)
            news = (2 * news + (label == seen)) & 15
            seen = max(seen, label + 1)
        labels[i] = label
        if match >= 0:
            fared = (2 * fared + (label == expected)) & 7
            length = length + 1 if label == expected else np.int64(0)
            match = match + 1 if label == expected else np.int64(-1)
        if i >= 3:
            context = label
            for k in range(1, 4):
                context = _joined(context, labels[i - k])
            at = hashed(np.int64(DIGIT + 4), np.int64(0), context) & (FOLLOWERS - 1)
            if match < 0:
                match = followers[at]
            followers[at] = i + 1
    return seen


@inlined
def _vote(indptr: Ints, indices: Ints, labels: Ints, i: Int, candidates: Ints, votes: Ints) -> Int:
    """Order the labels of the latest known neighbours by votes; return how many have voted.

    The places that are left have no votes.
    """
    votes[:] = 0
    end = indptr[i]
    while end < indptr[i + 1] and indices[end] < i:
        end += 1
    begin = max(end - NEIGHBOURS, indptr[i])
    for at in range(end - 1, begin - 1, -1):
        label = labels[indices[at]]
        k = 0
        while votes[k] > 0 and candidates[k] != label:
            k += 1
        candidates[k] = label
        votes[k] += 1
        while k > 0 and votes[k - 1] < votes[k]:
            candidates[k], candidates[k - 1] = candidates[k - 1], candidates[k]
            votes[k], votes[k - 1] = votes[k - 1], votes[k]
            k -= 1
    return end - begin


@inlined
def _look_ahead(indptr: Ints, indices: Ints, labels: Ints, i: Int, ahead: Ints) -> Int:
    """Find the labels of the known neighbours of unknown ones; return how many."""
    found = 0
    for at in range(indptr[i], indptr[i + 1]):
        u = indices[at]
        if u < i:
            continue
        for by in range(indptr[u], indptr[u + 1]):
            if indices[by] >= i or found == AHEAD:
                break
            ahead[found] = labels[indices[by]]
            found += 1
    return found


@inlined
def _others(labels: Ints, i: Int, expected: Int, ahead: Ints, candidates: Ints, votes: Ints) -> Int:
    """Add the label before, the expected one, those ahead; return how many candidates there are."""
    found = 0
    while votes[found] > 0:
        found += 1
    for at in range(-2, len(ahead)):
        if at >= 0:
            label = ahead[at]
        else:
            label = expected if at == -1 else (labels[i - 1] if i > 0 else np.int64(-1))
        k = 0
        while k < found and candidates[k] != label:
            k += 1
        if k == found and label >= 0:
            candidates[found] = label
            found += 1
    return found


@inlined
def _code_candidate(
    c: Coder,
    labels: Ints,
    i: Int,
    candidates: Ints,
    votes: Ints,
    found: Int,
    known: Int,
    ahead: Ints,
    expected: Int,
    length: Int,
    fared: Int,
    hits: Int,
) -> Int:
    """Code which candidate a label is; return it, -1 for none."""
    before = labels[i - 1] if i > 0 else np.int64(-1)
    earlier = labels[i - 2] if i > 1 else np.int64(-1)
    for k in range(found):
        label = candidates[k]
        rank, rivals = min(k, 3), min(found - k, 4)
        other = candidates[1 if k == 0 else 0] if found > 1 else np.int64(-1)
        matched = 0 if expected < 0 else (1 if expected == label else 2)
        last = 1 if label == before else 0
        share = 0 if votes[k] == 0 else (1 if votes[k] < known else 2)
        same = 0
        for at in range(len(ahead)):
            same += ahead[at] == label
        differ = len(ahead) - same
        agreement = (min(votes[k], 7) * 16 + known) * 8 + rivals
        _set(c, 0, np.int64(CANDIDATE), (agreement * 4 + rank) * 2 + last)
        trust = (min(length, LONGEST) * 8 + fared) * 3 + matched
        _set(c, 1, np.int64(CANDIDATE), trust * 4 + rank)
        _set(c, 2, np.int64(CANDIDATE), _joined(_joined(label, before), earlier))
        front = (min(same, 3) * 4 + min(differ, 3)) * 2 + last
        _set(c, 3, np.int64(CANDIDATE), _joined(_joined(label, other), front))
        _set(c, 4, np.int64(CANDIDATE), (front * 8 + min(votes[k], 7)) * 4 + min(known, 3))
        record = (hits * 4 + rank) * 3 + share
        _set(c, 5, np.int64(CANDIDATE), (record * 2 + last) * 9 + min(same, 2) * 3 + min(differ, 2))
        run = ((matched * 2 + last) * 3 + share) * 8 + min(length, 7)
        _set(c, 6, np.int64(CANDIDATE), run)
        if code_bit(c, np.int64(labels[i] == label), np.int64(CANDIDATE_MIXER + min(k, 2))) == 1:
            return label
    return np.int64(-1)


@inlined
def _code_other(
    c: Coder, labels: Ints, i: Int, candidates: Ints, found: Int, seen: Int, news: Int
) -> Int:
    """Code a label that no candidate is: `seen`, which is new, or one below."""
    if found == seen:  # all are candidates
        return seen
    before = labels[i - 1]
    _set(c, 0, np.int64(NEW), news)
    _set(c, 1, np.int64(NEW), (news & 3) * 2 + (1 if before == seen - 1 else 0))
    _set(c, 2, np.int64(NEW), before)
    if code_bit(c, np.int64(labels[i] == seen), np.int64(NEW_MIXER)) == 1:
        return seen
    result, j = np.int64(0), np.int64(0)
    while (result | (1 << j)) < seen:
        node = (np.int64(1) << j) | result
        _set(c, 0, np.int64(DIGIT), node)
        _set(c, 1, np.int64(DIGIT), _joined(node, before))
        _set(c, 2, np.int64(DIGIT), _joined(node, candidates[0]))
        bit = code_bit(c, (labels[i] >> j) & 1, np.int64(DIGIT_MIXER) + j)
        result |= bit << j
        j += 1
    return result
