"""Files with steps by vertex of given exponents, and scenes whose parts need them."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from types import MappingProxyType

import meshes
import numpy as np

from deltamesh._geometry.methods import geometry_codec
from deltamesh._geometry.systems import Systems
from deltamesh._measures.metrics import vertex_errors
from deltamesh._options import Options
from deltamesh._pipeline.encoder import Encoded, encode_mesh
from deltamesh._shape.surface import Surface
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container import layout
from deltamesh_formats.container.building import build_container
from deltamesh_formats.container.method_layouts import METHODS
from deltamesh_formats.container.payload_layout import MAX_EXPONENT
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.container.writer import write_container
from deltamesh_formats.polymesh.mesh import PolyMesh, from_triangles

Exponents = Callable[[Surface, Floats], Ints]


def scene(isolated: bool = False) -> meshes.Arrays:
    """A sphere, a torus of a thousandth of its size, and a tetrahedron of a ten millionth."""
    small, tiny = meshes.torus(7, 5), meshes.tetrahedron()
    small, tiny = (1e-3 * small[0] + [3.0, 0, 0], small[1]), (1e-7 * tiny[0] + [0, 2.0, 0], tiny[1])
    V, F = meshes.union(meshes.icosphere(1), small, tiny)
    return (np.concatenate([V, [[-2.0, 0.5, 0.25]]]) if isolated else V), F


def by_size(surface: Surface, V: Floats) -> Ints:
    """Exponents by component: steps nearly in proportion to the size."""
    boxes = [V[surface.labels == k] for k in range(surface.labels.max() + 1)]
    size = np.array([np.ptp(box, axis=0).max() for box in boxes])
    octaves = np.log2(size.max() / size)
    return np.minimum(np.rint(4 * octaves), MAX_EXPONENT).astype(np.int64)[surface.labels]


def extreme(surface: Surface, V: Floats) -> Ints:
    """The largest exponent in all components but the largest."""
    return np.where(by_size(surface, V) > 0, MAX_EXPONENT, 0)


def across(surface: Surface, V: Floats) -> Ints:
    """Exponents from 0 to 9 that grow with x, from vertex to vertex."""
    x = V[:, 0] - V[:, 0].min()
    return np.floor(9.99 * x / x.max()).astype(np.int64)


# What `meta` tells of the parts of a scene, in words of its own: no encoder has measured it.
NOTHING = {"lost": 0, "turned": 0, "parts": 1, "part": "", "part_normal": 0.0, "part_rms": 0.0}
PARTS = {"lost": 3, "turned": 300, "parts": 3, "part": "tétraèdre"}
PARTS |= {"part_normal": 1.5, "part_rms": 0.0123}
TURNED = NOTHING | {"turned": 1}


def restepped(
    mesh: PolyMesh,
    options: Options,
    exponents: Exponents,
    told: Mapping[str, object] = MappingProxyType(NOTHING),
    **changes: object,
) -> Encoded:
    """Encode a mesh with steps by vertex, and other `changes` of the settings."""
    done = encode_mesh(mesh, options)
    draft = done.draft
    surface, used = draft.content.structure.surface, draft.content.structure.surface.vertex_count
    V, trial = draft.positions, draft.chosen
    coder, each = geometry_codec(trial.settings.method), exponents(surface, V[:used])
    settings = dataclasses.replace(
        trial.settings, exponents=bytes(each.astype(np.uint8)), **changes
    )
    parameters, integers, decoded = coder.quantize(
        surface, V[:used], V[used:], settings, Systems(surface)
    )
    own = (layout.PARAMETERS, layout.META, layout.CHECK, layout.STEPS, layout.CORRECTIONS)
    payloads = {
        name: bytes(section.payload)
        for name, section in done.container.sections.items()
        if name not in (*own, *METHODS[parameters.method].geometry)
    }
    changed = {"settings": settings, "parameters": parameters, "integers": integers}
    draft = dataclasses.replace(
        draft,
        trial=dataclasses.replace(trial, vertices=decoded, **changed),
        content=dataclasses.replace(draft.content, integers=integers),
    )
    errors = vertex_errors(V, decoded, surface.faces)
    meta = dataclasses.replace(
        done.container.meta,
        rms=errors.rms,
        max=errors.max,
        normal=errors.normal_deviation,
        dihedral=errors.dihedral,
        **told,
    )
    container = build_container(
        done.container.vertices,
        done.container.triangles,
        parameters,
        payloads | coder.encode(surface, parameters, integers),
        meta,
        draft.content.digest(),
    )
    data = write_container(container)
    return Encoded(data, read_container(data), draft)


def golden() -> list[tuple[str, meshes.Arrays, dict[str, object], Exponents, dict[str, object]]]:
    """Name, mesh, options, exponents and other arguments of `restepped` for each golden file."""
    fine = {"step": 0.01}
    return [
        (
            "highpass-steps",
            scene(),
            fine | {"anchors": 9, "anchor_method": "random", "seed": 3},
            by_size,
            {},
        ),
        (
            "highpass-steps-extreme",
            scene(isolated=True),
            {"step": 0.05},
            extreme,
            {"told": PARTS},
        ),
        (
            "highpass-steps-across",
            meshes.torus(9, 7),
            {"step": 0.05, "anchors": 8, "anchor_method": "greedy"},
            across,
            {},
        ),
        (
            "highpass-steps-interpolated",
            meshes.torus(9, 7),
            {"step": 0.05, "anchors": 8, "solution": "interpolated"},
            across,
            {},
        ),
        ("refined-steps-interpolated", scene(), fine | {"anchors": 12}, by_size, {}),
        ("refined-steps", scene(isolated=True), fine, by_size, {}),
        (
            "refined-steps-corrected",
            meshes.union(meshes.icosphere(1), meshes.torus(7, 5)),
            {"step": 0.2, "anchors": 2},
            across,
            {"largest": 0.04},
        ),
        ("cartesian-steps", scene(isolated=True), fine, by_size, {}),
        ("cartesian-steps-extreme", scene(), {"bits": 5}, extreme, {"told": TURNED}),
    ]


def file_of(name: str) -> Encoded:
    """One of the golden files."""
    for own, mesh, options, exponents, changes in golden():
        if own == name:
            method = name.split("-")[0]
            return restepped(
                from_triangles(*mesh), Options(method=method, **options), exponents, **changes
            )
    raise KeyError(name)
