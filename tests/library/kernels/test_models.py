"""Slots of the probability models, which are part of the format."""

from __future__ import annotations

import pytest

from deltamesh._kernels.coding import exact
from deltamesh._kernels.coding.models import model_of, ranges_of

# The first slot of each range of contexts, and the number of slots.
SLOTS_OF: dict[str, tuple[dict[str, int], int]] = {
    "wedges": (
        {
            "SAME_BY_KIND": 0,
            "SAME_BY_SEAMS": 64,
            "SAME_BY_UNKNOWN": 320,
            "SAME_BY_DISTANCE": 576,
            "SAME_BY_COUNT": 832,
            "NEW_BY_KIND": 1088,
            "NEW_BY_COUNT": 1152,
            "MORE_BY_LAST": 1216,
            "MORE_BY_NUMBER": 1232,
        },
        1248,
    ),
    "hidden_edges": (
        {
            "HIDE_BY_SIZES": 0,
            "HIDE_BY_ENDS": 256,
            "HIDE_BY_APEXES": 1856,
            "HIDE_BY_BEYOND": 3456,
            "PAIR_BY_SIZE": 5956,
            "PAIR_BY_HISTORY": 6020,
            "PAIR_BY_CANDIDATE": 6084,
            "CHOOSE_BY_RANK": 6148,
            "CHOOSE_BY_SIZE": 6180,
        },
        6244,
    ),
    "stitching": (
        {
            "STITCHED_BY_LOWER": 0,
            "STITCHED_BY_BEFORE": 32,
            "STITCHED_BY_VOTES": 48,
            "MATCHES_BY_RANK": 80,
            "MATCHES_BY_RIVAL": 208,
            "REVERSED_BY_BEFORE": 272,
            "REVERSED_BY_AROUND": 276,
            "REVERSED_BY_BOTH": 292,
            "REPEATED_BY_LAST": 356,
            "REPEATED_BY_AROUND": 388,
            "NUMBER_AT": 420,
            "ADJACENT_AT": 460,
        },
        461,
    ),
    "valence": (
        {
            "NOTHING": 0,
            "PAIR": 1,
            "FREE": 257,
            "BEHIND": 769,
            "LAST_TWO": 1025,
            "NEAR_PAIR": 1281,
            "FACE": 1793,
            "TOTAL": 2817,
            "CONTEXTS": 2881,
            "VALENCE_TREE": 0,
            "JOIN_FLAG": 51858,
            "LOOP_FLAG": 52050,
            "NEAR_FLAG": 52051,
            "NEAR_TREE": 52052,
            "SIDE_TREE": 52116,
            "NUMBER": 52180,
        },
        52324,
    ),
    "steps": (
        {
            "DISTANCE": 0,
            "STEP": 1048576,
            "CHOOSE": 1051648,
            "ROTATION": 1053184,
            "TRACK": 1054720,
            "SKIP": 1056768,
        },
        1056960,
    ),
    "exact_axis": ({"CHOICE_AT": 0}, 1152),
    "exact_format": ({"MAGNITUDE_AT": 0, "MANTISSA_AT": 387072, "SIGN_AT": 403704}, 403800),
    "points": ({"POINTS_GAP": 0, "POINTS_STEP": 64}, 128),
    "choices": ({"CHOICES_BY_HISTORY": 0}, 8),
    "vectors": ({"HASHED": 0}, 1 << 20),
    "positions": ({"HASHED": 0}, 1 << 20),
    "labels": ({"HASHED": 0}, 1 << 18),
}


@pytest.mark.parametrize("name", SLOTS_OF)
def test_slots_of_models(name: str) -> None:
    """Slots are part of the format: another context in the same slot learns from it."""
    slots, total = SLOTS_OF[name]
    assert ranges_of(name) == slots
    assert model_of(name).slots == total


def test_mixers_of_models() -> None:
    """The inputs of each mixer and the bounds of the counts, as runs of equal ones."""
    pair, triple = ((2, 255), 1), ((3, 255), 1)
    axis = [((6, 255), 32), ((3, 255), 32), ((3, 255), 1)]
    position = [((10, 255), 32), ((6, 255), 32), ((7, 255), 1)]
    wanted = {
        "wedges": [((5, 255), 1), pair, pair],
        "hidden_edges": [((4, 255), 1), triple, pair],
        "stitching": [triple, pair, triple, pair, ((1, 255), 1), ((1, 255), 1)],
        "valence": [((8, 500), 36), ((1, 255), 1), ((3, 1000), 1), ((1, 1000), 1), ((1, 255), 3)],
        "steps": [*axis, ((3, 255), 5), pair, triple],
        "exact_axis": [((3, 255), 3)],
        "exact_format": [((6, 255), 63), pair, triple],
        "points": [((1, 255), 2)],
        "choices": [((1, 255), 1)],
        "vectors": 3 * axis,
        "positions": 3 * position,
        "labels": [((7, 255), 3), triple, ((3, 255), 40)],
    }
    for name, runs in wanted.items():
        assert list(model_of(name).mixers) == [mixer for mixer, count in runs for _ in range(count)]


def test_models_that_depend_on_the_formats_of_numbers() -> None:
    model = exact.model_for(2)
    assert model.slots == 3456 + 2 * 403800
    assert len(model.mixers) == 9 + 2 * 65


def test_there_are_no_other_models() -> None:
    with pytest.raises(KeyError):
        model_of("vowels")
