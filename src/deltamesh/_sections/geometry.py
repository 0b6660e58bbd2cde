"""Sections of the geometry: those of the method that needs the fewest bytes."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Final

import numpy as np

from deltamesh._content import Content
from deltamesh._geometry.bounds import Binding, Bounds, bounds_of, furthest_at_rate
from deltamesh._geometry.importance import important, of_points
from deltamesh._geometry.integers import Integers
from deltamesh._geometry.interpolation import FINER
from deltamesh._geometry.methods import geometry_codec
from deltamesh._geometry.part_search import components_of
from deltamesh._geometry.positions import doubt
from deltamesh._geometry.search import smallest
from deltamesh._geometry.steps import anchor_ratios, ratios
from deltamesh._geometry.systems import Systems
from deltamesh._geometry.trial import ScaleError, Trial
from deltamesh._limits import memory_to_encode
from deltamesh._measures.margins import margin_of
from deltamesh._measures.measure import Measure, Measured, errors_by_importance
from deltamesh._measures.metrics import diagonal
from deltamesh._measures.named_parts import NamedParts, named_parts
from deltamesh._measures.report import report_of
from deltamesh._mesh import LARGEST
from deltamesh._methods import AUTO, CARTESIAN
from deltamesh._options import Options, Settings
from deltamesh._sections.draft import Cost, Draft
from deltamesh._shape.complexes import distinct_faces
from deltamesh._vectors import largest
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container.container import Container, Parameters
from deltamesh_formats.container.regions import Regions
from deltamesh_formats.errors import LimitError, MeshError, SolveError

# Errors as regions have them, and as measures do.
_ERRORS: Final = {
    "rms": "rms",
    "max": "max",
    "normal": "normal_deviation",
    "dihedral": "dihedral",
}


def encode(draft: Draft) -> tuple[dict[str, bytes], Draft]:
    """Return the payloads of the smallest geometry that is good enough, and the draft with it."""
    options = draft.options
    try:
        return _encode(draft, options)
    except (LimitError, SolveError) as error:
        if options.method != AUTO or options.bits == 0:
            raise MeshError(f"{error}; try method cartesian") from error
        return _encode(draft, replace(options, method=CARTESIAN.name, coarse=None))


def _importance(draft: Draft) -> Floats | None:
    """Return the importance of each point, float64 (p,); None where all are alike."""
    if draft.importance is None:
        return None
    return of_points(draft.importance, draft.shape.points, len(draft.positions))


def _encode(draft: Draft, options: Options) -> tuple[dict[str, bytes], Draft]:
    structure, V = draft.shape.structure, draft.positions
    surface, used = structure.surface, structure.complex.used
    memory = memory_to_encode(surface.vertex_count)
    systems = Systems(surface, options.solver, options.threads, memory)
    of_decoder = systems.to_precision(FINER) if draft.mesh.attributes else systems
    faces, polygons = _measured(draft)
    component = np.pad(surface.labels, (0, len(V) - used), constant_values=-1)
    named = named_parts(draft.mesh, faces, polygons, component)
    importance = _importance(draft)
    measure = Measure(V, faces, named.parts, importance)
    weighted = partial(important, surface, importance, solution=options.solution)

    def attempt(settings: Settings) -> Trial:
        draft.progress(f"geometry, {settings.method}")
        coder = geometry_codec(settings.method)
        try:
            parameters, integers, decoded = coder.quantize(
                surface, V[:used], V[used:], weighted(settings), systems
            )
        except SolveError as error:
            if bounds is None:
                raise
            raise MeshError(str(error)) from error  # of this step; a search has others
        if not has_scale(parameters, integers):
            reason = f"coordinates of {largest(V):g} are too large for method {settings.method}"
            raise ScaleError(f"{reason}: try lossless")
        payloads = partial(coder.encode, surface, parameters, integers)
        measured = replace(measure(decoded), doubt=doubt(parameters))
        return Trial(settings, parameters, integers, payloads, decoded, measured)

    def as_decoded(trial: Trial) -> Trial:
        # A search begins its iterations elsewhere: what they find is as near to the solution.
        if not trial.parameters.interpolated:
            return trial
        coder, payloads = geometry_codec(trial.settings.method), trial.payloads
        found = coder.reconstruct(surface, trial.parameters, trial.integers, of_decoder)
        measured = replace(measure(found), doubt=trial.measured.doubt)
        return replace(trial, encode=lambda: payloads, vertices=found, measured=measured)

    scale = diagonal(V)
    bounds = bounds_of(options, scale)
    components = components_of(V[:used], surface.faces, named.parts, measure.diagonals)
    furthest = furthest_at_rate(scale)
    search = partial(smallest, options, bounds, components, name_of=named.name, furthest=furthest)
    trial = search(attempt)
    decoded = as_decoded(trial)
    if bounds is not None and bounds.excess(decoded.measured) > 1 >= bounds.excess(trial.measured):
        decoded = search(lambda settings: as_decoded(attempt(settings)))
    trial, regions = decoded, None
    margin = 0 if options.exact else _margin(measure, trial, scale, bounds)
    cost = None if bounds is None else _cost(bounds.binding(trial.measured), named)
    if importance is not None:
        # What a file and a report tell is not weighted.
        told = replace(Measure(V, faces, named.parts)(trial.vertices), doubt=trial.measured.doubt)
        trial = replace(trial, encode=partial(dict, trial.payloads), measured=told)
        regions = _regions(V, faces, trial.vertices, importance, used)
    report = report_of(trial.measured, named)
    content = replace(draft.content, integers=trial.integers)
    made = replace(draft, trial=trial, report=report, cost=cost, margin=margin, content=content)
    return trial.payloads, replace(made, regions=regions)


def _regions(V: Floats, F: Ints, W: Floats, importance: Floats, used: int) -> Regions:
    """Return what became of what is important, and of the rest."""
    full, reduced = errors_by_importance(V, F, W, importance)
    here = importance[:used]
    return Regions(
        full=int((here == 1).sum()),
        reduced=int(((here > 0) & (here < 1)).sum()),
        none=int((here == 0).sum()),
        **{f"{name}_full": getattr(full, field) for name, field in _ERRORS.items()},
        **{f"{name}_reduced": getattr(reduced, field) for name, field in _ERRORS.items()},
    )


def _margin(measure: Measure, trial: Trial, scale: float, bounds: Bounds | None) -> int:
    """Return the margin within which what is written keeps the bounds, too."""

    def keeps(measured: Measured) -> bool:
        return bounds is None or bounds.excess(measured) <= 1

    return margin_of(measure, trial.measured, trial.vertices, scale, keeps)


def decode(container: Container, content: Content) -> Content:
    """Return the content with the integers of the geometry: the mirror of `encode`."""
    parameters = container.parameters
    surface, coder = content.structure.surface, geometry_codec(parameters.method)
    return replace(content, integers=coder.decode(surface, parameters, container.sections))


def _cost(binding: Binding, named: NamedParts) -> Cost:
    part = None if binding.part is None else named.name(binding.part)
    return Cost(binding.name, binding.error, binding.bound, part)


def has_scale(p: Parameters, i: Integers) -> bool:
    """Return whether no position that these integers could mean would overflow (SPEC.md 5.8)."""
    of_vertices, of_anchors = ratios(i), anchor_ratios(i)
    numbers: list[Floats | Ints] = [i.positions * of_anchors, i.isolated]
    numbers += [a * of_vertices[: len(a)] for a in (i.values, i.refinements, i.corrections)]
    numbers.append(np.ldexp(i.cells.astype(np.float64), i.units[:, None, None]))
    values = max(map(largest, numbers))
    steps, origin = max(p.coarse * p.step, p.anchor_step), max(map(abs, p.origin))
    return bool(values * steps + origin <= 100 * LARGEST)


def _measured(draft: Draft) -> tuple[Ints, Ints]:
    """Return the triangles over points on which errors are measured, and the polygon of each.

    They are those of any reader.
    """
    mesh, shape = draft.mesh, draft.shape
    if not len(shape.structure.merged):
        faces = shape.structure.complex.manifold_faces
        triangles = shape.triangle_provenance.corners[: len(faces), 0] // 3
        return faces, shape.input.triangles.polygon[triangles]
    cut = mesh.triangulation()
    faces = shape.points[cut.faces]
    kept = distinct_faces(faces)
    return faces[kept], cut.polygon[kept]
