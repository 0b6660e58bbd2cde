"""Writer of 3MF: an object for each object of the mesh, with positions where they are in space.

A triangle has a base material or colours, not both: where there are materials, colours are lost.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator
from typing import Final
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.file_format import Written
from deltamesh_formats.meshfiles.number_text import number_texts, rounded
from deltamesh_formats.meshfiles.threemf import THREEMF
from deltamesh_formats.meshfiles.threemf.archive import MODEL, MODEL_TYPE, RELATIONS
from deltamesh_formats.meshfiles.threemf.model import GREY
from deltamesh_formats.polymesh.colours import as_fractions
from deltamesh_formats.polymesh.descriptions import describe_attribute
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh
from deltamesh_formats.polymesh.units import METRES

_HEAD: Final = '<?xml version="1.0" encoding="UTF-8"?>\n'
_PACKAGE: Final = "http://schemas.openxmlformats.org/package/2006/"
_CORE: Final = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_COLOURS: Final = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02"
_MODEL_CONTENT: Final = "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"
_RELATION_CONTENT: Final = "application/vnd.openxmlformats-package.relationships+xml"
_DEFAULT_UNIT: Final = "millimeter"
# Of fractions that stand for bytes.
_NEAR: Final = 1e-6
_PROPERTIES: Final = 1  # the id of materials or colours; objects follow
# Characters that XML has no place for.
_NO_XML: Final = dict.fromkeys([*range(9), 11, 12, *range(14, 32), 0xFFFE, 0xFFFF], "?")


def write(mesh: PolyMesh) -> Written:
    """Write a 3MF; polygons become triangles, vertices of several objects are repeated."""
    if not np.isfinite(mesh.vertices).all():
        raise MeshError("3MF holds finite positions only")
    cut = mesh.triangulation()
    objects, materials = mesh.parts_of("object"), mesh.parts_of("material")
    of_face = np.full(len(mesh.sizes), -1) if objects is None else objects.of_face
    of_triangle = of_face[cut.polygon]
    names = () if objects is None else objects.names
    unit = (*mesh.metadata.get("units", ()), "")[0].lower()
    kept, colours, extra, group = None, None, [], ""
    properties = np.full((len(cut.faces), 3), -1)
    if materials is not None:
        properties[:] = materials.of_face[cut.polygon][:, None]
        bases = (f'<base name={_quoted(name)} displaycolor="{GREY}"/>' for name in materials.names)
        group = f'<basematerials id="{_PROPERTIES}">{"".join(bases)}</basematerials>\n'
    else:
        found = ((a, _bytes(a)) for a in mesh.attributes)
        kept, colours = next((one for one in found if one[1] is not None), (None, None))
    if kept is not None and colours is not None:
        owners = {"vertex": cut.faces, "corner": cut.corners, "face": cut.polygon[:, None]}
        properties[:] = kept.rows()[owners[kept.domain]]
        some = properties.min(axis=1) < 0
        if (properties[some] >= 0).any():
            extra.append(f"{describe_attribute(kept)} that not all corners of a face have")
        properties[some] = -1
        rows = (f'<m:color color="#{bytes(row).hex().upper()}"/>' for row in colours.tolist())
        group = f'<m:colorgroup id="{_PROPERTIES}">{"".join(rows)}</m:colorgroup>\n'
    lines = [
        f'{_HEAD}<model unit="{unit if unit in METRES else _DEFAULT_UNIT}" xml:lang="en-US"'
        f' xmlns="{_CORE}" xmlns:m="{_COLOURS}">\n<resources>\n{group}'
    ]
    texts = np.array(number_texts(rounded(mesh.vertices, mesh.margin)), dtype=object)
    alone = np.flatnonzero(np.bincount(mesh.corners, minlength=len(mesh.vertices)) == 0)
    numbers = np.unique(of_triangle).tolist()
    for number in numbers:
        mine = of_triangle == number
        vertices = np.union1d(cut.faces[mine], alone if number == numbers[0] else [])
        faces = np.searchsorted(vertices, cut.faces[mine])
        name = names[number] if number >= 0 else ""
        lines.append(
            f'<object id="{number + 2 + _PROPERTIES}" type="model"'
            f"{f' name={_quoted(name)}' if name else ''}><mesh>\n<vertices>\n"
        )
        points = texts.reshape(-1, 3)[vertices.astype(np.int64)]
        lines.append(len(points) * '<vertex x="%s" y="%s" z="%s"/>\n' % tuple(points.ravel()))
        lines.append("</vertices>\n<triangles>\n")
        lines += _triangles(faces, properties[mine])
        lines.append("</triangles>\n</mesh></object>\n")
    items = (f'<item objectid="{number + 2 + _PROPERTIES}"/>\n' for number in numbers)
    lines.append(f"</resources>\n<build>\n{''.join(items)}</build>\n</model>\n")
    if unit and unit not in METRES:
        extra.append(f"the unit {unit[:40]!r}")
    lost = THREEMF.losses(mesh, [] if kept is None else [kept])
    return Written(_package("".join(lines)), (*lost, *extra))


def _triangles(faces: Ints, properties: Ints) -> Iterator[str]:
    plain = '<triangle v1="%d" v2="%d" v3="%d"/>\n'
    with_properties = plain[:-3] + f' pid="{_PROPERTIES}" p1="%d" p2="%d" p3="%d"/>\n'
    has = properties[:, 0] >= 0
    for face, row, some in zip(faces.tolist(), properties.tolist(), has.tolist(), strict=True):
        yield with_properties % (*face, *row) if some else plain % tuple(face)


def _bytes(attribute: Attribute) -> NDArray[np.uint8] | None:
    """Return the rows of colours as bytes, None for what is no colour or would be rounded."""
    if attribute.role != "colour" or attribute.width not in (3, 4):
        return None
    values = as_fractions(attribute.values, normalized=attribute.normalized)
    if not (
        np.isfinite(values).all() and values.min(initial=0) >= 0 and values.max(initial=0) <= 1
    ):
        return None
    found: NDArray[np.uint8] = np.rint(255 * values).astype(np.uint8)
    if np.abs(found / 255 - values).max(initial=0) > max(attribute.margin, _NEAR):
        return None
    return found


def _quoted(name: str) -> str:
    valid = name.encode("utf-8", "surrogateescape").decode("utf-8", "replace")
    return quoteattr(valid.translate(_NO_XML))


def _package(model: str) -> bytes:
    types = (("rels", _RELATION_CONTENT), ("model", _MODEL_CONTENT))
    defaults = "".join(f'<Default Extension="{a}" ContentType="{b}"/>' for a, b in types)
    relation = f'<Relationship Target="/{MODEL}" Id="rel0" Type="{MODEL_TYPE}"/>'
    files = {
        "[Content_Types].xml": f'<Types xmlns="{_PACKAGE}content-types">{defaults}</Types>\n',
        RELATIONS: f'<Relationships xmlns="{_PACKAGE}relationships">{relation}</Relationships>\n',
        MODEL: model,
    }
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            info = zipfile.ZipInfo(name)  # of 1980: the same mesh gives the same bytes
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, text if text.startswith(_HEAD) else _HEAD + text)
    return target.getvalue()
