"""Sections of the geometry: those of the method that needs the fewest bytes."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Final

from deltamesh._content import Content
from deltamesh._geometry.bounds import furthest_at_rate
from deltamesh._geometry.methods import geometry_codec
from deltamesh._geometry.part_search import components_of
from deltamesh._geometry.sample import sample_of
from deltamesh._geometry.search import smallest
from deltamesh._geometry.systems import Systems
from deltamesh._limits import memory_to_encode
from deltamesh._measures.measure import Measure, errors_by_importance
from deltamesh._measures.report import report_of
from deltamesh._methods import AUTO, CARTESIAN
from deltamesh._options import Options
from deltamesh._sections.draft import Draft
from deltamesh._sections.trials import Trials
from deltamesh_formats.array_types import Floats
from deltamesh_formats.container.container import Container
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


def _encode(draft: Draft, options: Options) -> tuple[dict[str, bytes], Draft]:
    surface = draft.shape.structure.surface
    memory = memory_to_encode(surface.vertex_count)
    systems = Systems(surface, options.solver, options.threads, memory)
    trials = Trials(draft, draft.mesh.vertices, systems, "geometry")
    V, bounds, named = trials.positions, trials.bounds, trials.named
    diagonals = trials.measure.diagonals
    components = components_of(V[: trials.used], surface.faces, named.parts, diagonals)
    furthest = furthest_at_rate(trials.scale)
    sample = None
    is_alike = trials.importance is None and components.alone
    if is_alike and bounds is not None and bounds.has_angle:
        balls = sample_of(surface)
        sample = None if balls is None else balls.attempt(V[: trials.used])
    search = partial(
        smallest,
        options,
        bounds,
        components,
        name_of=named.name,
        furthest=furthest,
        sample=sample,
    )
    trial = search(trials.attempt)
    decoded = trials.as_decoded(trial)
    if bounds is not None and bounds.excess(decoded.measured) > 1 >= bounds.excess(trial.measured):
        decoded = search(lambda settings: trials.as_decoded(trials.attempt(settings)))
    trial = decoded
    margin, cost = 0 if options.exact else trials.margin(trial), trials.cost(trial)
    regions = None
    if trials.importance is not None:
        # What a file and a report tell is not weighted.
        plain = Measure(V, trials.faces, named.parts)
        told = replace(plain(trial.vertices), doubt=trial.measured.doubt)
        trial = replace(trial, encode=partial(dict, trial.payloads), measured=told)
        regions = _regions(trials, trial.vertices, trials.importance)
    made = replace(
        draft,
        trial=trial,
        systems=systems,
        report=report_of(trial.measured, named),
        cost=cost,
        regions=regions,
        margin=margin,
        content=replace(draft.content, integers=trial.integers),
    )
    return trial.payloads, made


def _regions(trials: Trials, W: Floats, importance: Floats) -> Regions:
    """Return what became of what is important, and of the rest."""
    full, reduced = errors_by_importance(trials.positions, trials.faces, W, importance)
    here = importance[: trials.used]
    return Regions(
        full=int((here == 1).sum()),
        reduced=int(((here > 0) & (here < 1)).sum()),
        none=int((here == 0).sum()),
        **{f"{name}_full": getattr(full, field) for name, field in _ERRORS.items()},
        **{f"{name}_reduced": getattr(reduced, field) for name, field in _ERRORS.items()},
    )


def decode(container: Container, content: Content) -> Content:
    """Return the content with the integers of the geometry: the mirror of `encode`."""
    parameters = container.parameters
    surface, coder = content.structure.surface, geometry_codec(parameters.method)
    return replace(content, integers=coder.decode(surface, parameters, container.sections))
