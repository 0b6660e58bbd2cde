"""ZIP with one mesh file in it: companions, what else is there, and what is refused."""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path

import pytest
from cubes import OBJ, OFF, STL, is_cube
from filetests import exact, read, refused
from test_glb import gltf_tree

from deltamesh_formats.errors import MeshError, NoSurfaceError
from deltamesh_formats.meshfiles import formats
from deltamesh_formats.meshfiles.files import read_mesh, written
from deltamesh_formats.meshfiles.zip_files import opened, reading
from deltamesh_formats.meshfiles.zipped import ZIP
from deltamesh_formats.meshfiles.zipped.reader import read as read_zip
from deltamesh_formats.wrappers import wrapped


def packed(**files: str | bytes) -> bytes:
    """A ZIP; the names have __ for a slash and _ for a dot."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name.replace("__", "/").replace("_", "."), data)
    return stream.getvalue()


@pytest.mark.parametrize("name", ["cube_obj", "deep__in__cube_OBJ"])
def test_the_one_mesh_is_read(name: str, tmp_path: Path) -> None:
    data = packed(**{name: OBJ})
    mesh = read(data, "zip")
    assert is_cube(mesh)
    assert (mesh.format, mesh.lost) == ("obj", ())
    (tmp_path / "a.zip").write_bytes(data)
    assert is_cube(read_mesh(tmp_path / "a.zip"))


def test_a_compressed_mesh_in_it() -> None:
    mesh = read(packed(cube_stl_gz=wrapped("a.gz", STL.encode())), "zip")
    assert is_cube(mesh)
    assert mesh.format == "stl"


def test_texture_coordinates_begin_where_the_format_has_their_origin() -> None:
    text = OBJ.replace("f ", "vt 0.25 0\nvt 0 1\nf ", 1).replace("f 1 3 4 2", "f 1/1 3/2 4/1 2/2")
    made = written(read(text, "obj"), "glb").data
    assert made == written(read(packed(a_obj=text), "zip"), "glb").data
    back = read(packed(a_glb=made), "zip")
    assert back.format == "glb"
    assert written(back, "obj").data == written(read(made, "glb"), "obj").data


def test_companions_are_read_and_others_named() -> None:
    tree, buffer = gltf_tree()
    tree["buffers"][0]["uri"] = "data/a%20b.bin"
    whole = packed(
        **{"s__scene_gltf": json.dumps(tree), "s__data__a b_bin": buffer, "readme_txt": "hello"}
    )
    mesh = read(whole, "zip")
    assert mesh.format == "gltf"
    assert mesh.lost[-1] == "other files of the ZIP (readme.txt)"
    assert len(mesh.triangles)
    refused(packed(s__scene_gltf=json.dumps(tree)), "zip", "buffer 0 .*which is not there")
    for uri in ("../../a.bin", "/etc/hostname", "a/../../../a.bin"):
        tree["buffers"][0]["uri"] = uri
        data = packed(s__scene_gltf=json.dumps(tree), a_bin=buffer)
        refused(data, "zip", "s/scene.gltf: buffer 0 .*outside the folder")
    tree["buffers"][0]["uri"] = "../a.bin"
    assert len(read(packed(s__scene_gltf=json.dumps(tree), a_bin=buffer), "zip").triangles)


def test_what_systems_put_there_is_left_out() -> None:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.mkdir("empty")
        for name in ("__MACOSX/._a.off", "a/.DS_Store", "Thumbs.db", ".x/b.off", "a/a.off"):
            archive.writestr(name, OFF)
    mesh = read(stream.getvalue(), "zip")
    assert is_cube(mesh)
    assert mesh.lost == ()


def test_none_and_several_are_refused_by_name() -> None:
    refused(packed(), "zip", "the ZIP has no mesh file in it: it is empty")
    refused(packed(a_txt="", b_zip=packed(a_off=OFF)), "zip", exact("in it: a.txt, b.zip"))
    two = packed(**{"a_off": OFF, "b__b_obj": OBJ, "c_png": b""})
    refused(two, "zip", exact("the ZIP has 2 mesh files in it: a.off, b/b.obj; unpack it"))
    many = packed(**{f"{i}_obj": OBJ for i in range(9)})
    refused(many, "zip", "9 mesh files in it: 0.obj, 1.obj, 2.obj, 3.obj and 5 more")


def test_the_fault_of_the_mesh_is_that_of_a_file_in_it() -> None:
    refused(packed(a__a_obj=OBJ + "f 1 2 99\n"), "zip", "a/a.obj: .*vertex 99, of 8")
    with pytest.raises(NoSurfaceError, match="it holds 2 vertices but no faces"):
        read(packed(a_obj="v 0 0 0\nv 1 0 0\n"), "zip")


@pytest.mark.parametrize("cut", [0, 3, 60, -30])
def test_what_is_no_zip_is_refused(cut: int) -> None:
    refused(packed(a_obj=OBJ)[:cut], "zip", "it is no ZIP")


def test_damaged_and_encrypted_files_are_refused() -> None:
    data = bytearray(packed(a_obj=OBJ))
    damaged = bytearray(data)
    damaged[60] ^= 0xFF
    refused(bytes(damaged), "zip", r"its a\.obj is damaged or encrypted")
    data[6] |= 1
    at = data.find(b"PK\x01\x02")
    data[at + 8] |= 1
    refused(bytes(data), "zip", r"its a\.obj is damaged or encrypted")
    with pytest.raises(MeshError, match="its a is damaged"), reading("a"):
        raise EOFError("end")
    assert opened(packed(a_obj=OBJ)).namelist() == ["a.obj"]
    assert is_cube(read_zip(packed(a_obj=OBJ)))


def test_it_is_only_read() -> None:
    assert formats.written_format("zip") is None
    assert formats.format_of_extension(".ZIP") is ZIP
    assert formats.advice("zip") == ""
