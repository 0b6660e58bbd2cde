"""ASCII STL in the dialects of various programs, and what of them is refused."""

from __future__ import annotations

import re

import pytest
from cubes import FACETS, STL, STL_BINARY, is_cube
from filetests import named, read, refused

from deltamesh_formats.meshfiles.stl.variants import uniform

CUT = "the end of the last solid: it may be cut short"


def strange(line: str) -> str:
    return f"lines that are no part of a facet ({line!r})"


@pytest.mark.parametrize(
    ("data", "lost"),
    [
        (STL.replace("endsolid", "end solid"), ()),
        (STL.replace("endsolid", "END  SOLID"), ()),
        (STL.replace("endsolid cube", "endsolidcube"), ()),
        (STL.replace("endsolid cube", "endsolid other words"), ()),
        (STL.replace("endloop", "end loop").replace("endfacet", "end facet"), ()),
        (STL.replace("endloop", "END\tLOOP"), ()),
        (STL.replace("endloop", "endloop foo"), ()),
        (STL.replace("endfacet", "endfacet 7 words").replace("outer loop", "outer loop 3"), ()),
        (STL.replace("endloop", "end loop").replace("\n", "\r"), ()),
        (STL.replace("endsolid cube\n", ""), (CUT,)),
        (STL.replace("endsolid cube\n", "").rstrip(), (CUT,)),
        (STL.replace("endsolid cube\n", "solid\n"), (CUT,)),
        (STL.replace("solid cube\n", "solid cube\ncolor 0.5 0.5 0.5\n", 1), ("color 0.5 0.5 0.5",)),
        (STL.replace(" endfacet\n", " endfacet\nCOLOR 1 0 0\n"), ("COLOR 1 0 0",)),
        (STL + "\nfacets 12\n", ("facets 12",)),
        (STL + "written by: a tool\nfacets 12", ("written by: a tool",)),
        (STL + "\x1a", ()),
        (STL + "\0" * 200, ()),
        (STL + "\n\x1a\0", ()),
        ("# comment\n" + STL, ("# comment",)),
        ("\n; made by\n// a tool\n" + STL, ("; made by",)),
        (STL.replace("outer loop\n", "outer loop\n# loop\n"), ("# loop",)),
        (re.sub(r" facet normal .*\n", "facet\n", STL), ()),
        (re.sub(r" facet normal .*\n", "facet normal\n", STL), ()),
        (re.sub(r" facet normal .*\n", "FACET  \r\n", STL, count=3), ()),
        (re.sub(r"normal \S+ \S+ \S+", "normal -1.#IND -1.#IND 1.#QNAN", STL), ()),
        (re.sub(r"normal \S+ \S+ \S+", "normal -nan(ind) nan NaN", STL), ()),
        (STL.replace(" 1", " 1.0D+00"), ()),
        ("\ufeff" + STL, ()),
        (STL.replace("\n", "\r", 4), ()),
        (STL.replace("\n", "\r\n").replace("\r\n", "\r", 9), ()),
        (STL.replace("solid cube", "solidcube"), ()),
    ],
)
def test_dialects(data: str, lost: tuple[str, ...]) -> None:
    mesh = read(data, "stl")
    assert is_cube(mesh)
    assert mesh.lost == tuple(one if one == CUT else strange(one) for one in lost)
    assert named(mesh, "object") == ["cube"] * 12


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-32"])
def test_wide_text(encoding: str) -> None:
    assert is_cube(read(STL.encode(encoding), "stl"))


def test_facets_without_a_solid() -> None:
    mesh = read(FACETS.replace("endloop", "end loop"), "stl")
    assert is_cube(mesh)
    assert (mesh.parts, mesh.lost) == ((), ())
    mesh = read(FACETS + "solid other\n" + FACETS + "endsolid\n", "stl")
    assert named(mesh, "object") == [None] * 12 + ["other"] * 12


def test_solids_keep_their_facets_in_any_dialect() -> None:
    facets = FACETS.replace("normal 0 0 -1", "").replace("endloop", "end loop")
    half = facets.index(" facet", len(facets) // 2)
    between = "end solid a\nsolid b\ncolor 1 1 1\n"
    mesh = read(f"// head\nsolid a\n{facets[:half]}{between}{facets[half:]}endsolid", "stl")
    assert is_cube(mesh)
    count = facets[:half].count("end loop")
    assert named(mesh, "object") == ["a"] * count + ["b"] * (12 - count)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (STL.replace("vertex 0 0 0", "vertx 0 0 0"), "line 4: 'vertx' where 'vertex' belongs"),
        (STL.replace("vertex 0 0 0", "vertex 0,5 0 0"), "line 4: '0,5' is not a number"),
        (STL.replace("   vertex 0 0 0\n", ""), "'endloop' where 'vertex' belongs"),
        ("# head\n" + STL.replace("  outer loop\n", ""), "line 4: 'vertex' where 'outer' belongs"),
        (STL.replace(" endfacet\n facet", " endfacet\n facett"), "'outer' where 'facet' belongs"),
        (STL.replace("endloop\n", "endloop\n 1 2 3\n"), "line 8: '1' where 'endfacet' belongs"),
        (STL.replace("endfacet\n", "endfacet\n 1 2 3\n"), "line 9: '1' where 'facet' belongs"),
        (STL[: STL.rindex("  endloop")], "its last facet has no end: is it cut short"),
        ("some text\nof 93 lines\n", "neither an ASCII STL nor a binary one"),
    ],
)
def test_faults_in_facets_are_refused_with_the_line(data: str, message: str) -> None:
    refused(data, "stl", message)


@pytest.mark.parametrize("data", [b"", b"solid\nendsolid\n", STL.encode()])
def test_what_is_uniform_stays(data: bytes) -> None:
    assert uniform(data) == (data or b"\n", ())


@pytest.mark.parametrize(
    ("data", "lost"),
    [
        (STL_BINARY + b"\0\0", ("2 bytes after the last facet",)),
        (STL_BINARY + b"generated by tool v1\n", ("21 bytes after the last facet",)),
        (b"solid" + STL_BINARY[5:] + b"\n", ("1 bytes after the last facet",)),
        (b"solid facet" + STL_BINARY[11:] + b"endsolid", ("8 bytes after the last facet",)),
        (STL_BINARY + bytes(1001), ("1001 bytes after the last facet",)),
        (
            STL_BINARY[:80] + bytes(4) + STL_BINARY[84:],
            ("the count of facets in the header, 0",),
        ),
    ],
)
def test_binary_with_other_lengths(data: bytes, lost: tuple[str, ...]) -> None:
    mesh = read(data, "stl")
    assert is_cube(mesh)
    assert mesh.lost == lost


@pytest.mark.parametrize(
    ("count", "size", "message"),
    [
        (6, len(STL_BINARY), "its header counts 6 facets, but it has the length of 12"),
        (12, len(STL_BINARY) - 1, "header of 12 facets would mean 684 bytes: it has 683"),
        (13, len(STL_BINARY), "header of 13 facets would mean 734 bytes: it has 684"),
        (0, len(STL_BINARY) - 1, "neither an ASCII STL nor a binary one"),
        (2**32 - 1, len(STL_BINARY), "neither an ASCII STL nor a binary one"),
    ],
)
def test_binary_whose_count_may_be_wrong_is_refused(count: int, size: int, message: str) -> None:
    data = STL_BINARY[:80] + count.to_bytes(4, "little") + STL_BINARY[84:]
    refused(data[:size], "stl", message)
