"""Files of public reports, in `faults` beside the folder of meshes, and what they have to give."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from filetests import exact
from meshes import folder

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.files import read_mesh

FAULTS = folder().parent / "faults"
NO_UV = "indices of texture coordinates that the file does not have"
NO_NORMALS = "indices of normals that the file does not have"
STRANGE = "lines that are no part of a facet ({!r})"


class Right(NamedTuple):
    """What a file has to give: counts, the area of its triangles, and what is named as lost."""

    vertices: int
    faces: int
    area: float
    lost: tuple[str, ...] = ()


CUBE, FACETS = Right(8, 6, 6), Right(8, 12, 6)
READ = {
    **dict.fromkeys(
        [
            "obj-bom.obj",
            "obj-bom-firstv.obj",
            "obj-cr-header-strict.obj",
            "obj-mixed-cr-g.obj",
            "obj-mixed-ends.obj",
            "obj-cont-space.obj",
            "obj-msvc-nan-vt.obj",
            "obj-usemtl-backslash-end.obj",
            "obj-utf16.obj",
            "off-bom.off",
            "off-glued.off",
            "ply-bom.ply",
            "ply-crlf-endheader-only.ply",
        ],
        CUBE,
    ),
    # These have a vertex of no face.
    **dict.fromkeys(
        ["obj-bom-shift.obj", "obj-cr-header.obj", "obj-o-backslash.obj"], Right(9, 6, 6)
    ),
    **dict.fromkeys(
        ["obj-body-comments.obj", "obj-mrgb.obj"],
        Right(8, 6, 6, ("comments below the first statement",)),
    ),
    "obj-missing-vn.obj": Right(8, 6, 6, (NO_NORMALS,)),
    "obj-missing-vt.obj": Right(8, 6, 6, (NO_UV, NO_NORMALS)),
    "obj-zero-vt.obj": Right(
        8, 6, 6, (NO_UV, NO_NORMALS, "texture coordinates that no face refers to")
    ),
    "off-comments.off": Right(8, 6, 6, ("comments among the numbers",)),
    "ply-strips-and-faces.ply": Right(8, 5, 2.5),
    **{
        f"stl-a-{name}.stl": FACETS
        for name in [
            "bom",
            "ctrlz",
            "end-loop",
            "end-solid",
            "facet-nonormal",
            "ind-normal",
            "mixed-cr",
        ]
    },
    "stl-a-color.stl": Right(8, 12, 6, (STRANGE.format("color 0.5 0.5 0.5"),)),
    "stl-a-comment.stl": Right(8, 12, 6, (STRANGE.format("# comment"),)),
    "stl-a-trailtext.stl": Right(8, 12, 6, (STRANGE.format("facets 12"),)),
    "stl-a-noend.stl": Right(8, 12, 6, ("the end of the last solid: it may be cut short",)),
    "stl-count0.stl": Right(8, 12, 6, ("the count of facets in the header, 0",)),
    "stl-trailing.stl": Right(8, 12, 6, ("2 bytes after the last facet",)),
    "stl-trailing-text.stl": Right(8, 12, 6, ("21 bytes after the last facet",)),
    "glb-mat3.glb": Right(86, 168, 12.055),
    "glb-ext-metadata.glb": Right(
        86,
        168,
        12.055,
        ("the glTF extensions EXT_mesh_features, EXT_structural_metadata, VRM, MSFT_lod",),
    ),
    "glb-rot-i8normal.glb": Right(86, 168, 12.055),
    "glb-scale-i8normal.glb": Right(86, 168, 48.35),
    **dict.fromkeys(
        ["glb-colour-one-of-two.glb", "glb-u8colour-one-of-two.glb", "glb-colours-u8-u16.glb"],
        Right(172, 336, 24.09),
    ),
    "poly-U8.obj": Right(16, 10, 30),
    "poly-H12.obj": Right(24, 14, 30),
    "poly-pacman20.obj": Right(40, 22, 12.38),
    "obj-keyhole.obj": Right(8, 1, 12),
}
REFUSED = {
    "ply-ascii-extra-columns.ply": "line 10: vertex 0 has 4 numbers, not 3 as the header says",
    "ply-ascii-face-extra.ply": "line 22: face 0 has 9 numbers, not 8 as the header says",
    "ply-dup-prop.ply": "line 7: vertex has the property 'x' twice",
    "glb-unknown-required.glb": "it needs the glTF extension VENDOR_mesh_magic, which is not read",
    "glb-instancing-required.glb": "it needs the glTF extension EXT_mesh_gpu_instancing",
    "glb-wrong-types/1-134.glb": "accessors[0].type is [0, 0, 0, 0], not a string",
    "glb-wrong-types/1-17.glb": "accessors is 4503599627370496, not an array",
    "glb-wrong-types/1-233.glb": "bufferViews[3].extensions is -0.0, not an object",
}


def reported(name: str) -> Path:
    path = FAULTS / name
    if not path.exists():
        pytest.skip(f"{name} is not in {FAULTS}")
    return path


@pytest.mark.parametrize("name", READ)
def test_what_is_read(name: str) -> None:
    mesh, right = read_mesh(reported(name)), READ[name]
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    assert (len(mesh.vertices), len(mesh.sizes)) == (right.vertices, right.faces)
    assert area == pytest.approx(right.area, rel=1e-3)
    assert mesh.lost == right.lost


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused(name: str) -> None:
    with pytest.raises(MeshError, match=exact(REFUSED[name])):
        read_mesh(reported(name))


@pytest.mark.parametrize("name", ["glb-rot-i8normal.glb", "glb-scale-i8normal.glb"])
def test_normals_turn_with_their_node(name: str) -> None:
    """The mean cosine of the normals with those of the faces around them."""
    mesh = read_mesh(reported(name))
    (normals,) = (one.values for one in mesh.attributes if one.name == "normal")
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    around = np.zeros((len(mesh.vertices), 3))
    for i in range(3):
        np.add.at(around, mesh.triangles[:, i], np.cross(b - a, c - a))
    products = (around * normals).sum(axis=1)
    lengths = np.linalg.norm(around, axis=1) * np.linalg.norm(normals.astype(float), axis=1)
    assert np.mean(products / lengths) > 0.98


def test_every_mesh_of_the_index_is_here() -> None:
    """Those of other rows: files whose fault is in the encoder or in the writers."""
    others = {
        "f32far.ply",
        "scale-denorm.obj",
        "sphere-big.obj",
        "sphere-tiny.obj",
        "scene-ground-and-ball.glb",
        "glb-ecef.glb",
        "glb-ecef-child.glb",
    }
    rows = reported("INDEX.tsv").read_text().splitlines()[1:]
    named = {name for row in rows for name in row.split("\t")[0].split()}
    files = {name for name in named if re.search(r"\.(obj|ply|off|stl|glb)$", name)}
    assert files - others == {name for name in READ | REFUSED if "/" not in name}
