"""Both pipelines, mirrored: a mesh to bytes, and bytes to a mesh.

encode: structure -> quantize -> write -> container
decode: container -> limits -> structure -> read -> digest -> reconstruct
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from deltamesh import cartesian, highpass, lossless, refined
from deltamesh.attributes.coded import Coded, all_arrays, restored
from deltamesh.attributes.decoding import decode_attributes
from deltamesh.attributes.encoding import encode_attributes
from deltamesh.attributes.places import Places
from deltamesh.attributes.ways import Wanted
from deltamesh.complexes import distinct_faces
from deltamesh.diagonals import cut_polygons
from deltamesh.geometry import Integers, Surface, digest, payload_of
from deltamesh.limits import check_limits
from deltamesh.mesh import LARGEST, Mesh
from deltamesh.metrics import VertexErrors, diagonal, errors_from, mean_edge
from deltamesh.options import Options, Settings
from deltamesh.order import decode_order, encode_order
from deltamesh.parts import Told, decode_parts, encode_parts, told_of
from deltamesh.polygons import assembled, sources_of
from deltamesh.reordering import Order, arrays, order_of, reordered
from deltamesh.search import Trial, smallest
from deltamesh.solve import factorization
from deltamesh.structure import (
    Origin,
    Structure,
    announced,
    coded_surface,
    decode_structure,
    encode_gluing,
    encode_structure,
)
from deltamesh.targets import bounds_of
from deltamesh.version import __version__
from deltamesh_formats.dropping import without
from deltamesh_formats.errors import FormatError, MeshError
from deltamesh_formats.layout import Container, Meta, Parameters
from deltamesh_formats.polymesh import PolyMesh, from_triangles
from deltamesh_formats.reader import read_container
from deltamesh_formats.writer import write_container

Progress = Callable[[str], None]

_METHODS: Final = {
    "highpass": highpass,
    "refined": refined,
    "cartesian": cartesian,
    "lossless": lossless,
}


NO_ATTRIBUTES: Final[tuple[Coded, ...]] = ()
# How far apart positions of two decoders may be, in diagonals of the bounding box (SPEC.md 5.4).
SOLVED: Final = 1e-9


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
    face_order, rotation : int64 (p,)
        The input polygon that each polygon of the file was, and which of its corners comes first.
    mesh : PolyMesh
        What a decoder will make of it.
    """

    data: bytes
    order: NDArray[np.int64]
    face_order: NDArray[np.int64]
    rotation: NDArray[np.int64]
    mesh: PolyMesh


def encode_mesh(mesh: PolyMesh | Mesh, options: Options, progress: Progress = silent) -> Encoded:
    """Compress a checked mesh; see `codec.encode`."""
    if isinstance(mesh, Mesh):
        mesh = from_triangles(mesh.vertices, mesh.faces)
    mesh = without(mesh, options.drop)
    cut = cut_polygons(mesh)
    triangles = Mesh(mesh.vertices, cut.faces)
    if len(cut.faces) == 0:
        raise MeshError("the mesh has no faces")
    exact = options.method == "lossless"
    payloads, structure, origin = encode_structure(
        triangles, options.drop_isolated, exact, progress
    )
    gluing, structure = encode_gluing(structure, origin, cut)
    payloads |= gluing
    progress("geometry")
    surface = coded_surface(structure)
    V = triangles.vertices[origin.points]
    used, isolated = V[: structure.used], V[structure.used :]
    factor = factorization(surface.laplacian, options.solver, options.threads)
    bounds = bounds_of(options, diagonal(V))
    errors_of = errors_from(V, _measured(mesh, structure, origin))

    def attempt(settings: Settings) -> Trial:
        progress(f"geometry, {settings.method}")
        coder = _METHODS[settings.method]
        parameters, integers, decoded = coder.quantize(surface, used, isolated, settings, factor)
        if not _has_scale(parameters, integers):
            largest = float(np.abs(V).max())
            reason = f"coordinates of {largest:g} are too large for method {settings.method}"
            raise MeshError(f"{reason}: try lossless")
        write = partial(coder.write, surface, parameters, integers)
        return Trial(settings, parameters, integers, write, decoded, errors_of(decoded))

    trial = smallest(options, bounds, mean_edge(used, surface.faces), attempt)
    payloads |= trial.payloads
    polygons = structure.polygons
    result = assembled(trial.vertices[structure.points], structure.faces, polygons)
    result = replace(result, precision=mesh.precision)
    sources = sources_of(polygons, origin.vertices, origin.corners, cut)
    places, coded = Places(structure), NO_ATTRIBUTES
    if mesh.attributes:
        progress("attributes")
        wanted = _wanted(options, trial, result.vertices, diagonal(V))
        payloads["ATTR"], coded = encode_attributes(mesh, sources, places, wanted)
        result = _with_attributes(result, coded, places)
    told = told_of(mesh, sources.faces)
    if told is not None:
        progress("parts")
        payloads["PART"] = encode_parts(told, lambda: places.faces)
        result = told.given_to(result)
    order, face_order = sources.vertices, sources.faces
    rotation = sources.corners[polygons.offsets[:-1]] - mesh.offsets[face_order]
    kept = None
    if options.keep_order:
        progress("order")
        kept = order_of(polygons, sources, mesh.offsets)
        payloads["ORDR"] = encode_order(structure.faces, polygons, kept)
        result, order = reordered(result, kept), order[kept.vertices]
        face_order, rotation = np.arange(len(face_order)), np.zeros_like(rotation)
    told_arrays = () if told is None else told.arrays()
    further = (*arrays(kept), *structure.glue, *all_arrays(coded), *told_arrays)
    checksum = digest(structure.faces, structure.copied, trial.integers, further)
    n, m = len(structure.points), len(structure.faces)
    meta = _meta(trial.errors, diagonal(V), options.source_format)
    parameters = replace(trial.parameters, single=mesh.precision == "float32")
    data = write_container(n, m, parameters, payloads, meta, checksum)
    return Encoded(data, order, face_order, rotation, result)


def decode_mesh(
    data: bytes | bytearray | memoryview,
    *,
    solver: str,
    threads: int | None,
    max_vertices: int,
    memory: int,
    progress: Progress = silent,
) -> PolyMesh:
    """Decompress a file; see `codec.decode`."""
    container = read_container(data)
    read = _read(container, max_vertices, memory, progress)
    structure, surface, integers, places, coded, told, order = read
    progress("positions")
    coder = _METHODS[container.parameters.method]
    _check_scale(container, integers)
    factor = factorization(surface.laplacian, solver, threads)
    points = coder.reconstruct(surface, container.parameters, integers, factor)
    mesh = assembled(points[structure.points], structure.faces, structure.polygons)
    mesh = replace(mesh, precision="float32" if container.parameters.single else "float64")
    mesh = _with_attributes(mesh, coded, places)
    mesh = mesh if told is None else told.given_to(mesh)
    return mesh if order is None else reordered(mesh, order)


def _read(
    container: Container, max_vertices: int, memory: int, progress: Progress
) -> tuple[Structure, Surface, Integers, Places, tuple[Coded, ...], Told | None, Order | None]:
    """Return everything exact in a file, checked."""
    counts = announced(container)
    check_limits(container, counts, max_vertices, memory)
    parameters, sections = container.parameters, container.sections
    progress("connectivity")
    structure = decode_structure(container, counts)
    progress("geometry")
    surface = coded_surface(structure)
    integers = _METHODS[parameters.method].read(surface, parameters, sections)
    places, coded, told = Places(structure), NO_ATTRIBUTES, None
    if "ATTR" in sections:
        progress("attributes")
        with payload_of(sections["ATTR"]) as payload:
            coded = decode_attributes(payload, places)
    if "PART" in sections:
        progress("parts")
        with payload_of(sections["PART"]) as payload:
            told = decode_parts(payload, places.count("face"), lambda: places.faces)
    order = None
    if "ORDR" in sections:
        progress("order")
        with payload_of(sections["ORDR"]) as payload:
            order = decode_order(payload, structure.faces, structure.polygons, container.vertices)
    told_arrays = () if told is None else told.arrays()
    further = (*arrays(order), *structure.glue, *all_arrays(coded), *told_arrays)
    if digest(structure.faces, structure.copied, integers, further) != container.digest:
        raise FormatError("the checksum of the decoded integers is wrong", sections["CHEK"].offset)
    return structure, surface, integers, places, coded, told, order


def _wanted(options: Options, trial: Trial, V: NDArray[np.float64], scale: float) -> Wanted:
    """Return how attributes are coded, at positions of this scale."""
    exact = trial.parameters.method in ("cartesian", "lossless")
    return Wanted(
        bits_uv=options.bits_uv,
        bits_normal=options.bits_normal,
        lossless=options.lossless_attributes or options.method == "lossless",
        positions=V,
        tolerance=0.0 if exact else SOLVED * scale,
    )


def _with_attributes(mesh: PolyMesh, coded: tuple[Coded, ...], places: Places) -> PolyMesh:
    return replace(mesh, attributes=tuple(restored(one, places, mesh.vertices) for one in coded))


def _check_scale(container: Container, integers: Integers) -> None:
    """Refuse steps and origins that no mesh has."""
    if not _has_scale(container.parameters, integers):
        raise FormatError("positions that are too large", container.sections["PARM"].offset)


def _has_scale(p: Parameters, i: Integers) -> bool:
    """Tell whether no position that these integers could mean would overflow (SPEC.md 5.7)."""
    numbers = (i.values, i.positions, i.isolated, i.refinements, i.corrections)
    values = max(int(np.abs(a).max(initial=0)) for a in numbers)
    steps, origin = max(p.coarse * p.step, p.anchor_step), max(map(abs, p.origin))
    return bool(values * steps + origin <= 100 * LARGEST)


def _measured(mesh: PolyMesh, structure: Structure, origin: Origin) -> NDArray[np.int64]:
    """Return the triangles over points on which errors are measured: those of any reader."""
    if not len(structure.glued):
        return structure.surface
    point = np.full(len(mesh.vertices), -1)
    point[origin.vertices] = structure.points
    return distinct_faces(point[mesh.faces])


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
