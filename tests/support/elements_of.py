"""Elements with the neighbours that a test gives them."""

from __future__ import annotations

import numpy as np

from deltamesh._graph import elements
from deltamesh._graph.elements import Elements
from deltamesh._shape.polygons import Polygons, plain
from deltamesh_formats.array_types import Ints


def of_rows(F: Ints, polygons: Polygons) -> Elements:
    return elements.of_polygons(F, polygons.offsets, polygons.of_corners)


def of_faces(F: Ints) -> Elements:
    return of_rows(F, plain(len(F)))


def rows(elements: Elements) -> list[list[int]]:
    return [row.tolist() for row in np.split(elements.indices, elements.indptr[1:-1])]
