"""Inputs of the encoder: arguments become a mesh or frames, checked once, and are encoded."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike

from deltamesh._mesh import LARGEST
from deltamesh._options import Options
from deltamesh._pipeline.encoder import Encoded, encode_mesh
from deltamesh._progress import Progress
from deltamesh._sections import draft
from deltamesh_formats.errors import MeshError, OptionError
from deltamesh_formats.polymesh.arrays import unchecked
from deltamesh_formats.polymesh.dropping import without
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.polymesh.sequences import joined
from deltamesh_formats.polymesh.validation import checked

# Triangles, quads, or polygons of any sizes.
Faces: TypeAlias = ArrayLike | Sequence[ArrayLike]


def frames_of(
    mesh: PolyMesh | Iterable[PolyMesh] | ArrayLike, faces: Faces | None
) -> Iterable[PolyMesh] | None:
    """Return the frames of the arguments of `encode`, not checked yet, None if it is one mesh."""
    if isinstance(mesh, (PolyMesh, str, bytes)):
        return None
    if faces is None:
        if isinstance(mesh, (list, tuple)) and not any(isinstance(one, PolyMesh) for one in mesh):
            return None
        is_sequence = isinstance(mesh, Iterable) and not hasattr(mesh, "__array__")
        return cast(Iterable[PolyMesh], mesh) if is_sequence else None
    try:
        positions = np.asarray(mesh)
    except ValueError:  # rows of several lengths, which are refused as such
        return None
    if positions.ndim != 3:
        return None
    return (replace(unchecked(one, faces), precision="float64") for one in positions)


def mesh_of(mesh: PolyMesh | Iterable[PolyMesh] | ArrayLike, faces: Faces | None) -> PolyMesh:
    """Return the mesh of the arguments of `encode`, not checked yet."""
    if isinstance(mesh, PolyMesh):
        if faces is not None:
            raise MeshError("faces must not be given with a PolyMesh, which has its own")
        return mesh
    if faces is None:
        raise MeshError(
            f"{type(mesh).__name__} without faces: give vertices and faces, or a PolyMesh, "
            "which from_arrays and deltamesh.plugins make"
        )
    # The bytes are those of the numbers, whatever type they come in.
    return replace(unchecked(cast(ArrayLike, mesh), faces), precision="float64")


def encode_checked(mesh: PolyMesh, options: Options, progress: Progress) -> Encoded:
    """Return the result of `encode` for a mesh that may be at fault, with its container."""
    if options.fps is not None:
        raise OptionError("fps means nothing for one mesh: give the frames of a sequence")
    return encode_mesh(checked(mesh, LARGEST), options, progress)


def encode_sequence(frames: Iterable[PolyMesh], options: Options, progress: Progress) -> Encoded:
    """Return the result of `encode` for frames that may be at fault, with the container."""
    first, positions = joined(frames, lambda mesh: checked(without(mesh, options.drop), LARGEST))
    sequence = draft.Sequence(positions, options.fps or 0.0, options.key_every)
    return encode_mesh(first, options, progress, sequence)
