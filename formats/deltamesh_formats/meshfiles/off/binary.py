"""Reader of binary OFF, in both layouts that writers use.

The standard is big-endian, with a count of colour components after each face. Files of the Polygon
Mesh Processing library are little-endian and have no such counts. Only the length of the file
decides between them: the records have to fill it.
"""

from __future__ import annotations

import itertools

import numpy as np

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.ply.body import Binary
from deltamesh_formats.meshfiles.ply.header import Element, Property
from deltamesh_formats.meshfiles.ply.records import read_rows
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh, Role

_COUNTS = Element("header", 1, [Property(name, "i4") for name in ("n", "m", "edges")])


def read_binary(data: bytes, widths: list[tuple[Role, int]]) -> PolyMesh:
    """Read the bytes after the first line.

    Parameters
    ----------
    data : bytes
    widths : list of (role, int)
        Columns after x, y and z in the record of a vertex.

    Raises
    ------
    MeshError
        When the length fits neither form.
    """
    for order, coloured in itertools.product("><", (True, False)):
        try:
            found = _read(Binary(data, order), widths, coloured)
        except MeshError:
            continue
        if found is not None:
            return found
    message = "its length does not fit its counts, in either byte order: is it cut short?"
    raise MeshError(message)


def _read(body: Binary, widths: list[tuple[Role, int]], coloured: bool) -> PolyMesh | None:
    counts, at = read_rows(body, 0, _COUNTS)
    n, m = int(counts["n"].values[0]), int(counts["m"].values[0])
    if n < 0 or m < 0:
        return None
    width = 3 + sum(width for _, width in widths)
    record = Element("vertex", n, [Property(str(i), "f4") for i in range(width)])
    columns, at = read_rows(body, at, record)
    lists = [Property("indices", "i4", "i4"), Property("colour", "f4", "i4")]
    faces, at = read_rows(body, at, Element("face", m, lists[: 1 + coloured]))
    sizes = faces["indices"].counts
    assert sizes is not None
    # A face without corners would be a count of colour components, none.
    if at != len(body.data) or not (coloured or sizes.all()):
        return None
    values = np.stack([column.values for column in columns.values()], axis=1)
    attributes, begin = [], 3
    for role, width in widths:
        attributes.append(Attribute(role, "vertex", values[:, begin : begin + width], role))
        begin += width
    lost = []
    if coloured and len(faces["colour"].values):
        components = faces["colour"].counts
        assert components is not None
        has = components == components.max()
        if np.isin(components, (0, components.max())).all():
            table = faces["colour"].values.reshape(-1, components.max())
            index = None if has.all() else np.where(has, np.cumsum(has) - 1, -1)
            attributes.append(Attribute("colour", "face", table, "colour", index))
        else:
            lost.append("colours of faces, whose components differ in number")
    return PolyMesh(
        values[:, :3].astype(np.float64),
        faces["indices"].values.astype(np.int64),
        np.concatenate(([0], np.cumsum(sizes))).astype(np.int64),
        tuple(attributes),
        lost=tuple(lost),
        precision="float32",
    )
