"""Methods of geometry: each is one value here and there, and a module of its name."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Callable

import pytest

from deltamesh._geometry.methods import GeometryCodec, geometry_codec
from deltamesh._methods import METHODS
from deltamesh._options import Options
from deltamesh_formats.container import layout

FUNCTIONS = {
    name: value for name, value in vars(GeometryCodec).items() if inspect.isfunction(value)
}


def taken(function: Callable[..., object]) -> list[tuple[str, object]]:
    parameters = inspect.signature(function).parameters.values()
    return [(each.name, each.annotation) for each in parameters if each.name != "self"]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ["quantize", "reconstruct", "encode", "decode"])
def test_a_module_has_the_functions_of_the_protocol(method: str, name: str) -> None:
    function = getattr(geometry_codec(method), name)
    assert taken(function) == taken(FUNCTIONS[name])
    expected = inspect.signature(FUNCTIONS[name]).return_annotation
    assert inspect.signature(function).return_annotation == expected
    assert function.__doc__


def test_the_codec_knows_the_methods_of_the_container() -> None:
    assert {*METHODS} == {*layout.METHODS}
    for name, method in METHODS.items():
        assert method.name == name
        assert method.layout is layout.METHODS[name]
        assert {*method.options} <= {field.name for field in dataclasses.fields(Options)}
        assert ("anchors" in method.options) == method.layout.anchored
        assert ("coarse" in method.options) == method.layout.coarse
        assert ("bits" in method.options) == (not method.layout.exact)
        assert (method.first_step > 0) == (not method.layout.exact)


def test_ids_are_bytes_and_nobody_shares_one() -> None:
    ids = [method.id for method in layout.METHODS.values()]
    assert len({*ids}) == len(ids)
    assert all(0 <= each < 256 for each in ids)
