"""Trials of the geometry of one frame: quantized, decoded, and measured against the input."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from deltamesh._geometry.bounds import Binding, Bounds, bounds_of
from deltamesh._geometry.frames import encode_frame, relative
from deltamesh._geometry.importance import important, of_points
from deltamesh._geometry.integers import Integers
from deltamesh._geometry.interpolation import FINER
from deltamesh._geometry.methods import frame_codec, geometry_codec
from deltamesh._geometry.positions import doubt
from deltamesh._geometry.prediction import Prediction
from deltamesh._geometry.search import missed_bounds
from deltamesh._geometry.steps import anchor_ratios, ratios
from deltamesh._geometry.systems import Systems
from deltamesh._geometry.trial import ScaleError, Trial
from deltamesh._measures.margins import margin_of
from deltamesh._measures.measure import Measure, Measured
from deltamesh._measures.metrics import diagonal
from deltamesh._measures.named_parts import NamedParts, named_parts
from deltamesh._mesh import LARGEST
from deltamesh._options import Settings
from deltamesh._sections.draft import Cost, Draft
from deltamesh._shape.complexes import distinct_faces
from deltamesh._vectors import largest
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container.container import Parameters
from deltamesh_formats.errors import MeshError, SolveError, TargetError


class Trials:
    """Trials of the geometry of a frame.

    Parameters
    ----------
    draft : Draft
    vertices : float64 (n, 3)
        The frame's positions of the vertices of the mesh.
    systems : Systems
    label : str
        The name of the stage, before that of the method.
    """

    def __init__(self, draft: Draft, vertices: Floats, systems: Systems, label: str) -> None:
        structure = draft.shape.structure
        self._draft, self.systems, self._label = draft, systems, label
        self.surface, self.used = structure.surface, structure.complex.used
        self.positions = draft.of_points(vertices)
        mesh = replace(draft.mesh, vertices=vertices)
        self.faces, polygons = _measured(draft, vertices)
        isolated = len(self.positions) - self.used
        component = np.pad(self.surface.labels, (0, isolated), constant_values=-1)
        self.named: NamedParts = named_parts(mesh, self.faces, polygons, component)
        self.importance = _importance(draft)
        self.measure = Measure(self.positions, self.faces, self.named.parts, self.importance)
        self.scale = diagonal(self.positions)
        self.bounds: Bounds | None = bounds_of(draft.options, self.scale)

    def attempt(self, settings: Settings, predicted: Prediction | None = None) -> Trial:
        """Return the trial of some settings.

        Raises
        ------
        ScaleError
            If coordinates are too large for the method.
        MeshError
            If the step is too small for the mesh or, where there are bounds, for the solver.
        SolveError
            Without bounds.
        """
        self._draft.progress(f"{self._label}, {settings.method}")
        coder, V, used = frame_codec(settings.method), self.positions, self.used
        known = () if predicted is None else (predicted,)
        solution = self._draft.options.solution
        weighted = important(self.surface, self.importance, settings, solution)
        try:
            parameters, integers, decoded = coder.quantize(
                self.surface, V[:used], V[used:], weighted, self.systems, *known
            )
        except SolveError as error:
            if self.bounds is None:
                raise
            raise MeshError(str(error)) from error  # of this step; a search has others
        if not has_scale(parameters, integers):
            reason = f"coordinates of {largest(V):g} are too large for method {settings.method}"
            raise ScaleError(f"{reason}: try lossless")
        return self._trial(settings, parameters, integers, decoded, predicted)

    def unmoved(self, settings: Settings, predicted: Prediction) -> Trial:
        """Return the trial that leaves the frame where its reference is."""
        reference, n = predicted.reference, self.used
        before = reference.integers
        zeros = np.zeros((n, 3), dtype=np.int64)
        integers = Integers(
            *(zeros, before.anchors, before.positions, before.isolated),
            refinements=np.zeros_like(before.refinements),
            exponents=before.exponents,
        )
        coder, parameters = frame_codec(settings.method), reference.parameters
        found = coder.reconstruct(self.surface, parameters, integers, self.systems, predicted)
        return self._trial(settings, parameters, integers, found, predicted)

    def _trial(
        self,
        settings: Settings,
        parameters: Parameters,
        integers: Integers,
        decoded: Floats,
        predicted: Prediction | None,
    ) -> Trial:
        encode: Callable[[], dict[str, bytes]]
        doubtful = doubt(parameters)
        if predicted is None:
            encode = partial(
                geometry_codec(settings.method).encode, self.surface, parameters, integers
            )
        else:
            seen = relative(parameters, integers, predicted.reference)
            encode = partial(encode_frame, self.surface, parameters, seen, predicted.motion)
            doubtful += predicted.reference.doubt
        measured = replace(self.measure(decoded), doubt=doubtful)
        return Trial(settings, parameters, integers, encode, decoded, measured)

    def as_decoded(self, trial: Trial, predicted: Prediction | None = None) -> Trial:
        """Return a trial with the positions that a decoder makes.

        A search begins its iterations elsewhere: what they find is as near to the solution.
        """
        if not trial.parameters.interpolated:
            return trial
        systems = self.systems
        if self._draft.mesh.attributes and predicted is None:
            systems = systems.to_precision(FINER)
        coder, payloads = frame_codec(trial.settings.method), trial.payloads
        known = () if predicted is None else (predicted,)
        found = coder.reconstruct(self.surface, trial.parameters, trial.integers, systems, *known)
        measured = replace(self.measure(found), doubt=trial.measured.doubt)
        return replace(trial, encode=lambda: payloads, vertices=found, measured=measured)

    def margin(self, trial: Trial) -> int:
        """Return the margin within which what is written keeps the bounds, too."""

        def keeps(measured: Measured) -> bool:
            return self.bounds is None or self.bounds.excess(measured) <= 1

        return margin_of(self.measure, trial.measured, trial.vertices, self.scale, keeps)

    def cost(self, trial: Trial) -> Cost | None:
        """Return the bound that cost the bytes, None without bounds."""
        if self.bounds is None:
            return None
        binding: Binding = self.bounds.binding(trial.measured)
        part = None if binding.part is None else self.named.name(binding.part)
        return Cost(binding.name, binding.error, binding.bound, part)

    def missed(self, trials: list[Trial]) -> TargetError:
        """Return the error to raise where the best of these trials is beyond the bounds."""
        if not trials or self.bounds is None:
            return TargetError("no quantization step that fits the mesh is small enough")
        return missed_bounds(self.bounds, trials[-1].measured, self.named.name)


def has_scale(p: Parameters, i: Integers) -> bool:
    """Return whether no position that these integers could mean would overflow (SPEC.md 5.8)."""
    of_vertices, of_anchors = ratios(i), anchor_ratios(i)
    numbers: list[Floats | Ints] = [i.positions * of_anchors, i.isolated]
    numbers += [a * of_vertices[: len(a)] for a in (i.values, i.refinements, i.corrections)]
    numbers.append(np.ldexp(i.cells.astype(np.float64), i.units[:, None, None]))
    values = max(map(largest, numbers))
    steps, origin = max(p.coarse * p.step, p.anchor_step), max(map(abs, p.origin))
    return bool(values * steps + origin <= 100 * LARGEST)


def _importance(draft: Draft) -> Floats | None:
    """Return the importance of each point, float64 (p,); None where all are alike."""
    if draft.importance is None:
        return None
    return of_points(draft.importance, draft.shape.points, len(draft.positions))


def _measured(draft: Draft, vertices: Floats) -> tuple[Ints, Ints]:
    """Return the triangles over points on which errors are measured, and the polygon of each.

    They are those of any reader.
    """
    shape = draft.shape
    if not len(shape.structure.merged):
        faces = shape.structure.complex.manifold_faces
        triangles = shape.triangle_provenance.corners[: len(faces), 0] // 3
        return faces, shape.input.triangles.polygon[triangles]
    cut = replace(draft.mesh, vertices=vertices).triangulation()
    faces = shape.points[cut.faces]
    kept = distinct_faces(faces)
    return faces[kept], cut.polygon[kept]
