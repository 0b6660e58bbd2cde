"""Both pipelines, mirrored: a mesh to bytes, and bytes to a mesh.

encode: structure -> quantize -> encode -> container
decode: container -> limits -> structure -> decode -> digest -> reconstruct
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from deltamesh._attributes.codings import AttributeSettings
from deltamesh._attributes.domains import Domains
from deltamesh._attributes.section import decode_attributes, encode_attributes
from deltamesh._content import Content
from deltamesh._geometry.bounds import POSITION_TOLERANCE, bounds_of
from deltamesh._geometry.integers import Integers
from deltamesh._geometry.methods import geometry_codec
from deltamesh._geometry.search import Trial, smallest
from deltamesh._geometry.solve import factorization
from deltamesh._limits import check_limits
from deltamesh._measures.metrics import VertexErrors, diagonal, errors_from, mean_edge
from deltamesh._mesh import LARGEST, TriangleMesh
from deltamesh._options import Options, Settings
from deltamesh._order.coding import decode_order, encode_order
from deltamesh._order.reordering import order_of
from deltamesh._parts import annotations_of, decode_parts, encode_parts
from deltamesh._shape.complexes import distinct_faces
from deltamesh._shape.decoding import announced, decode_structure
from deltamesh._shape.diagonals import cut_polygons
from deltamesh._shape.encoding import Origin, encode_gluing, encode_structure
from deltamesh._shape.polygons import Sources, sources_of
from deltamesh._shape.structure import Structure
from deltamesh._version import __version__
from deltamesh_formats.container.building import build_container
from deltamesh_formats.container.container import Container, Meta, Parameters
from deltamesh_formats.container.layout import METHODS
from deltamesh_formats.container.reader import payload_of
from deltamesh_formats.container.writer import write_container
from deltamesh_formats.errors import FormatError, MeshError
from deltamesh_formats.polymesh.dropping import without
from deltamesh_formats.polymesh.mesh import PolyMesh, from_triangles

Progress = Callable[[str], None]


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


def encode_mesh(
    mesh: PolyMesh | TriangleMesh, options: Options, progress: Progress = silent
) -> Encoded:
    """Compress a checked mesh; see `codec.encode`."""
    if isinstance(mesh, TriangleMesh):
        mesh = from_triangles(mesh.vertices, mesh.faces)
    mesh = without(mesh, options.drop)
    cut = cut_polygons(mesh)
    if len(cut.faces) == 0:
        raise MeshError("the mesh has no faces")
    exact, triangles = options.exact, TriangleMesh(mesh.vertices, cut.faces)
    payloads, structure, origin = encode_structure(
        triangles, options.drop_isolated, exact, progress
    )
    gluing, structure = encode_gluing(structure, origin, cut)
    progress("geometry")
    trial = _geometry(mesh, structure, origin, options, progress)
    sources = sources_of(structure.polygons, origin.vertices, origin.corners, cut)
    beside, content = _beside_geometry(mesh, structure, trial, sources, options, progress)
    payloads |= {**gluing, **trial.payloads, **beside}
    n, m = len(structure.points), len(structure.faces)
    single = mesh.precision == "float32"
    container = build_container(
        n,
        m,
        replace(trial.parameters, single=single),
        payloads,
        _meta(trial.errors, diagonal(mesh.vertices[origin.points]), options.source_format),
        content.digest(),
    )
    data = write_container(container)
    return _encoded(data, mesh, content, sources, content.mesh(trial.vertices, single))


def _geometry(
    mesh: PolyMesh, structure: Structure, origin: Origin, options: Options, progress: Progress
) -> Trial:
    """Return the geometry in the fewest bytes that is good enough."""
    surface, V = structure.surface, mesh.vertices[origin.points]
    used, isolated = V[: structure.used], V[structure.used :]
    factor = factorization(surface.laplacian, options.solver, options.threads)
    bounds = bounds_of(options, diagonal(V))
    errors_of = errors_from(V, _measured(mesh, structure, origin))

    def attempt(settings: Settings) -> Trial:
        progress(f"geometry, {settings.method}")
        coder = geometry_codec(settings.method)
        parameters, integers, decoded = coder.quantize(surface, used, isolated, settings, factor)
        if not _has_scale(parameters, integers):
            largest = float(np.abs(V).max())
            reason = f"coordinates of {largest:g} are too large for method {settings.method}"
            raise MeshError(f"{reason}: try lossless")
        encode = partial(coder.encode, surface, parameters, integers)
        return Trial(settings, parameters, integers, encode, decoded, errors_of(decoded))

    return smallest(options, bounds, mean_edge(used, surface.faces), attempt)


def _beside_geometry(
    mesh: PolyMesh,
    structure: Structure,
    trial: Trial,
    sources: Sources,
    options: Options,
    progress: Progress,
) -> tuple[dict[str, bytes], Content]:
    """Code attributes, parts and order; return the payloads, and everything that is in the file."""
    payloads, places = {}, Domains(structure)
    content = Content(structure, trial.integers)
    if mesh.attributes:
        progress("attributes")
        wanted = _wanted(options, trial, trial.vertices[structure.points])
        payloads["ATTR"], coded = encode_attributes(mesh, sources, places, wanted)
        content = replace(content, attributes=coded)
    told = annotations_of(mesh, sources.faces)
    if told is not None:
        progress("parts")
        payloads["PART"] = encode_parts(told, lambda: places.faces)
        content = replace(content, told=told)
    if options.keep_order:
        progress("order")
        kept = order_of(structure.polygons, sources, mesh.offsets)
        payloads["ORDR"] = encode_order(structure.faces, structure.polygons, kept)
        content = replace(content, order=kept)
    return payloads, content


def _encoded(
    data: bytes, mesh: PolyMesh, content: Content, sources: Sources, decoded: PolyMesh
) -> Encoded:
    order, face_order = sources.vertices, sources.faces
    first = content.structure.polygons.offsets[:-1]
    rotation = sources.corners[first] - mesh.offsets[face_order]
    if content.order is not None:
        order = order[content.order.vertices]
        face_order, rotation = np.arange(len(face_order)), np.zeros_like(rotation)
    return Encoded(data, order, face_order, rotation, decoded)


def decode_mesh(
    container: Container,
    *,
    solver: str,
    threads: int | None,
    max_vertices: int,
    memory: int,
    progress: Progress = silent,
) -> PolyMesh:
    """Decompress a file; see `codec.decode`."""
    content = read_content(container, max_vertices, memory, progress)
    if content.digest() != container.digest:
        offset = container.sections["CHEK"].offset
        raise FormatError("the checksum of the decoded integers is wrong", offset)
    progress("positions")
    parameters, surface = container.parameters, content.structure.surface
    _check_scale(container, content.integers)
    factor = factorization(surface.laplacian, solver, threads)
    coder = geometry_codec(parameters.method)
    points = coder.reconstruct(surface, parameters, content.integers, factor)
    return content.mesh(points, parameters.single)


def read_content(
    container: Container, max_vertices: int, memory: int, progress: Progress = silent
) -> Content:
    """Return everything exact in a file; its digest is not checked yet.

    Raises
    ------
    FormatError, LimitError
    """
    counts = announced(container)
    check_limits(container, counts, max_vertices, memory)
    parameters, sections = container.parameters, container.sections
    progress("connectivity")
    structure = decode_structure(container, counts)
    progress("geometry")
    integers = geometry_codec(parameters.method).decode(structure.surface, parameters, sections)
    content, places = Content(structure, integers), Domains(structure)
    if "ATTR" in sections:
        progress("attributes")
        with payload_of(sections["ATTR"]) as payload:
            content = replace(content, attributes=decode_attributes(payload, places))
    if "PART" in sections:
        progress("parts")
        with payload_of(sections["PART"]) as payload:
            told = decode_parts(payload, places.count("face"), lambda: places.faces)
        content = replace(content, told=told)
    if "ORDR" in sections:
        progress("order")
        with payload_of(sections["ORDR"]) as payload:
            order = decode_order(payload, structure.faces, structure.polygons, container.vertices)
        content = replace(content, order=order)
    return content


def _wanted(options: Options, trial: Trial, V: NDArray[np.float64]) -> AttributeSettings:
    """Return how attributes are coded, at vertices that are decoded to V."""
    solved = METHODS[trial.parameters.method].anchored
    return AttributeSettings(
        bits_uv=options.bits_uv,
        bits_normal=options.bits_normal,
        lossless=options.lossless_attributes or options.exact,
        positions=V,
        tolerance=POSITION_TOLERANCE * diagonal(V) if solved else 0.0,
    )


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
        return structure.point_faces
    point = np.full(len(mesh.vertices), -1)
    point[origin.vertices] = structure.points
    return distinct_faces(point[mesh.triangles])


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
