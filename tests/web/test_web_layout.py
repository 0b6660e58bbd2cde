"""The constants of the decoder in JavaScript against those in Python."""

from __future__ import annotations

import json
from typing import Any

import children
import pytest
from format_constants import CONSTANTS
from places import ROOT

from deltamesh import _limits, _mesh, _methods
from deltamesh._methods import METHODS
from deltamesh_formats.container import layout
from deltamesh_formats.container.method_layouts import KNOWN
from deltamesh_formats.container.payload_layout import RAW_WIDTHS

DECODER = ROOT / "src" / "web" / "decoder"


@pytest.fixture(scope="module")
def constants(node: str) -> dict[str, Any]:
    """What layout.mjs and limits.mjs export."""
    names = [json.dumps(str(DECODER / name)) for name in ("layout.mjs", "limits.mjs")]
    code = f"""
    const all = {{ ...(await import({names[0]})), ...(await import({names[1]})) }};
    console.log(JSON.stringify(all, (_, x) => x instanceof Map || x instanceof Set ? [...x] : x));
    """
    done = children.run([node, "--input-type=module", "-e", code], text=True, check=True)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


@pytest.mark.parametrize(
    "name",
    [
        "VERSION",
        "VARINT_MAX_BYTES",
        "MAX_COUNT",
        "ID_SIZE",
        "CRC_SIZE",
        "MAX_SECTIONS",
        "FLAG_SINGLE",
        "FLAG_INTERPOLATED",
        "LEAST_UNIT",
        "MOST_UNIT",
        "MAX_BITS",
        "BITS_FROM_STEP",
        "MAX_GRID_BITS",
        "MAX_LIMB_BITS",
        "OWN_WEDGES",
        "POLYGON_OWNERS",
        "WEDGES_OF",
        "MAX_TEXT",
        "MIN_NORMAL_BITS",
        "MAX_NORMAL_BITS",
        "MAX_ELEMENTS_PER_BYTE",
        "MAX_EXPONENT",
        "PER_OCTAVE",
        "FRAME_KEY",
        "FRAME_CELLS",
        "FRAME_CORRECTIONS",
        "MAX_FINER",
        "MAX_MAP_UNIT",
        "MAX_RUN",
        "MOST_OCTAVES",
    ],
)
def test_numbers(constants: dict[str, Any], name: str) -> None:
    assert constants[name] == CONSTANTS[name]


@pytest.mark.parametrize(
    "name",
    [
        "HEADER_FIELDS",
        "PARAMETER_FIELDS",
        "SEED_FIELDS",
        "META_FIELDS",
        "META_LOSS_FIELDS",
        "META_PART_FIELDS",
        "SEQUENCE_FIELDS",
        "FRAME_FIELDS",
        "MAP_FIELDS",
        "POSE_FIELDS",
        "AFTER_CONNECTIVITY",
        "AFTER_GEOMETRY",
        "QUARTERS",
    ],
)
def test_rows(constants: dict[str, Any], name: str) -> None:
    rows = [list(row) if isinstance(row, tuple) else row for row in CONSTANTS[name]]
    assert constants[name] == rows


def test_names_by_their_numbers(constants: dict[str, Any]) -> None:
    for name in ("DOMAINS", "ROLES", "TYPES", "CODINGS", "KINDS"):
        assert constants[name] == list(CONSTANTS[name])
        assert list(CONSTANTS[name].values()) == list(range(len(constants[name])))
    assert constants["ANCHOR_METHODS"] == [[n, name] for name, n in layout.ANCHOR_METHODS.items()]
    assert constants["RAW_WIDTHS"] == list(RAW_WIDTHS.values())
    assert constants["MAGIC"] == list(layout.MAGIC)
    assert {*constants["KNOWN"]} == KNOWN


def test_methods(constants: dict[str, Any]) -> None:
    for number, found in enumerate(constants["METHODS"]):
        method = METHODS[found["name"]]
        own = method.layout
        assert own.id == number
        assert (own.title, own.geometry) == (found["title"], tuple(found["geometry"]))
        for flag in ("corrected", "anchored", "exact", "bare", "coarse"):
            assert getattr(own, flag) == found.get(flag, False)
        if method.memory is None:
            assert "memory" not in found
        else:
            assert_memory(found, method.memory)
    assert_memory(constants["INTERPOLATED"], _methods.INTERPOLATED)
    assert_memory(constants["LEAST_SQUARES"], _methods.LEAST_SQUARES)


def assert_memory(found: dict[str, Any], memory: _methods.Memory) -> None:
    assert (found["memory"], found["memoryPerVertex"]) == (memory.fixed, memory.per_vertex)


def test_limits(constants: dict[str, Any]) -> None:
    for name in (
        "PER_FACE",
        "PER_TEXT_BYTE",
        "PER_TRANSFORM",
        "PER_GLUED_FACE",
        "PER_MOVED_VERTEX",
        "PER_ELEMENT",
        "PER_NUMBER",
        "PER_TREE_VERTEX",
        "PER_MOTION",
    ):
        assert constants[name] == getattr(_limits, name)
    assert constants["MAX_VERTICES"] == _limits.DEFAULT_MAX_VERTICES
    assert constants["MEMORY"] == _limits.DEFAULT_MEMORY
    assert constants["POSITION_LARGEST"] == _mesh.LARGEST
