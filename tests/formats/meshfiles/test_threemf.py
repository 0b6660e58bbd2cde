"""3MF: objects, components, materials and colours; what others make of our files; damage."""

from __future__ import annotations

import io
import zipfile
from dataclasses import replace

import numpy as np
import pytest
from filetests import again, named, polygons, read, refused, rows

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.files import written
from deltamesh_formats.meshfiles.threemf import THREEMF
from deltamesh_formats.meshfiles.threemf.archive import MODEL, MODEL_TYPE, Archive
from deltamesh_formats.meshfiles.threemf.model import read_model
from deltamesh_formats.meshfiles.threemf.reader import read as read_threemf
from deltamesh_formats.meshfiles.threemf.writer import write
from deltamesh_formats.polymesh.arrays import from_arrays
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh

MESH = (
    '<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>'
    '<vertex x="0" y="1e0" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles>{}'
    "</triangles></mesh>"
)
PLAIN = '<triangle v1="0" v2="1" v3="2"/><triangle v1="0" v2="1" v3="3"/>'
POINTS = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
MOVE = 'transform="1 0 0 0 1 0 0 0 1 5 6 7"'
MIRROR = 'transform="-1 0 0 0 1 0 0 0 1 0 0 0"'


def model(resources: str, build: str, head: str = "") -> str:
    spaces = 'xmlns="core" xmlns:m="materials" xmlns:p="production" xmlns:x="other"'
    body = f"<resources>{resources}</resources><build>{build}</build>"
    return f'<?xml version="1.0"?><model unit="inch" {spaces}>{head}{body}</model>'


def package(*files: tuple[str, str]) -> bytes:
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files:
            archive.writestr(name, text)
    return target.getvalue()


def file(resources: str, build: str, head: str = "") -> bytes:
    return package((MODEL, model(resources, build, head)))


def one(triangles: str, groups: str = "", fields: str = "") -> bytes:
    resource = f'{groups}<object id="1" {fields}>{MESH.format(triangles)}</object>'
    return file(resource, '<item objectid="1"/>')


def test_one_object() -> None:
    mesh = read(one(PLAIN), "3mf")
    np.testing.assert_array_equal(mesh.vertices, POINTS)
    assert polygons(mesh) == [[0, 1, 2], [0, 1, 3]]
    assert (mesh.parts, mesh.lost, mesh.metadata) == ((), (), {"units": ("inch",)})
    assert read_threemf(one(PLAIN)).precision == mesh.precision == "float64"


def test_objects_are_placed() -> None:
    ball = f'<object id="1" name="ball &amp; x">{MESH.format(PLAIN)}</object>'
    both = f'<object id="2" name="both"><components><component objectid="1" {MOVE}/></components>'
    resources = f'{ball}{both}</object><object id="9">{MESH.format(PLAIN)}</object>'
    data = file(resources, f'<item objectid="2" {MOVE}/><item objectid="1" {MIRROR}/>')
    mesh = read(data, "3mf")
    np.testing.assert_array_equal(mesh.vertices[:4], np.add(POINTS, [10, 12, 14]))
    np.testing.assert_array_equal(mesh.vertices[4:], np.multiply(POINTS, [-1, 1, 1]))
    assert polygons(mesh) == [[0, 1, 2], [0, 1, 3], [6, 5, 4], [7, 5, 4]]
    assert named(mesh, "object") == ["ball & x"] * 4
    objects = mesh.parts_of("object")
    np.testing.assert_array_equal(objects.transforms[:, :3, 3], [[10, 12, 14], [0, 0, 0]])
    assert set(mesh.lost) == {
        "the hierarchy of components",
        "objects that are not built",
        "the sharing of an object",
    }


def test_models_in_other_files() -> None:
    relation = f'<Relationships><Relationship Type="{MODEL_TYPE}" Target="/3D/A.model"/>'
    inner = f'<object id="1" name="inner">{MESH.format(PLAIN)}</object>'
    outer = '<object id="1"><components><component objectid="1" p:path="/3D/b.model"/>'
    data = package(
        ("_rels/.rels", f"{relation}</Relationships>"),
        ("3D/a.model", model(f"{outer}</components></object>", '<item objectid="1"/>')),
        ("3D/b.model", model(inner, '<item objectid="77"/>')),
    )
    assert Archive(data).model() == "/3D/A.model"
    assert named(read(data, "3mf"), "object") == ["inner", "inner"]


def test_materials_and_colours() -> None:
    bases = '<basematerials id="5"><base name="red" displaycolor="#FF0000"/><base name=""/>'
    group = f'{bases}</basematerials><m:colorgroup id="6"><m:color color="#010203"/>'
    group += '<m:color color="#0405067F"/></m:colorgroup>'
    triangles = (
        '<triangle v1="0" v2="1" v3="2"/><triangle v1="0" v2="1" v3="3" p1="1"/>'
        '<triangle v1="0" v2="1" v3="3" pid="6" p1="0" p2="1" p3="0"/>'
        '<triangle v1="0" v2="1" v3="3" pid="6" p1="1"/>'
        '<triangle v1="0" v2="1" v3="3" pid="99" p1="1"/>'
    )
    mesh = read(one(triangles, group, 'pid="5" pindex="0"'), "3mf")
    assert named(mesh, "material") == ["red", "material_1", None, None, None]
    a, b = [1, 2, 3, 255], [4, 5, 6, 127]
    assert rows(mesh, "colour", "corner") == [None] * 6 + [a, b, a, b, b, b] + [None] * 3
    assert set(mesh.lost) == {"the look of materials", "properties of triangles"}


def test_what_is_left_out_is_named() -> None:
    head = '<metadata name="Title">x</metadata><x:thing/>'
    extra = '<m:texture2d id="3" path="/a.png"/>'
    resource = f'{extra}<object id="1" partnumber="7">{MESH.format(PLAIN)}</object>'
    mesh = read(file(resource, '<item objectid="1"/>', head), "3mf")
    assert mesh.lost == ("metadata", "thing elements", "textures", "part numbers")
    assert read_model(one(PLAIN)).lost == {}


COLOURS = np.array([[0, 1, 2], [3, 4, 5], [255, 254, 253], [0, 0, 0]], dtype=np.uint8)


@pytest.mark.parametrize("domain", ["vertex", "corner", "face"])
def test_colours_come_back(domain: str) -> None:
    mesh = from_arrays(POINTS, [[0, 1, 2], [3, 2, 1]])
    count = {"vertex": 4, "corner": 6, "face": 2}[domain]
    index = np.arange(count) % 4
    index[-1] = -1
    colour = Attribute("colour", domain, COLOURS, "colour", index, normalized=True)
    mesh = replace(mesh, attributes=(colour,))
    made = written(mesh, "3mf")
    back = rows(read(made.data, "3mf"), "colour", "corner")
    table = COLOURS.tolist()
    expected = {
        "vertex": [*table[:3], None, None, None],
        "corner": [*table[:3], None, None, None],
        "face": [table[0]] * 3 + [None] * 3,
    }[domain]
    assert back == expected
    assert any("not all corners" in words for words in made.lost) == (domain != "face")


def test_colours_that_are_no_bytes_are_named() -> None:
    mesh = from_arrays(POINTS, [[0, 1, 2]], vertex={"colour": np.full((4, 3), 0.123)})
    assert written(mesh, "3mf").lost == ("colours",)
    exact = from_arrays(POINTS, [[0, 1, 2]], vertex={"colour": np.full((4, 3), 51 / 255)})
    assert written(exact, "3mf").lost == ()


def test_materials_win_over_colours() -> None:
    mesh = from_arrays(POINTS, [[0, 1, 2]], vertex={"colour": COLOURS})
    mesh = replace(mesh, parts=(Parts("material", ('a "b" <c>\x01',), np.array([0])),))
    assert written(mesh, "3mf").lost == ("colours",)
    assert named(again(mesh, "3mf"), "material") == ['a "b" <c>?']


def test_units_are_kept_or_named() -> None:
    mesh = replace(from_arrays(POINTS, [[0, 1, 2]]), metadata={"units": ("micron",)})
    assert again(mesh, "3mf").metadata == {"units": ("micron",)}
    assert written(mesh, "obj").lost == ("the unit",)
    odd = replace(mesh, metadata={"units": ("furlong",)})
    assert written(odd, "3mf").lost == ("the unit 'furlong'",)
    assert write(odd).lost == ("the unit 'furlong'",)


def test_objects_are_read_by_others() -> None:
    trimesh = pytest.importorskip("trimesh")
    for package_ in ("lxml", "networkx"):
        pytest.importorskip(package_)
    objects = Parts("object", ("first", "second"), np.array([0, 1]))
    mesh = replace(from_arrays(POINTS, [[0, 1, 2], [3, 2, 1]]), parts=(objects,))
    data = written(mesh, THREEMF.name).data
    scene = trimesh.load_scene(io.BytesIO(data), file_type="3mf", process=False)
    assert list(scene.geometry) == ["first", "second"]
    assert len(scene.geometry["second"].faces) == 1
    ours = again(mesh, "3mf")
    assert named(ours, "object") == ["first", "second"]


def with_vertices(mesh: PolyMesh, count: int) -> bool:
    return len(mesh.vertices) == count


def test_isolated_vertices_are_kept() -> None:
    objects = Parts("object", ("a", "b"), np.array([0, 1]))
    mesh = replace(from_arrays([*POINTS, [9, 9, 9]], [[0, 1, 2], [0, 1, 2]]), parts=(objects,))
    assert with_vertices(again(mesh, "3mf"), 8)


LOOP = '<object id="1"><components><component objectid="1"/></components></object>'
TWENTY = 20 * '<component objectid="{}"/>'
LAUGHS = "".join(
    f'<object id="{i}"><components>{TWENTY.replace("{}", str(i + 1))}</components></object>'
    for i in range(30)
)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "it is no ZIP"),
        (b"PK\3\4", "it is no ZIP"),
        (package(("a", "b")), "it has no file '3D/3dmodel.model'"),
        (package((MODEL, "<model>")), "not readable as XML"),
        (package((MODEL, '<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>')), "has a document type"),
        (one('<triangle v1="0" v2="1" v3="4"/>'), "object 1 has a face with vertex 4, of 4"),
        (one('<triangle v1="0" v2="1" v3="-1"/>'), "object 1 has a face with vertex -1, of 4"),
        (one('<triangle v1="0" v2="1"/>'), "a triangle has no v3"),
        (one('<triangle v1="0" v2="1" v3="x"/>'), "a triangle is not readable"),
        (one(PLAIN + '<triangle v1="0" v2="1" v3="9999999999999999999999"/>'), "a triangle is not"),
        (one(PLAIN)[:-9], "it is no ZIP"),
        (file(LOOP, '<item objectid="1"/>'), "repeat themselves"),
        (
            file(f'{LAUGHS}<object id="30"/>', '<item objectid="0"/>'),
            "repeat themselves, or are too many",
        ),
        (file("", '<item objectid="4"/>'), "there is no object '4'"),
        (file("<object/>", ""), "a object has no id|an object has no id"),
        (file('<object id="1" name="a"/><object id="1"/>', ""), "two objects have the id 1"),
        (file("", '<item objectid="1" transform="1 2"/>'), "a transform is not 12 numbers"),
        (
            one(
                '<triangle v1="0" v2="1" v3="2" pid="6" p1="3"/>',
                '<m:colorgroup id="6"><m:color color="#010203"/></m:colorgroup>',
            ),
            "a triangle has colour 3, of 1",
        ),
        (
            one(
                '<triangle v1="0" v2="1" v3="2" pid="6" p1="1"/>',
                '<basematerials id="6"><base name="a"/></basematerials>',
            ),
            "base material 1",
        ),
        (one(PLAIN, '<m:colorgroup id="6"><m:color color="red"/></m:colorgroup>'), "a color is"),
    ],
)
def test_what_is_wrong_is_refused(data: bytes, message: str) -> None:
    refused(data, "3mf", message)


def test_a_damaged_archive_is_refused() -> None:
    data = bytearray(written(from_arrays(POINTS, [[0, 1, 2]]), "3mf").data)
    at = data.index(b"3D/3dmodel.model") + 60
    data[at] ^= 0xFF
    refused(bytes(data), "3mf", "damaged|not readable")


def test_files_without_objects_have_no_surface() -> None:
    with pytest.raises(MeshError):
        read(file("", ""), "3mf")
