"""Slots of the models, which are a part of the format."""

from __future__ import annotations

from deltamesh._kernels.coding import exact, steps
from deltamesh._kernels.coding.models import layout


def test_ranges_of_contexts_follow_each_other() -> None:
    assert layout() == (0,)
    assert layout((4, 4, 4), (3,), (2, 16)) == (0, 64, 67, 99)
    # Slots are part of the format: another context in the same slot learns from it.
    assert (steps.STEP, steps.CHOOSE, steps.ROTATION) == (1048576, 1051648, 1053184)
    assert (steps.TRACK, steps.SKIP, steps.SLOTS) == (1054720, 1056768, 1056960)
    assert (exact.MANTISSA_AT, exact.SIGN_AT, exact.FORMAT_SLOTS) == (387072, 403704, 403800)
