"""Slots of the probability models, which are part of the format."""

from __future__ import annotations

from types import ModuleType

import pytest

from deltamesh._kernels.coding import (
    exact,
    hidden_edges,
    steps,
    stitching,
    valence,
    wedges,
)
from deltamesh._kernels.coding.models import layout

SLOTS_OF: list[tuple[ModuleType, dict[str, int]]] = [
    (
        wedges,
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
            "SLOTS": 1248,
        },
    ),
    (
        hidden_edges,
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
            "SLOTS": 6244,
        },
    ),
    (
        stitching,
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
            "SLOTS": 461,
        },
    ),
    (
        valence,
        {
            "PAIR": 1,
            "FREE": 257,
            "BEHIND": 769,
            "LAST_TWO": 1025,
            "NEAR_PAIR": 1281,
            "FACE": 1793,
            "TOTAL": 2817,
            "CONTEXTS": 2881,
            "JOIN_FLAG": 51858,
            "LOOP_FLAG": 52050,
            "NEAR_FLAG": 52051,
            "NEAR_TREE": 52052,
            "SIDE_TREE": 52116,
            "NUMBER": 52180,
            "SLOTS": 52324,
        },
    ),
    (
        steps,
        {
            "STEP": 1048576,
            "CHOOSE": 1051648,
            "ROTATION": 1053184,
            "TRACK": 1054720,
            "SKIP": 1056768,
            "SLOTS": 1056960,
        },
    ),
    (
        exact,
        {"MANTISSA_AT": 387072, "SIGN_AT": 403704, "FORMAT_SLOTS": 403800, "FORMATS_AT": 3456},
    ),
]


@pytest.mark.parametrize(
    ("module", "slots"), SLOTS_OF, ids=[m.__name__.rpartition(".")[2] for m, _ in SLOTS_OF]
)
def test_slots_of_models(module: ModuleType, slots: dict[str, int]) -> None:
    """A range of slots that grew or moved would make every file of the format unreadable."""
    assert {name: getattr(module, name) for name in slots} == slots


def test_ranges_of_contexts_follow_each_other() -> None:
    assert layout() == (0,)
    assert layout((4, 4, 4), (3,), (2, 16)) == (0, 64, 67, 99)
