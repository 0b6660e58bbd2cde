"""Sections of the geometry: those of the method that needs the fewest bytes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from deltamesh._content import Content
from deltamesh._geometry.bounds import DECODED, bounds_of
from deltamesh._geometry.integers import Integers
from deltamesh._geometry.methods import geometry_codec
from deltamesh._geometry.search import ScaleError, Trial, smallest
from deltamesh._geometry.solve import factorization
from deltamesh._measures.margins import position_margin, worst
from deltamesh._measures.metrics import (
    VertexErrors,
    diagonal,
    errors_from,
    mean_edge,
    rounded_up,
    vertex_errors,
)
from deltamesh._mesh import LARGEST
from deltamesh._options import Settings
from deltamesh._sections.draft import Draft
from deltamesh._shape.complexes import distinct_faces
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container.container import Container, Parameters
from deltamesh_formats.meshfiles.number_text import rounded


def encode(draft: Draft) -> tuple[dict[str, bytes], Draft]:
    """Return the payloads of the smallest geometry that is good enough, and the draft with it."""
    options, structure, V = draft.options, draft.shape.structure, draft.positions
    surface, used = structure.surface, structure.complex.used
    factor = factorization(surface.laplacian, options.solver, options.threads)
    scale = diagonal(V)
    asked = bounds_of(options, scale)
    bounds = None if asked is None else asked.before_writing(scale)
    faces = _measured(draft)

    def recorded(decoded: Floats) -> VertexErrors:
        return rounded_up(vertex_errors(V, decoded, faces))

    def written(decoded: Floats) -> VertexErrors:
        errors = recorded(decoded)
        margin = position_margin(errors, scale, decoded, structure.complex.manifold_faces)
        return worst(errors, recorded(rounded(decoded, margin)))

    def attempt(errors_of: Callable[[Floats], VertexErrors], settings: Settings) -> Trial:
        draft.progress(f"geometry, {settings.method}")
        coder = geometry_codec(settings.method)
        parameters, integers, decoded = coder.quantize(
            surface, V[:used], V[used:], settings, factor
        )
        if not has_scale(parameters, integers):
            largest = float(np.abs(V).max())
            reason = f"coordinates of {largest:g} are too large for method {settings.method}"
            raise ScaleError(f"{reason}: try lossless")
        payloads = partial(coder.encode, surface, parameters, integers)
        return Trial(settings, parameters, integers, payloads, decoded, errors_of(decoded))

    edge = mean_edge(V[:used], surface.faces)
    trial = smallest(options, bounds, edge, partial(attempt, errors_from(V, faces)))
    if bounds is not None and bounds.excess(written(trial.vertices)) * DECODED > 1:
        # So near to a bound that digits count, or a mesh of which the search has lost some.
        trial = smallest(options, bounds, edge, partial(attempt, written))
    errors = recorded(trial.vertices)
    content = replace(draft.content, integers=trial.integers)
    payloads, trial = trial.payloads, replace(trial, errors=errors)
    return payloads, replace(draft, trial=trial, content=content)


def decode(container: Container, content: Content) -> Content:
    """Return the content with the integers of the geometry: the mirror of `encode`."""
    parameters = container.parameters
    surface, coder = content.structure.surface, geometry_codec(parameters.method)
    return replace(content, integers=coder.decode(surface, parameters, container.sections))


def has_scale(p: Parameters, i: Integers) -> bool:
    """Return whether no position that these integers could mean would overflow (SPEC.md 5.7)."""
    numbers = (i.values, i.positions, i.isolated, i.refinements, i.corrections)
    values = max(int(np.abs(a).max(initial=0)) for a in numbers)
    steps, origin = max(p.coarse * p.step, p.anchor_step), max(map(abs, p.origin))
    return bool(values * steps + origin <= 100 * LARGEST)


def _measured(draft: Draft) -> Ints:
    """Return the triangles over points on which errors are measured: those of any reader."""
    mesh, structure = draft.mesh, draft.shape.structure
    if not len(structure.merged):
        return structure.complex.manifold_faces
    return distinct_faces(draft.shape.points[mesh.triangles])
