"""Draft of a file: the state of its encoder between two sections."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from deltamesh._content import NOTHING, Content
from deltamesh._geometry.importance import importance_of
from deltamesh._geometry.systems import Systems
from deltamesh._geometry.trial import Trial
from deltamesh._measures.measure import Measured
from deltamesh._measures.report import Report
from deltamesh._options import Options
from deltamesh._parts import Annotations, annotations_of
from deltamesh._progress import Progress
from deltamesh._shape.diagonals import cut_polygons
from deltamesh._shape.draft import ShapeDraft, first_draft
from deltamesh_formats.array_types import Floats
from deltamesh_formats.caching import cached_property
from deltamesh_formats.container.regions import Regions
from deltamesh_formats.errors import MeshError
from deltamesh_formats.polymesh.dropping import without
from deltamesh_formats.polymesh.mesh import PolyMesh


@dataclass(frozen=True)
class Cost:
    """The bound that cost the bytes: a looser one would have made the file smaller.

    Attributes
    ----------
    name : str
    error, bound : float
    part : str or None
        The name of the part that it holds back; None for the whole.
    """

    name: str
    error: float
    bound: float
    part: str | None


@dataclass(frozen=True)
class Sequence:
    """Frames of a sequence beyond the first, as they are to be encoded.

    Attributes
    ----------
    positions : tuple of float64 (n, 3)
        Of the vertices of the mesh, frame by frame.
    rate : float
        Frames a second; 0 if that is unknown.
    key_every : int
        Every so many frames, one is predicted from the first frame alone.
    """

    positions: tuple[Floats, ...] = ()
    rate: float = 0.0
    key_every: int = 1


@dataclass(frozen=True)
class FrameResult:
    """A further frame that was encoded.

    Attributes
    ----------
    index : int
    measured : Measured
    cost : Cost or None
        As in `Draft`, of this frame.
    """

    index: int
    measured: Measured
    cost: Cost | None


# One frame.
ALONE: Final = Sequence()


@dataclass(frozen=True)
class Draft:
    """State of an encoder between two sections.

    Attributes
    ----------
    mesh : PolyMesh
        The input, without what is to be dropped.
    options : Options
    progress : callable
        Called with the name of each stage as it begins.
    shape : ShapeDraft
    sequence : Sequence
        The further frames.
    systems : Systems or None
        What positions are solved from, once there is a geometry.
    trial : Trial or None
        The geometry that was chosen.
    report : Report or None
        What became of the shape.
    cost : Cost or None
        The bound that cost the bytes; None where there were no bounds.
    importance : float64 (n,), or None
        Of each vertex of the input; None where all are alike.
    regions : Regions or None
        What became of the vertices of importance 1, and of the others, where they are not alike.
    margin : int
        How far a writer may round decoded positions, as `Meta.margin` has it.
    frames : tuple of FrameResult
        What became of the further frames.
    content : Content
        As a decoder knows it after the same sections.
    """

    mesh: PolyMesh
    options: Options
    progress: Progress
    shape: ShapeDraft
    sequence: Sequence = ALONE
    systems: Systems | None = None
    trial: Trial | None = None
    report: Report | None = None
    cost: Cost | None = None
    importance: Floats | None = None
    regions: Regions | None = None
    margin: int = 0
    frames: tuple[FrameResult, ...] = ()
    content: Content = NOTHING

    @property
    def chosen(self) -> Trial:
        """The geometry that was chosen, once it is."""
        assert self.trial is not None
        return self.trial

    @property
    def positions(self) -> Floats:
        """The input's position of each point, float64 (p, 3)."""
        return self.of_points(self.mesh.vertices)

    @property
    def costliest(self) -> Cost | None:
        """The bound that cost the bytes, in the frame that comes the nearest to it."""
        costs = [self.cost, *(frame.cost for frame in self.frames)]
        found = [cost for cost in costs if cost is not None]
        return max(found, key=lambda cost: cost.error / (cost.bound or 1.0), default=None)

    def of_points(self, vertices: Floats) -> Floats:
        """Return the rows of the points, float64 (p, 3), of those of the vertices, (n, 3)."""
        return vertices[self.shape.triangle_provenance.points]

    @cached_property
    def annotations(self) -> Annotations | None:
        """Parts, names, transforms and metadata of the input, None if it has none."""
        return annotations_of(self.mesh, self.shape.provenance.polygons)


def begin(
    mesh: PolyMesh, options: Options, progress: Progress, sequence: Sequence = ALONE
) -> Draft:
    """Return the draft before the first section.

    Raises
    ------
    MeshError
        If the mesh has no faces, or a vertex an importance outside of 0..1.
    OptionError
        If there is no such importance.
    """
    given = options.importance
    importance = None if given is None else importance_of(mesh, given)
    mesh = without(mesh, options.drop)
    triangles = cut_polygons(mesh)
    if len(triangles.faces) == 0:
        raise MeshError("the mesh has no faces")
    progress("topology")
    exact, drop_isolated = options.exact, options.drop_isolated
    frames = sequence.positions
    shape = first_draft(mesh.vertices, triangles, frames, drop_isolated=drop_isolated, exact=exact)
    return Draft(mesh, options, progress, shape, sequence, importance=importance)
