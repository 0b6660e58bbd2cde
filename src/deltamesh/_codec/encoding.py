"""Encoder as callers see it: `encode`, from meshes and arrays to bytes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Unpack, overload

from numpy.typing import ArrayLike

from deltamesh._codec.inputs import Faces, encode_checked, encode_sequence, frames_of, mesh_of
from deltamesh._options import (
    DEFAULT_BITS_NORMAL,
    DEFAULT_BITS_UV,
    DEFAULT_EFFORT,
    DEFAULT_KEY_EVERY,
    EncodeOptions,
    Options,
    names_of,
)
from deltamesh._progress import Progress, heard
from deltamesh_formats.polymesh.mesh import PolyMesh


@overload
def encode(mesh: PolyMesh, **options: Unpack[EncodeOptions]) -> bytes: ...


@overload
def encode(mesh: Iterable[PolyMesh], **options: Unpack[EncodeOptions]) -> bytes: ...


@overload
def encode(mesh: ArrayLike, faces: Faces, **options: Unpack[EncodeOptions]) -> bytes: ...


def encode(
    mesh: PolyMesh | Iterable[PolyMesh] | ArrayLike,
    faces: Faces | None = None,
    *,
    method: str = "auto",
    bits: int | None = None,
    step: float | None = None,
    quality: int | None = None,
    normal_error: float | None = None,
    dihedral_error: float | None = None,
    rms_error: float | None = None,
    rms_error_rel: float | None = None,
    max_error: float | None = None,
    max_error_rel: float | None = None,
    only: bool = False,
    effort: int = DEFAULT_EFFORT,
    diffusion: bool = True,
    anchors: int | float | None = None,
    anchor_method: str | None = None,
    seed: int = 0,
    coarse: float | None = None,
    solution: str | None = None,
    solver: str = "auto",
    threads: int | None = None,
    drop_isolated: bool = False,
    keep_order: bool = False,
    drop: str | Iterable[str] = (),
    bits_uv: int = DEFAULT_BITS_UV,
    bits_normal: int = DEFAULT_BITS_NORMAL,
    bits_float: int | None = None,
    max_uv_error: float | None = None,
    max_attribute_error: Mapping[str, float] | None = None,
    lossless_attributes: bool = False,
    fps: float | None = None,
    key_every: int = DEFAULT_KEY_EVERY,
    importance: str | Iterable[float] | None = None,
    source_format: str = "",
    progress: Progress | None = None,
) -> bytes:
    """Compress a mesh, or a sequence: `encode(mesh)`, `encode(vertices, faces)`, `encode(frames)`.

    Connectivity is kept exactly, whatever it is, and polygons stay polygons; vertices and faces
    come back in an order of the codec's own unless `keep_order` says otherwise. Vertices at one
    position stay there, each for itself. Attributes, parts, metadata and `lost` of a mesh are kept,
    unless `drop` names them; its `format` is not, but `source_format` is.

    The frames of a sequence have the same vertices and faces, in the same order, at other
    positions. Each is predicted from the one before, as a decoder has it, and keeps all bounds for
    itself. What is the same in all frames is kept once; attributes that differ are not kept, but
    named in `lost`.

    Parameters
    ----------
    mesh : PolyMesh, iterable of PolyMesh, or array_like (n, 3) or (t, n, 3)
        A mesh, which `deltamesh.from_arrays` makes of arrays with attributes; the frames of a
        sequence; or the positions of the vertices, of all of them or frame by frame, finite real
        numbers of any type, with `faces`.
    faces : array_like (m, k), or a sequence of polygons
        Vertex indices from 0 of triangles, quads, or polygons of any sizes, as `from_arrays` takes
        them. Not with a `PolyMesh`.
    method : {"auto", "refined", "highpass", "cartesian", "lossless"}
        "refined" quantizes differential coordinates, coarsely, and their component along the normal
        finely; "highpass" these coordinates alike; "cartesian" x, y and z; "lossless" nothing:
        positions come back bit for bit, -0.0 and all. "auto" is refined or cartesian, whichever
        takes fewer bytes for the same errors, and cartesian where solving would take far more
        memory than on a surface. Where nothing was asked for and neither can keep the default
        quality, as of parts that are 1e9 of their sizes apart, it is lossless.
    bits : int, optional
        The step is the range of the quantized values over 2^bits. 0 is a least-squares mesh:
        connectivity and anchors alone. Errors are not bounded at a rate; "auto" is Cartesian then
        if no error is larger and the file is smaller, or if refined would move the vertices
        further than quality 1 allows.
    step : float, optional
        The step itself, in the unit of the vertices.
    quality : int, optional
        From 1 to 9, instead of bits or a step. 5, the default, keeps the mean deviation of the face
        normals within 1 degree, and the RMS distance of the vertices from where they
        were within 0.15 % of the diagonal of the bounding box; two levels more halve both. Each
        connected component, and each object, keeps them by its own diagonal. Unless it is given, a
        method that is named comes as near to it as it can.
    normal_error, dihedral_error : float, optional
        Bounds on angles: the largest mean deviation of the face normals, or of the dihedral angles,
        in degrees, of the whole mesh and of each of its parts. The file keeps all bounds, and the
        encoder has proved it by decoding.
    rms_error, rms_error_rel, max_error, max_error_rel : float, optional
        Bounds on distances: the largest RMS distance of the vertices from where they were, and the
        largest distance of any vertex, in the unit of the vertices or as a fraction of the diagonal
        of the bounding box of the mesh.
    only : bool
        Keep the bounds that are given, and no others. Otherwise, where a bound of one kind is given
        and none of the other, those of the default quality hold for the other kind.
    effort : int
        From 1 to 3: how long to search for the fewest bytes within the bounds. From two million
        vertices on, 2, the default, ends with errors of 85 % of their bounds, not 93 %.
    diffusion : bool
        Hand the error of each rounding on to the neighbours still to come.
    anchors : int or float, optional
        How many vertices are stored with their positions, or which fraction. Default: 0.001. At
        least one a component.
    anchor_method : {"farthest", "greedy", "random"}, optional
        How anchors are chosen: spread over the surface, where the error is largest, or at random.
        Default: "greedy" with "highpass" and with 0 bits, unless vertices times anchors are more
        than 50 million or anchors are interpolated; else "farthest".
    seed : int
        Of the random anchors.
    coarse : float, optional
        With "refined", the step along the surface over that across it, 1 to 64. Default: 5, or
        what the search finds.
    solution : {"interpolated", "least-squares"}, optional
        What positions make of differential coordinates and anchors. "interpolated", the default of
        "refined", go through the anchors, by a Poisson problem that multigrid solves; the encoder
        stores what makes up for the rounding of the coordinates around each anchor.
        "least-squares", the default of "highpass" and of 0 bits, come as near to both as they can,
        by a factorization, as in the papers. Up to 25,000 vertices, a search within bounds takes
        them with "refined", too, where the file becomes smaller.
    solver : {"auto", "core", "rslab", "pardiso", "scipy"}
        Default: the compiled core for small meshes, else rslab or, where it is missing, scipy.
    threads : int, optional
        Of the solvers, where a mesh has many vertices. Default: one for each core. The bytes do not
        depend on it.
    drop_isolated : bool
        Leave out the vertices that belong to no face.
    keep_order : bool
        Vertices and faces come back in the order of the input, each face from its first corner on.
    drop : str or iterable of str
        What to leave out of a whole mesh, by name: attributes or their roles ("uv", "normal",
        "colour"), kinds of parts, keys of metadata, "transforms", "all". A name that the mesh does
        not have is no error.
    bits_uv : int
        Texture coordinates of floats come back within half a step, which is the largest of their
        extents over 2^bits - 1. A few that lie far away do not count: without a hundredth of them,
        the extent may be less than half, and twice that counts then.
    bits_normal : int
        Unit normals come back within sqrt(2) / (2^(bits - 1) - 1) radians.
    bits_float : int, optional
        All other attributes of floats come back within half a step likewise. Default: bit for bit.
    max_uv_error : float, optional
        Instead of `bits_uv`, the largest error of each number of the texture coordinates.
    max_attribute_error : mapping of str to float, optional
        The largest error of each number of the attributes of a name, or of a role ("uv", "colour",
        "normal"); of unit normals, the largest angle in degrees. Integers stay as they are, and so
        do floats that are not finite, or too large for steps of that size.
    lossless_attributes : bool
        Both come back bit for bit instead, as all other attributes do but colours of floats within
        0 .. 1, which get 256 levels. So it is, too, with "lossless".
    fps : float, optional
        Of a sequence, how many frames there are in a second. It is stored, and nothing else.
    key_every : int
        Of a sequence, one frame in so many, 1 to 255, is predicted from the first frame alone: a
        frame is decoded from the first one, the key frame before it, and those in between.
    importance : str or array_like (n,), optional
        Of each vertex, from 0 to 1; or the name of an attribute of the vertices that has it.
        Bounds hold where it is 1. Elsewhere they are divided by it: one half allows twice the
        error, and takes a bit less, and 0 allows any and takes none. The error of a face, or of
        an edge, counts times the least importance of its corners; means are weighted by it. The
        file has the errors of both regions, and, roughly, the importance, in its steps. Not with
        "lossless"; "cartesian" has one step for each component, for the most important vertex.
    source_format : str
        Stored; the format that `deltamesh decode` writes by default.
    progress : callable, optional
        Called with the name of each stage as it begins.

    Returns
    -------
    bytes
        A `.dmesh` file (formats/SPEC.md).

    Raises
    ------
    MeshError
        If the arrays are not a mesh; the first element at fault is named. If a frame has another
        connectivity than the first one; the frame and the face are named. If decoding method
        "refined" or "highpass" would take more than twice the usual memory.
    OptionError
    TargetError
        If no trial keeps the errors within their bounds; the message has the least ones found.
    SolveError
    RuntimeError
        If the bytes do not decode to what they were made of. That would be a bug: nothing is
        returned.

    Notes
    -----
    The bytes have been read again, as `decode` does but for solving for positions, without limits:
    `decode` needs a higher `memory` than its default where that takes more.

    D. Cohen-Or, O. Sorkine, "Encoding Meshes in Differential Coordinates", SCCG 2006.
    """
    options = Options(
        method=method,
        bits=bits,
        step=step,
        quality=quality,
        normal_error=normal_error,
        dihedral_error=dihedral_error,
        rms_error=rms_error,
        rms_error_rel=rms_error_rel,
        max_error=max_error,
        max_error_rel=max_error_rel,
        only=only,
        effort=effort,
        diffusion=diffusion,
        anchors=anchors,
        anchor_method=anchor_method,
        seed=seed,
        coarse=coarse,
        solution=solution,
        solver=solver,
        threads=threads,
        drop_isolated=drop_isolated,
        keep_order=keep_order,
        drop=names_of(drop),
        bits_uv=bits_uv,
        bits_normal=bits_normal,
        bits_float=bits_float,
        max_uv_error=max_uv_error,
        max_attribute_error=max_attribute_error,
        lossless_attributes=lossless_attributes,
        fps=fps,
        key_every=key_every,
        importance=importance,
        source_format=source_format,
    )
    frames = frames_of(mesh, faces)
    if frames is not None:
        return encode_sequence(frames, options, heard(progress)).data
    return encode_checked(mesh_of(mesh, faces), options, heard(progress)).data
