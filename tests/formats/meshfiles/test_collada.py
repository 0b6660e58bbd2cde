"""COLLADA, which trimesh reads: placed meshes, corners, what is named, and what is refused."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from filetests import named, polygons, read, refused, rows

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.by_trimesh import COLLADA
from deltamesh_formats.meshfiles.by_trimesh.reader import read_collada
from deltamesh_formats.meshfiles.files import written
from deltamesh_formats.polymesh.arrays import from_arrays

FILE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.01" name="cm"/></asset>
<library_geometries><geometry id="roof"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 1 1 0 0 1 0</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<source id="n"><float_array id="na" count="6">0 0 1 0 1 0</float_array>
<technique_common><accessor source="#na" count="2" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
{primitive}
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">
<node id="a"><instance_geometry url="#roof"/></node>
<node id="b"><translate>0 0 5</translate><instance_geometry url="#roof"/></node>
</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""
INPUTS = '<input semantic="VERTEX" source="#v" offset="0"/>'
INPUTS += '<input semantic="NORMAL" source="#n" offset="1"/>'
TRIANGLES = f'<triangles count="2">{INPUTS}<p>0 0 1 0 2 1 0 0 2 0 3 0</p></triangles>'
QUAD = f'<polylist count="1">{INPUTS}<vcount>4</vcount><p>0 0 1 0 2 0 3 0</p></polylist>'


@pytest.fixture
def packages() -> None:
    pytest.importorskip("trimesh")
    pytest.importorskip("collada")


@pytest.mark.usefixtures("packages")
def test_meshes_are_placed_and_share_vertices() -> None:
    mesh = read(FILE.format(primitive=TRIANGLES), "dae")
    assert (len(mesh.vertices), mesh.format, mesh.lost) == (8, COLLADA.name, ())
    assert polygons(mesh) == [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]
    assert mesh.vertices[:, 2].tolist() == [0] * 4 + [5] * 4
    up, back = [0, 0, 1], [0, 1, 0]
    assert rows(mesh, "normal", "corner") == [up, up, back, up, up, up] * 2
    names = named(mesh, "object")
    assert names[0].startswith("roof")
    assert names[0] == names[1] != names[2] == names[3]
    assert mesh.parts_of("object").transforms[1, :3, 3].tolist() == [0, 0, 5]
    assert mesh.metadata == {"units": ("centimeter",)}
    odd = FILE.replace("0.01", "0.3").format(primitive=TRIANGLES)
    assert read(odd, "dae").metadata == {"units": ("0.3 meter",)}


@pytest.mark.usefixtures("packages")
def test_what_trimesh_changes_is_named() -> None:
    mesh = read(FILE.format(primitive=QUAD), "dae")
    assert mesh.lost == ("polygons of more than three corners",)
    assert len(mesh.triangles) == 4
    three = QUAD.replace("<vcount>4", "<vcount>3").replace(" 3 0</p>", "</p>")
    assert read(FILE.format(primitive=three), "dae").lost == ()
    lines = f"<lines count='1'>{INPUTS}<p>0 0 1 0</p></lines>"
    assert read(FILE.format(primitive=TRIANGLES + lines), "dae").lost == ("lines",)


PAIRS = """<source id="t"><float_array id="ta" count="6">0 0 1 0 1 1</float_array>
<technique_common><accessor source="#ta" count="3" stride="2"><param name="S" type="float"/>
<param name="T" type="float"/></accessor></technique_common></source>"""


def with_inputs(*semantics: str) -> str:
    """The file with further numbers of corners; colours have the numbers of normals."""
    sources = {"TEXCOORD": "#t", "COLOR": "#n"}
    inputs = "".join(
        f'<input semantic="{one}" source="{sources[one]}" offset="1" set="{i}"/>'
        for i, one in enumerate(semantics)
    )
    text = FILE.format(primitive=TRIANGLES.replace("<p>", f"{inputs}<p>"))
    return text.replace("<vertices", f"{PAIRS}<vertices")


LOOK = """<library_effects><effect id="e"><profile_COMMON><technique sid="c"><lambert/></technique>
</profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries>"""
BOUND = """<instance_geometry url="#roof"><bind_material><technique_common>
<instance_material symbol="red" target="#m"/></technique_common></bind_material>
</instance_geometry>"""


def looking(text: str) -> str:
    text = text.replace("<library_geometries>", LOOK).replace(
        "<triangles ", '<triangles material="red" '
    )
    return text.replace('<instance_geometry url="#roof"/>', BOUND)


UNBOUND = "texture coordinates of meshes without a material"
UP = "<asset><up_axis>Z_UP</up_axis>"


@pytest.mark.usefixtures("packages")
@pytest.mark.parametrize(
    ("text", "lost"),
    [
        (
            FILE.format(primitive=TRIANGLES).replace('id="a"', 'id="a" name="left"'),
            "names of nodes",
        ),
        (FILE.format(primitive=TRIANGLES).replace("<asset>", UP), "the axis that points up (Z)"),
        (FILE.format(primitive=TRIANGLES).replace("<asset>", UP.replace("Z", "Y")), None),
        (with_inputs("TEXCOORD"), UNBOUND),
        (with_inputs("TEXCOORD", "TEXCOORD"), f"further texture coordinates, {UNBOUND}"),
        (looking(with_inputs("TEXCOORD")), "the look of materials"),
        (
            looking(with_inputs("TEXCOORD", "TEXCOORD")),
            "the look of materials, further texture coordinates",
        ),
        (with_inputs("COLOR"), "colours beyond 8 bits"),
        (with_inputs("COLOR", "COLOR"), "further colours, colours beyond 8 bits"),
        (
            looking(with_inputs("COLOR")),
            "the look of materials, colours of meshes with a material",
        ),
    ],
)
def test_names_axes_and_numbers_of_corners_that_trimesh_leaves_out(
    text: str, lost: str | None
) -> None:
    for data in (text.encode(), text.encode("utf-16")):
        mesh = read(data, "dae")
        assert ", ".join(mesh.lost) == (lost or "")
        assert (len(mesh.vertices), len(mesh.triangles)) == (8, 4)
    roles = [one.role for one in mesh.attributes]
    assert ("uv" in roles) == ("TEXCOORD" in text and UNBOUND not in str(lost))
    assert ("colour" in roles) == ("beyond 8 bits" in str(lost))


@pytest.mark.usefixtures("packages")
def test_parts_that_are_not_readable_are_named() -> None:
    broken = TRIANGLES.replace("<p>", '<input semantic="NORMAL" source="#none" offset="1"/><p>')
    text, bad = FILE.format(primitive=TRIANGLES), FILE.format(primitive=broken)
    start, end = (bad.index(tag) for tag in ("<geometry", "</library_geometries>"))
    second = bad[start:end].replace('"roof"', '"bad"')
    mesh = read(text.replace("</library_geometries>", f"{second}</library_geometries>"), "dae")
    assert (len(mesh.vertices), len(mesh.triangles)) == (8, 4)
    (lost,) = mesh.lost
    assert lost.startswith("parts that are not readable (")
    refused(bad, "dae", "trimesh reads no mesh of it: it has parts that")


@pytest.mark.usefixtures("packages")
def test_a_file_without_meshes_is_refused_with_what_it_has() -> None:
    empty = FILE.format(primitive=TRIANGLES).replace('<instance_geometry url="#roof"/>', "")
    refused(empty, "dae", "it holds no mesh: no vertices and no faces$")
    moves = "<library_animations><animation id='a'/></library_animations><library_visual"
    moving = empty.replace("<library_visual", moves, 1)
    refused(moving, "dae", r"no vertices and no faces \(and animations\)$")


@pytest.mark.usefixtures("packages")
def test_what_is_no_collada_is_refused() -> None:
    refused(b"", "dae", "trimesh cannot read it")
    refused(b"<a/>", "dae", "trimesh cannot read it")
    refused(b"<!DOCTYPE a><a/>", "dae", "document type")


@pytest.mark.parametrize(("module", "package"), [("trimesh", "trimesh"), ("collada", "pycollada")])
def test_a_missing_package_is_named(
    module: str, package: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "collada", sys)  # it need not be there for this
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(MeshError, match=f"the package {package}: python -m pip install {package}"):
        read_collada(b"<COLLADA/>")


def test_it_is_not_written() -> None:
    mesh = from_arrays(np.eye(3), [[0, 1, 2]])
    with pytest.raises(MeshError, match="COLLADA is only read; written are obj, ply"):
        written(mesh, "dae")
