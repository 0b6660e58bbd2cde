"""Options of the decoder: written in several places, and the same in all."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Callable
from typing import Any

import pytest

import deltamesh
from deltamesh._decode_options import DecodeOptions

FIELDS = {field.name: field.default for field in dataclasses.fields(DecodeOptions)}


@pytest.mark.parametrize(
    "function",
    [
        deltamesh.decode,
        deltamesh.load,
        deltamesh.verify,
        deltamesh.frames,
        deltamesh.edit,
        deltamesh.stages,
    ],
)
def test_what_decodes_has_the_options_of_the_decoder(
    function: Callable[..., Any],
) -> None:
    keywords = {
        name: parameter.default
        for name, parameter in inspect.signature(function).parameters.items()
        if parameter.kind is parameter.KEYWORD_ONLY
    }
    for name, default in FIELDS.items():
        if name == "progress":  # of a stream, the meshes that are yielded are the progress
            assert keywords.get(name) is None
            assert name in keywords or function is deltamesh.stages
        else:
            assert keywords[name] == default
    first = [*FIELDS] if function is not deltamesh.stages else [*FIELDS][:-1]
    assert [name for name in keywords if name in FIELDS] == first
