"""Methods of geometry: each is one value here and there, and a module of its name."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Callable

import pytest

from deltamesh._geometry.methods import (
    FrameCodec,
    GeometryCodec,
    frame_codec,
    geometry_codec,
)
from deltamesh._methods import METHODS
from deltamesh._options import Options
from deltamesh_formats.container import method_layouts


def functions(protocol: type) -> dict[str, Callable[..., object]]:
    return {name: value for name, value in vars(protocol).items() if inspect.isfunction(value)}


ONE, FRAMES = functions(GeometryCodec), functions(FrameCodec)


def taken(function: Callable[..., object]) -> list[tuple[str, object]]:
    parameters = inspect.signature(function).parameters.values()
    return [(each.name, each.annotation) for each in parameters if each.name != "self"]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "name", ["quantize", "reconstruct", "encode", "decode", "encode_frame", "decode_frame"]
)
def test_a_module_has_the_functions_of_the_protocol(method: str, name: str) -> None:
    """Those of frames, too, but for the exact method."""
    known = ONE if METHODS[method].layout.exact else ONE | FRAMES
    function = getattr(geometry_codec(method), name, None)
    if name not in known:
        assert function is None
        return
    assert function is not None
    assert taken(function) == taken(known[name])
    expected = inspect.signature(known[name]).return_annotation
    assert inspect.signature(function).return_annotation == expected
    assert function.__doc__
    assert frame_codec(method) is geometry_codec(method)


def test_the_codec_knows_the_methods_of_the_container() -> None:
    assert {*METHODS} == {*method_layouts.METHODS}
    for name, method in METHODS.items():
        assert method.name == name
        assert method.layout is method_layouts.METHODS[name]
        assert {*method.options} <= {field.name for field in dataclasses.fields(Options)}
        assert ("anchors" in method.options) == method.layout.anchored
        assert ("coarse" in method.options) == method.layout.coarse
        assert ("bits" in method.options) == (not method.layout.exact)
        assert (method.first_step > 0) == (not method.layout.exact)


def test_ids_are_bytes_and_nobody_shares_one() -> None:
    ids = [method.id for method in method_layouts.METHODS.values()]
    assert len({*ids}) == len(ids)
    assert all(0 <= each < 256 for each in ids)
