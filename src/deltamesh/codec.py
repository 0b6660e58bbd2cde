"""Both pipelines, mirrored: a mesh to bytes, and bytes to a mesh.

encode: structure -> quantize -> write -> container
decode: container -> limits -> structure -> read -> digest -> reconstruct
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from deltamesh import cartesian, highpass, refined
from deltamesh.geometry import Integers, Surface, digest, surface_of
from deltamesh.limits import DEFAULT_MAX_VERTICES, DEFAULT_MEMORY, check_limits
from deltamesh.mesh import LARGEST, Mesh, checked_mesh
from deltamesh.metrics import VertexErrors, diagonal, vertex_errors
from deltamesh.options import Options
from deltamesh.structure import Structure, announced, decode_structure, encode_structure
from deltamesh.targets import aim
from deltamesh.version import __version__
from deltamesh_formats.errors import FormatError, MeshError
from deltamesh_formats.layout import Container, Meta
from deltamesh_formats.reader import read_container
from deltamesh_formats.writer import write_container

Progress = Callable[[str], None]

_METHODS: Final = {"highpass": highpass, "refined": refined, "cartesian": cartesian}


def silent(stage: str) -> None:
    """Tell nobody."""


@dataclass(frozen=True)
class Encoded:
    """What an encoder made.

    Attributes
    ----------
    data : bytes
        The file.
    order : int64 (n,)
        The input vertex that each vertex of the file was.
    face_order, rotation : int64 (m,)
        The input face that each face of the file was, and which of its corners comes first.
    mesh : Mesh
        What a decoder will make of it.
    """

    data: bytes
    order: NDArray[np.int64]
    face_order: NDArray[np.int64]
    rotation: NDArray[np.int64]
    mesh: Mesh


def encode(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    method: str = "highpass",
    bits: int | None = None,
    step: float | None = None,
    normal_error: float | None = None,
    max_error: float | None = None,
    max_error_rel: float | None = None,
    diffusion: bool = True,
    anchors: int | float | None = None,
    anchor_method: str = "farthest",
    seed: int = 0,
    coarse: float | None = None,
    solver: str = "auto",
    threads: int | None = None,
    drop_isolated: bool = False,
    source_format: str = "",
    progress: Progress | None = None,
) -> bytes:
    """Compress a triangle mesh.

    Connectivity is kept exactly, whatever it is; vertices and faces come back in an order of the
    codec's own. Vertices at one position stay there, each for itself.

    Parameters
    ----------
    vertices : array_like (n, 3)
        Finite real numbers.
    faces : array_like (m, 3)
        Vertex indices from 0, of any triangles.
    method : {"highpass", "refined", "cartesian"}
        What is quantized: differential coordinates; these coarsely, and their component along the
        normal finely; or x, y and z.
    bits : int, optional
        The step is the range of what is quantized over 2^bits. With "highpass", 0 is a
        least-squares mesh: connectivity and anchors alone. Default for "cartesian": 11.
    step : float, optional
        The step itself, in the unit of the vertices. Default but for "cartesian": 1/1000 of the
        diagonal of the bounding box.
    normal_error : float, optional
        Instead of bits or a step: the largest mean deviation of the face normals, in degrees. The
        step is found by decoding; the file keeps the bound.
    max_error, max_error_rel : float, optional
        Likewise, the largest distance of any vertex from where it was: in the unit of the vertices,
        or as a fraction of the diagonal of the bounding box.
    diffusion : bool
        Hand the error of each rounding on to the neighbours still to come.
    anchors : int or float, optional
        How many vertices are stored with their positions, or which fraction. Default: 0.001. At
        least one a component.
    anchor_method : {"farthest", "greedy", "random"}
    seed : int
        Of the random anchors.
    coarse : float, optional
        With "refined", the step along the surface over that across it, 1 to 64. Default: 8.
    solver : {"auto", "rslab", "pardiso", "scipy"}
    threads : int, optional
        For the solver. Default: all cores. The bytes do not depend on it.
    drop_isolated : bool
        Leave out the vertices that belong to no face.
    source_format : str
        Stored; what `deltamesh decode` writes by default.
    progress : callable, optional
        Called with the name of each stage as it begins.

    Returns
    -------
    bytes
        A `.dmesh` file (formats/SPEC.md).

    Raises
    ------
    MeshError
        If the arrays are no mesh; the first element at fault is named.
    OptionError
    TargetError
        If no step keeps the error within its bound.
    SolveError

    Notes
    -----
    D. Cohen-Or, O. Sorkine, "Encoding Meshes in Differential Coordinates", SCCG 2006.
    """
    options = Options(
        method=method,
        bits=bits,
        step=step,
        normal_error=normal_error,
        max_error=max_error,
        max_error_rel=max_error_rel,
        diffusion=diffusion,
        anchors=anchors,
        anchor_method=anchor_method,
        seed=seed,
        coarse=coarse,
        solver=solver,
        threads=threads,
        drop_isolated=drop_isolated,
        source_format=source_format,
    )
    return encode_mesh(checked_mesh(vertices, faces), options, progress or silent).data


def encode_mesh(mesh: Mesh, options: Options, progress: Progress = silent) -> Encoded:
    """Compress a checked mesh; see `encode`."""
    if len(mesh.faces) == 0:
        raise MeshError("the mesh has no faces")
    payloads, structure, origin = encode_structure(mesh, options.drop_isolated, progress)
    progress("geometry")
    surface = surface_of(structure.surface, structure.used, structure.isolated)
    coder = _METHODS[options.method]
    V = mesh.vertices[origin.points]
    used, isolated = V[: structure.used], V[structure.used :]

    def errors_with(options: Options) -> VertexErrors:
        parameters, integers = coder.quantize(surface, used, isolated, options)
        W = coder.reconstruct(surface, parameters, integers, options.solver, options.threads)
        return vertex_errors(V, W, surface.faces)

    options = aim(options, diagonal(V), errors_with)
    parameters, integers = coder.quantize(surface, used, isolated, options)
    payloads |= coder.write(surface, parameters, integers)
    progress("checking")
    decoded = coder.reconstruct(surface, parameters, integers, options.solver, options.threads)
    meta = _measure(V, decoded, surface, options.source_format)
    checksum = digest(structure.faces, integers, structure.copied)
    n, m = len(structure.points), len(structure.faces)
    data = write_container(n, m, parameters, payloads, meta, checksum)
    face_order, rotation = np.divmod(origin.corners[:, 0], 3)
    result = Mesh(decoded[structure.points], structure.faces)
    return Encoded(data, origin.vertices, face_order, rotation, result)


def decode(
    data: bytes | bytearray | memoryview,
    *,
    solver: str = "auto",
    threads: int | None = None,
    max_vertices: int = DEFAULT_MAX_VERTICES,
    memory: int = DEFAULT_MEMORY,
    progress: Progress | None = None,
) -> Mesh:
    """Decompress a `.dmesh` file.

    Parameters
    ----------
    data : bytes-like
    solver : {"auto", "rslab", "pardiso", "scipy"}
    threads : int, optional
        For the solver. Default: all cores.
    max_vertices, memory : int
        Refuse files with more vertices, or that would take more bytes of memory.
    progress : callable, optional
        Called with the name of each stage as it begins.

    Returns
    -------
    Mesh
        Faces and stored integers exactly; positions to within 1e-9 of the bounding box diagonal,
        whatever the machine and the solver.

    Raises
    ------
    FormatError
        If the bytes are damaged or no encoder has written them; it has an offset.
    LimitError
        Before anything above the limits is allocated.
    SolveError

    Notes
    -----
    D. Cohen-Or, O. Sorkine, "Encoding Meshes in Differential Coordinates", SCCG 2006.
    """
    progress = progress or silent
    container = read_container(data)
    structure, surface, integers = _read(container, max_vertices, memory, progress)
    progress("positions")
    coder = _METHODS[container.parameters.method]
    _check_scale(container, integers)
    points = coder.reconstruct(surface, container.parameters, integers, solver, threads)
    return Mesh(points[structure.points], structure.faces)


def _read(
    container: Container, max_vertices: int, memory: int, progress: Progress
) -> tuple[Structure, Surface, Integers]:
    """Return everything exact in a file, checked."""
    counts = announced(container)
    check_limits(container, counts, max_vertices, memory)
    parameters, sections = container.parameters, container.sections
    progress("connectivity")
    structure = decode_structure(container, counts)
    progress("geometry")
    surface = surface_of(structure.surface, structure.used, structure.isolated)
    integers = _METHODS[parameters.method].read(surface, parameters, sections)
    if digest(structure.faces, integers, structure.copied) != container.digest:
        raise FormatError("the checksum of the decoded integers is wrong", sections["CHEK"].offset)
    return structure, surface, integers


def _check_scale(container: Container, integers: Integers) -> None:
    """Refuse steps and origins that no mesh has: the positions would overflow."""
    p = container.parameters
    values = max(
        int(np.abs(a).max(initial=0))
        for a in (integers.values, integers.positions, integers.isolated, integers.refinements)
    )
    steps, origin = max(p.coarse * p.step, p.anchor_step), max(map(abs, p.origin))
    if not values * steps + origin <= 100 * LARGEST:
        raise FormatError("positions that are too large", container.sections["PARM"].offset)


def _measure(
    V: NDArray[np.float64], decoded: NDArray[np.float64], surface: Surface, source_format: str
) -> Meta:
    errors = vertex_errors(V, decoded, surface.faces)
    return Meta(
        rms=errors.rms,
        max=errors.max,
        normal=errors.normal_deviation,
        dihedral=errors.dihedral,
        diagonal=diagonal(V),
        encoder=f"deltamesh {__version__}",
        source=source_format,
    )
