"""What the tests of mesh files share."""

from __future__ import annotations

import io
import re

import numpy as np
import pytest

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.files import read_mesh, written
from deltamesh_formats.polymesh.mesh import PolyMesh

POINTS = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.5, 0.25, 8]]


def read(data: bytes | str, file_format: str) -> PolyMesh:
    raw = data.encode("utf-8", "surrogateescape") if isinstance(data, str) else data
    return read_mesh(io.BytesIO(raw), file_format)


def again(mesh: PolyMesh, file_format: str) -> PolyMesh:
    return read(written(mesh, file_format).data, file_format)


def refused(data: bytes | str, file_format: str, message: str = ".") -> None:
    with pytest.raises(MeshError, match=message) as caught:
        read(data, file_format)
    assert str(caught.value).startswith("<stream>: ")
    assert "Error: " not in str(caught.value), "a bug of the reader, not a fault of the file"


def polygons(mesh: PolyMesh) -> list[list[int]]:
    return [part.tolist() for part in np.split(mesh.corners, mesh.offsets[1:-1])]


def rows(mesh: PolyMesh, name: str, domain: str) -> list[list[float] | None]:
    """The values of an attribute, element by element."""
    (attribute,) = (a for a in mesh.attributes if (a.name, a.domain) == (name, domain))
    table = [*attribute.values.tolist(), None]
    return [table[i] for i in attribute.rows().tolist()]


def named(mesh: PolyMesh, kind: str) -> list[str | None]:
    """The name of the part of each face."""
    parts = mesh.parts_of(kind)
    assert parts is not None
    return [None if i < 0 else parts.names[i] for i in parts.of_face.tolist()]


def exact(text: str) -> str:
    return re.escape(text)
