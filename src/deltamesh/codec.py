"""Both pipelines, mirrored: a mesh to bytes, and bytes to a mesh.

encode: structure -> quantize -> write -> container
decode: container -> limits -> structure -> read -> digest -> reconstruct
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from deltamesh import cartesian, highpass, lossless, refined
from deltamesh.geometry import Integers, Surface, digest, payload_of, surface_of
from deltamesh.limits import DEFAULT_MAX_VERTICES, DEFAULT_MEMORY, check_limits
from deltamesh.mesh import LARGEST, Mesh, checked_mesh
from deltamesh.metrics import VertexErrors, diagonal, errors_from, mean_edge
from deltamesh.options import DEFAULT_EFFORT, Options, Settings
from deltamesh.order import decode_order, encode_order
from deltamesh.reordering import Order, arrays, order_of, reordered
from deltamesh.search import Trial, smallest
from deltamesh.solve import factorization
from deltamesh.structure import Structure, announced, decode_structure, encode_structure
from deltamesh.targets import bounds_of
from deltamesh.version import __version__
from deltamesh_formats.errors import FormatError, MeshError
from deltamesh_formats.layout import Container, Meta
from deltamesh_formats.reader import read_container
from deltamesh_formats.writer import write_container

Progress = Callable[[str], None]

_METHODS: Final = {
    "highpass": highpass,
    "refined": refined,
    "cartesian": cartesian,
    "lossless": lossless,
}


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
    method: str = "auto",
    bits: int | None = None,
    step: float | None = None,
    quality: int | None = None,
    normal_error: float | None = None,
    dihedral_error: float | None = None,
    max_error: float | None = None,
    max_error_rel: float | None = None,
    effort: int = DEFAULT_EFFORT,
    diffusion: bool = True,
    anchors: int | float | None = None,
    anchor_method: str = "farthest",
    seed: int = 0,
    coarse: float | None = None,
    solver: str = "auto",
    threads: int | None = None,
    drop_isolated: bool = False,
    keep_order: bool = False,
    source_format: str = "",
    progress: Progress | None = None,
) -> bytes:
    """Compress a triangle mesh.

    Connectivity is kept exactly, whatever it is; vertices and faces come back in an order of the
    codec's own unless `keep_order` says otherwise. Vertices at one position stay there, each for
    itself.

    Parameters
    ----------
    vertices : array_like (n, 3)
        Finite real numbers.
    faces : array_like (m, 3)
        Vertex indices from 0, of any triangles.
    method : {"auto", "refined", "highpass", "cartesian", "lossless"}
        What is quantized: differential coordinates, coarsely, and their component along the normal
        finely; these coordinates alike; x, y and z; or nothing: positions come back bit for bit,
        -0.0 and all. "auto" is refined or cartesian, whichever takes fewer bytes for the same
        errors.
    bits : int, optional
        The step is the range of what is quantized over 2^bits. 0 is a least-squares mesh:
        connectivity and anchors alone. Default for "cartesian": 11.
    step : float, optional
        The step itself, in the unit of the vertices. Default for "highpass" and "refined": 1/1000
        of the diagonal of the bounding box.
    quality : int, optional
        From 1 to 9, instead of bits or a step. 5, the default for "auto", keeps the mean deviation
        of the face normals within 1 degree, and the RMS distance of the vertices from where they
        were within 0.15 % of the diagonal of the bounding box; two levels more halve both.
    normal_error, dihedral_error : float, optional
        Likewise, the largest mean deviation of the face normals, or of the dihedral angles, in
        degrees. Bounds go together, and with a quality; the file keeps them all, and the encoder
        has proved it by decoding.
    max_error, max_error_rel : float, optional
        Likewise, the largest distance of any vertex from where it was: in the unit of the vertices,
        or as a fraction of the diagonal of the bounding box.
    effort : int
        From 1 to 3: how long to search for the fewest bytes within the bounds.
    diffusion : bool
        Hand the error of each rounding on to the neighbours still to come.
    anchors : int or float, optional
        How many vertices are stored with their positions, or which fraction. Default: 0.001. At
        least one a component.
    anchor_method : {"farthest", "greedy", "random"}
    seed : int
        Of the random anchors.
    coarse : float, optional
        With "refined", the step along the surface over that across it, 1 to 64. Default: 8, or
        what the search finds.
    solver : {"auto", "rslab", "pardiso", "scipy"}
    threads : int, optional
        For the solver. Default: all cores. The bytes do not depend on it.
    drop_isolated : bool
        Leave out the vertices that belong to no face.
    keep_order : bool
        Vertices and faces come back in the order of the input, each face from its first corner on.
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
        If nothing keeps the errors within their bounds; the message tells what could be had.
    SolveError

    Notes
    -----
    D. Cohen-Or, O. Sorkine, "Encoding Meshes in Differential Coordinates", SCCG 2006.
    """
    options = Options(
        method=method,
        bits=bits,
        step=step,
        quality=quality,
        normal_error=normal_error,
        dihedral_error=dihedral_error,
        max_error=max_error,
        max_error_rel=max_error_rel,
        effort=effort,
        diffusion=diffusion,
        anchors=anchors,
        anchor_method=anchor_method,
        seed=seed,
        coarse=coarse,
        solver=solver,
        threads=threads,
        drop_isolated=drop_isolated,
        keep_order=keep_order,
        source_format=source_format,
    )
    return encode_mesh(checked_mesh(vertices, faces), options, progress or silent).data


def encode_mesh(mesh: Mesh, options: Options, progress: Progress = silent) -> Encoded:
    """Compress a checked mesh; see `encode`."""
    if len(mesh.faces) == 0:
        raise MeshError("the mesh has no faces")
    exact = options.method == "lossless"
    payloads, structure, origin = encode_structure(mesh, options.drop_isolated, exact, progress)
    progress("geometry")
    surface = surface_of(structure.surface, structure.used, structure.isolated)
    V = mesh.vertices[origin.points]
    used, isolated = V[: structure.used], V[structure.used :]
    factor = factorization(surface.laplacian, options.solver, options.threads)
    bounds, errors_of = bounds_of(options, diagonal(V)), errors_from(V, surface.faces)

    def attempt(settings: Settings) -> Trial:
        progress(f"geometry, {settings.method}")
        coder = _METHODS[settings.method]
        parameters, integers, decoded = coder.quantize(surface, used, isolated, settings, factor)
        write = partial(coder.write, surface, parameters, integers)
        return Trial(settings, parameters, integers, write, decoded, errors_of(decoded))

    trial = smallest(options, bounds, mean_edge(used, surface.faces), attempt)
    payloads |= trial.payloads
    result, order = Mesh(trial.vertices[structure.points], structure.faces), origin.vertices
    face_order, rotation = np.divmod(origin.corners[:, 0], 3)
    kept = None
    if options.keep_order:
        progress("order")
        kept = order_of(order, structure.faces, mesh.faces)
        payloads["ORDR"] = encode_order(structure.faces, kept)
        result, order = reordered(result, kept), order[kept.vertices]
        face_order, rotation = np.arange(len(face_order)), np.zeros_like(rotation)
    checksum = digest(structure.faces, structure.copied, trial.integers, arrays(kept))
    n, m = len(structure.points), len(structure.faces)
    meta = _meta(trial.errors, diagonal(V), options.source_format)
    data = write_container(n, m, trial.parameters, payloads, meta, checksum)
    return Encoded(data, order, face_order, rotation, result)


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
        whatever the machine and the solver, of a lossless file bit for bit.

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
    structure, surface, integers, order = _read(container, max_vertices, memory, progress)
    progress("positions")
    coder = _METHODS[container.parameters.method]
    _check_scale(container, integers)
    factor = factorization(surface.laplacian, solver, threads)
    points = coder.reconstruct(surface, container.parameters, integers, factor)
    mesh = Mesh(points[structure.points], structure.faces)
    return mesh if order is None else reordered(mesh, order)


def _read(
    container: Container, max_vertices: int, memory: int, progress: Progress
) -> tuple[Structure, Surface, Integers, Order | None]:
    """Return everything exact in a file, checked."""
    counts = announced(container)
    check_limits(container, counts, max_vertices, memory)
    parameters, sections = container.parameters, container.sections
    progress("connectivity")
    structure = decode_structure(container, counts)
    progress("geometry")
    surface = surface_of(structure.surface, structure.used, structure.isolated)
    integers = _METHODS[parameters.method].read(surface, parameters, sections)
    order = None
    if "ORDR" in sections:
        progress("order")
        with payload_of(sections["ORDR"]) as payload:
            order = decode_order(payload, structure.faces, container.vertices)
    if digest(structure.faces, structure.copied, integers, arrays(order)) != container.digest:
        raise FormatError("the checksum of the decoded integers is wrong", sections["CHEK"].offset)
    return structure, surface, integers, order


def _check_scale(container: Container, integers: Integers) -> None:
    """Refuse steps and origins that no mesh has: the positions would overflow."""
    p = container.parameters
    i = integers
    numbers = (i.values, i.positions, i.isolated, i.refinements, i.corrections)
    values = max(int(np.abs(a).max(initial=0)) for a in numbers)
    steps, origin = max(p.coarse * p.step, p.anchor_step), max(map(abs, p.origin))
    if not values * steps + origin <= 100 * LARGEST:
        raise FormatError("positions that are too large", container.sections["PARM"].offset)


def _meta(errors: VertexErrors, scale: float, source_format: str) -> Meta:
    return Meta(
        rms=errors.rms,
        max=errors.max,
        normal=errors.normal_deviation,
        dihedral=errors.dihedral,
        diagonal=scale,
        encoder=f"deltamesh {__version__}",
        source=source_format,
    )
