"""Options of the encoder: written in several places, and the same in all."""

from __future__ import annotations

import dataclasses
import inspect
import re
from itertools import combinations
from typing import get_type_hints

import pytest

import deltamesh
from deltamesh import OptionError
from deltamesh._codec.encoding import encode
from deltamesh._methods import BOUNDS, METHOD_OPTIONS, METHODS, RATES
from deltamesh._options import CHOICES, EncodeOptions, Options, check_together
from deltamesh_cli.commands.encode import command

# In the library alone, or with another name, or for the program itself.
NOT_ON_THE_COMMAND_LINE = {"source_format", "progress"}


def keywords() -> dict[str, inspect.Parameter]:
    parameters = inspect.signature(encode).parameters
    return {name: p for name, p in parameters.items() if p.kind is p.KEYWORD_ONLY}


def test_the_typed_options_are_the_keywords_of_encode() -> None:
    hints, typed = get_type_hints(encode), get_type_hints(EncodeOptions)
    assert typed == {name: hints[name] for name in keywords()}
    assert EncodeOptions.__total__ is False


def test_the_checked_options_are_the_keywords_of_encode() -> None:
    typed, own = get_type_hints(EncodeOptions), get_type_hints(Options)
    assert {*typed} - {*own} == {"progress"}
    # encode takes one name of what to drop as well.
    assert {name for name in own if own[name] != typed[name]} == {"drop"}
    defaults = {field.name: field.default for field in dataclasses.fields(Options)}
    assert defaults == {n: p.default for n, p in keywords().items() if n != "progress"}


def test_every_option_is_documented_and_on_the_command_line() -> None:
    listed = re.findall(r"^([a-z_, ]+) : ", inspect.getdoc(encode) or "", re.MULTILINE)
    names = {name for line in listed for name in line.split(", ")}
    assert names == {"mesh", "faces", *keywords()}
    assert {*keywords()} - {p.name for p in command.params} == NOT_ON_THE_COMMAND_LINE


@pytest.mark.parametrize("method", CHOICES)
@pytest.mark.parametrize("name", METHOD_OPTIONS)
def test_options_of_other_methods_mean_nothing(method: str, name: str) -> None:
    known = method == "auto" or name in METHODS[method].options
    if known:
        check_together(method, [name])
    else:
        with pytest.raises(OptionError, match=f"^<{name}> means nothing with <method> {method}$"):
            check_together(method, [name], "<{}>".format)


def test_rates_exclude_all_others_and_bounds_go_together() -> None:
    check_together("refined", BOUNDS)
    for one, other in combinations((*RATES, *BOUNDS), 2):
        if one in RATES:
            with pytest.raises(OptionError, match=f"^{one} and {other} exclude each other$"):
                check_together("refined", [other, one])


def test_a_wrong_name_is_a_type_error() -> None:
    with pytest.raises(TypeError, match="qualty"):
        deltamesh.encode([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], qualty=3)


@pytest.mark.parametrize(
    "rate", [{"bits": 8}, {"step": 0.1}, {"max_error": 1.0}, {"normal_error": 1.0}, {"coarse": 4.0}]
)
def test_rates_contradict_the_lossless_method(rate: dict) -> None:
    with pytest.raises(OptionError, match=r"means? nothing with method lossless"):
        Options(method="lossless", **rate)


def test_only_needs_a_bound() -> None:
    with pytest.raises(OptionError, match="only needs a bound"):
        Options(only=True)
    with pytest.raises(OptionError, match="only needs a bound"):
        Options(only=True, bits=8)
    assert Options(only=True, rms_error=1.0).only
