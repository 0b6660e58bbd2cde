"""Checks of arguments: what passes, and what messages say."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from deltamesh_formats import arguments
from deltamesh_formats.errors import OptionError


def test_integers_and_numbers_of_any_library_pass() -> None:
    for whole in (3, np.int8(3), np.uint64(3)):
        arguments.require_whole("k", whole, 1, 3)
        arguments.require_whole("k", whole, 3)
    for number in (0.5, np.float32(0.5), Fraction(1, 2), 1):
        arguments.require_number("share", number, 0, 1)
        arguments.require_above_0("share", number)
        arguments.require_limit("share", number)
    arguments.require_limit("memory", float("inf"))
    for flag in (True, False, np.bool_(True), 1, 0):
        arguments.require_flag("only", flag)


@pytest.mark.parametrize("wrong", [float("nan"), float("inf"), 0, -1, 10**400, True, "1", None])
def test_other_numbers_are_not_above_0(wrong: object) -> None:
    with pytest.raises(OptionError, match=r"^step must be a number above 0, not "):
        arguments.require_above_0("step", wrong)


def test_messages_are_one_short_line() -> None:
    with pytest.raises(OptionError, match=r"^k must lie in 1\.\.3, not array\(") as error:
        arguments.require_whole("k", np.zeros((50, 50)), 1, 3)
    assert "\n" not in str(error.value)
    assert len(str(error.value)) < 100
    with pytest.raises(OptionError, match=r"^k must be a whole number from 2 on, not 1$"):
        arguments.require_whole("k", 1, 2)
    with pytest.raises(OptionError, match=r"^mesh must be a dict, not 3$"):
        arguments.require_type("mesh", 3, dict)
    with pytest.raises(OptionError, match=r"^mode must be one of a, b, not 'c'$"):
        arguments.require_one_of("mode", "c", ("a", "b"))
