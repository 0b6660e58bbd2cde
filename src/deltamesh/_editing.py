"""Edits of a compressed mesh: poses that are added to a file or removed, other sections stay."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace

from deltamesh._content import Content
from deltamesh._decode_options import DecodeOptions
from deltamesh._geometry.editing import Held, deformed
from deltamesh._geometry.poses import Pose, measured
from deltamesh._geometry.rotations import to_quaternions
from deltamesh._handles import Move, Vertices, held
from deltamesh._limits import DEFAULT_MAX_VERTICES, DEFAULT_MEMORY, check_pose
from deltamesh._measures.metrics import diagonal, vertex_errors
from deltamesh._options import check_decoding
from deltamesh._pipeline.decoder import points_at_rest, proven_content
from deltamesh._pipeline.proof import proven
from deltamesh._posing import check_name, in_pose, posed_points, posing_system, with_isolated
from deltamesh._progress import Progress, heard
from deltamesh._sections.poses import encode, tree_of_anchors
from deltamesh._sources import Source, read_source
from deltamesh._vectors import lengths
from deltamesh_formats.arguments import require, require_above_0, require_type
from deltamesh_formats.array_types import Bools, Floats
from deltamesh_formats.container.building import build_container
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.fields import STRING_MAX_BYTES
from deltamesh_formats.container.layout import CHECK, META, PARAMETERS, POSES
from deltamesh_formats.container.method_layouts import METHODS
from deltamesh_formats.container.pose_table import entries_of, pose_fault
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.container.writer import write_container
from deltamesh_formats.errors import MeshError, OptionError
from deltamesh_formats.polymesh.mesh import PolyMesh

# Steps of displacements in the diagonal of the surface, and the unit of rotations: both are finer
# than what anchors leave open between them, and coarser ones save a fifth of a pose.
STEPS = 4096
OCTAVES = 11


@dataclass(frozen=True)
class Edited:
    """A file with one pose more.

    Attributes
    ----------
    data : bytes
        The file.
    name : str
        Of the pose.
    size : int
        Bytes of the pose in it.
    anchors : int
        Anchors of the file, whose motions the pose has.
    mesh : PolyMesh
        As `deltamesh.decode` returns it in this pose.
    exact : PolyMesh
        The edit before it was recorded at the anchors.
    missed, recorded_missed : float
        The largest distance of a vertex that was moved from where it was put, in `exact` and in
        `mesh`, over the diagonal of the bounding box at rest.
    rms, max : float
        Distances between the vertices of both, over that diagonal.
    normal : float
        Mean angle between the face normals of both, in degrees.
    dihedral, recorded_dihedral : float
        Mean change of the dihedral angles by the edit, in degrees, in `exact` and in `mesh`.
    """

    data: bytes = field(repr=False)
    name: str
    size: int
    anchors: int
    mesh: PolyMesh = field(repr=False)
    exact: PolyMesh = field(repr=False)
    missed: float
    recorded_missed: float
    rms: float
    max: float
    normal: float
    dihedral: float
    recorded_dihedral: float


def edit(
    source: Source | Container,
    moves: Sequence[Move],
    fix: Sequence[Vertices] = (),
    *,
    name: str,
    step: float | None = None,
    solver: str = "auto",
    threads: int | None = None,
    max_vertices: int = DEFAULT_MAX_VERTICES,
    memory: int = DEFAULT_MEMORY,
    progress: Progress | None = None,
) -> Edited:
    """Add a pose to a file: some vertices are moved, some stay, and the surface follows.

    Parameters
    ----------
    source : path, binary file object, bytes-like, or what `info` returned
        A file of method refined or highpass, whose anchors record the pose.
    moves : sequence of pairs
        Vertices of the mesh that `decode` returns, by indices, a mask or the name of a part; and
        where they go. A matrix, float (4, 4), turns and shifts them; a shift, float (3,), or
        positions, float (k, 3), leave open how they turn, which then follows from the surface.
    fix : sequence of vertices
        Those that stay where they are, and are not turned.
    name : str
        Of the pose: printable, of at most 255 bytes, and no other pose's.
    step : float, optional
        Of the displacements that are stored, in the unit of the mesh. Default: 1/4096 of the
        diagonal of the bounding box.
    solver, threads, max_vertices, memory, progress
        As in `deltamesh.decode`.

    Returns
    -------
    Edited
        The bytes of the file, and how well its anchors record the edit. All sections but POSE and
        the checksum are those of the source, byte for byte.

    Raises
    ------
    OptionError
        For vertices that there are not, that are moved twice or are fixed, too, or that belong to
        no face; for a matrix that mirrors; for a name that cannot be one, or is taken; for
        arguments of a wrong type, or out of range.
    MeshError
        If the file has no anchors.
    FormatError, LimitError, SolveError, OSError

    Notes
    -----
    Components of which nothing is moved or fixed stay. Between the vertices that are held, nothing
    says where the surface goes but its own shape. The rotations of neighbouring vertices that are
    held, and of neighbouring anchors, have to differ by much less than 180 degrees.

    Y. Lipman, O. Sorkine, D. Levin, D. Cohen-Or, "Linear rotation-invariant coordinates for
    meshes", SIGGRAPH 2005.
    """
    check_decoding(solver, threads, max_vertices, memory)
    for argument, value in (("moves", moves), ("fix", fix)):
        fits = isinstance(value, Iterable) and not isinstance(value, (str, bytes))
        require(fits, f"{argument} must be a sequence", value)
    return edit_chosen(
        _container_of(source, memory),
        lambda mesh: (moves, fix),
        DecodeOptions(solver, threads, max_vertices, memory, heard(progress)),
        name=name,
        step=step,
    )


def edit_chosen(
    container: Container,
    choose: Callable[[PolyMesh], tuple[Sequence[Move], Sequence[Vertices]]],
    options: DecodeOptions,
    *,
    name: str,
    step: float | None = None,
) -> Edited:
    """Do as `edit` does, with moves and fixed vertices that are chosen of the mesh at rest."""
    _check(container, name, step)
    progress, solving = options.progress, (options.solver, options.threads)
    to_solve = check_pose(container, options.memory)
    content = proven_content(container, options.max_vertices, options.memory, progress)
    surface = content.structure.surface
    points = points_at_rest(container, surface, [content.integers], options)
    mesh = content.mesh(points, container.parameters.single, container.margin)
    anchors = content.integers.anchors
    rest, size = points[: surface.vertex_count], diagonal(points) or 1.0
    places, is_moved = held(mesh, content, rest, *choose(mesh))
    progress("edit")
    exact, turns = deformed(surface.graph, rest, places, *solving, to_solve)
    pose = measured(
        name,
        size / STEPS if step is None else step,
        OCTAVES,
        tree_of_anchors(content),
        rest[anchors],
        exact[anchors],
        to_quaternions(turns[anchors]),
    )
    progress("pose")
    system = posing_system(content, *solving, to_solve)
    recorded, recorded_turns = posed_points(content, points, system, pose)
    near = recorded[: len(rest)]
    made = _with_poses(container, content, (*content.poses, pose))
    errors = vertex_errors(exact, near, surface.faces)
    return Edited(
        data=write_container(made),
        name=name,
        size=entries_of(made)[-1].size,
        anchors=len(anchors),
        mesh=in_pose(mesh, content, recorded, recorded_turns),
        exact=in_pose(mesh, content, *with_isolated(points, exact, turns)),
        missed=_missed(places, is_moved, exact) / size,
        recorded_missed=_missed(places, is_moved, near) / size,
        rms=errors.rms / size,
        max=errors.max / size,
        normal=errors.normal_deviation,
        dihedral=vertex_errors(rest, exact, surface.faces).dihedral,
        recorded_dihedral=vertex_errors(rest, near, surface.faces).dihedral,
    )


def remove_poses(
    source: Source | Container,
    names: str | Iterable[str],
    *,
    max_vertices: int = DEFAULT_MAX_VERTICES,
    memory: int = DEFAULT_MEMORY,
    progress: Progress | None = None,
) -> bytes:
    """Remove poses from a file, whose mesh stays as it is.

    Parameters
    ----------
    source : path, binary file object, bytes-like, or what `info` returned
    names : str or iterable of str
        Of the poses: one name, or several.
    max_vertices, memory, progress
        As in `deltamesh.decode`; no positions are solved for.

    Returns
    -------
    bytes
        The file. All sections but POSE and the checksum are those of the source, byte for byte; a
        file whose only pose is removed is the one to which that was added.

    Raises
    ------
    OptionError
        If the file has no pose of a name.
    FormatError, LimitError, OSError
    """
    check_decoding("auto", None, max_vertices, memory)
    require(isinstance(names, Iterable), "names must be names of poses", names)
    container = _container_of(source, memory)
    removed = {names} if isinstance(names, str) else set(names)
    for name in removed:
        check_name(container, name)
    content = proven_content(container, max_vertices, memory, heard(progress))
    kept = tuple(pose for pose in content.poses if pose.name not in removed)
    return write_container(_with_poses(container, content, kept))


def _container_of(source: Source | Container, memory: int) -> Container:
    return source if isinstance(source, Container) else read_container(read_source(source, memory))


def _check(container: Container, name: str, step: float | None) -> None:
    """Refuse what a file cannot record, before it is decoded."""
    require_type("name", name, str)
    if step is not None:
        require_above_0("step", step)
    method = METHODS[container.parameters.method]
    if not container.parameters.anchor_count:
        raise MeshError(
            f"poses are motions of anchors, and a file of method {method.name} has none: encode "
            "with method refined"
        )
    fault = pose_fault(name, 1.0 if step is None else step, OCTAVES)
    if fault:
        raise OptionError(fault[1])
    if len(name.encode(errors="replace")) > STRING_MAX_BYTES:
        raise OptionError(f"a name of a pose of more than {STRING_MAX_BYTES} bytes")
    if name in [entry.name for entry in entries_of(container)]:
        raise OptionError(f"the file has a pose {name!r} already")


def _missed(places: Held, is_moved: Bools, positions: Floats) -> float:
    """Return the largest distance of a moved vertex from where it was put."""
    far = lengths(positions[places.vertices] - places.positions)[is_moved]
    return float(far.max(initial=0.0))


def _with_poses(container: Container, content: Content, poses: tuple[Pose, ...]) -> Container:
    """Return a file with other poses, once it has been read again."""
    content = replace(content, poses=poses)
    own = (PARAMETERS, META, POSES, CHECK)
    payloads = {
        section: bytes(container.sections[section].payload)
        for section in container.sections
        if section not in own
    }
    made = build_container(
        container.vertices,
        container.triangles,
        container.parameters,
        {**payloads, POSES: encode(content)} if poses else payloads,
        container.meta,
        content.digest(),
    )
    return proven(write_container(made))
