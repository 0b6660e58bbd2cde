"""Draft of a file: the state of its encoder between two sections."""

from __future__ import annotations

from dataclasses import dataclass

from deltamesh._content import NOTHING, Content
from deltamesh._geometry.importance import importance_of
from deltamesh._geometry.trial import Trial
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
    content : Content
        As a decoder knows it after the same sections.
    """

    mesh: PolyMesh
    options: Options
    progress: Progress
    shape: ShapeDraft
    trial: Trial | None = None
    report: Report | None = None
    cost: Cost | None = None
    importance: Floats | None = None
    regions: Regions | None = None
    margin: int = 0
    content: Content = NOTHING

    @property
    def chosen(self) -> Trial:
        """The geometry that was chosen, once it is."""
        assert self.trial is not None
        return self.trial

    @property
    def positions(self) -> Floats:
        """The input's position of each point, float64 (p, 3)."""
        return self.mesh.vertices[self.shape.triangle_provenance.points]

    @cached_property
    def annotations(self) -> Annotations | None:
        """Parts, names, transforms and metadata of the input, None if it has none."""
        return annotations_of(self.mesh, self.shape.provenance.polygons)


def begin(mesh: PolyMesh, options: Options, progress: Progress) -> Draft:
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
    shape = first_draft(mesh.vertices, triangles, drop_isolated=drop_isolated, exact=exact)
    return Draft(mesh, options, progress, shape, importance=importance)
