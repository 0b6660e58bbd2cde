"""Files of anchors: what they say, and the positions that other systems and no fit make of it."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, NamedTuple

import corpus
import numpy as np

from deltamesh._geometry import positions
from deltamesh._geometry.integers import NO_CELLS, NONE, Integers
from deltamesh._geometry.methods import geometry_codec
from deltamesh._geometry.systems import Systems
from deltamesh._kernels.mesh import laplacian
from deltamesh._mesh import TriangleMesh
from deltamesh._options import Options
from deltamesh._pipeline import Encoded, encode_mesh, read_content
from deltamesh._shape.surface import Surface
from deltamesh_formats.array_types import Floats
from deltamesh_formats.container.container import Parameters

# Steps of deltas in the diagonal of a mesh whose spikes are measured.
STEPS: Final = 2000


class File(NamedTuple):
    """What a file of anchors says, and the positions that it was made of, (n, 3)."""

    surface: Surface
    V: Floats
    parameters: Parameters
    integers: Integers
    size: int

    @property
    def decoded(self) -> Floats:
        """The positions of the vertices of the faces, (n, 3)."""
        return self.positions(Systems(self.surface))

    def positions(self, systems: Systems) -> Floats:
        """Return the positions that some systems solve for, (n, 3)."""
        coder = geometry_codec(self.parameters.method)
        found = coder.reconstruct(self.surface, self.parameters, self.integers, systems)
        return found[: len(self.V)]

    def errors(self, W: Floats) -> Floats:
        """Return the error of the delta of each vertex, float64 (n,), where positions are W."""
        return np.linalg.norm(laplacian.apply(*self.surface.graph, W - self.V), axis=1)

    @property
    def copied(self) -> File:
        """The same deltas, with anchors at the vertices' own positions, and no fit."""
        p, integers = positions.placed(
            self.V[self.integers.anchors], self.V, self.V[:0], self.parameters, self.integers
        )
        return self._replace(parameters=p, integers=replace(integers, cells=NO_CELLS, units=NONE))


def coded(mesh: TriangleMesh, options: Options) -> File:
    """Encode a mesh, and read the file.

    Raises
    ------
    DeltameshError
    """
    one: Encoded = encode_mesh(corpus.as_polymesh(mesh), options)
    content = read_content(one.container, len(mesh.vertices), 1 << 40)
    surface = content.structure.surface
    V = one.draft.positions[: surface.vertex_count]
    return File(surface, V, one.container.parameters, content.integers, len(one.data))
