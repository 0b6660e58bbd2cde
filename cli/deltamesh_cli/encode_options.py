"""Options that say how a mesh is encoded, for `encode`, `batch` and `bench`."""

from __future__ import annotations

from typing import Any, Final

import click
from click.core import ParameterSource

from deltamesh._methods import AUTO, LOSSLESS
from deltamesh._options import (
    ANCHOR_METHODS,
    CHOICES,
    DEFAULT_BITS_NORMAL,
    DEFAULT_BITS_UV,
    DEFAULT_COARSE,
    DEFAULT_EFFORT,
    DEFAULT_QUALITY,
    MAX_BITS,
    MAX_BITS_NORMAL,
    MAX_BITS_UV,
    MAX_COARSE,
    MAX_EFFORT,
    MAX_QUALITY,
    MIN_BITS_NORMAL,
    SOLUTIONS,
    check_together,
)
from deltamesh_cli import options
from deltamesh_cli.value_types import anchor_count, coarse_factor, positive, whole
from deltamesh_formats.errors import OptionError

_BOUNDS: Final = options.combined(
    click.option(
        "--quality",
        type=whole(1, MAX_QUALITY),
        metavar=f"1..{MAX_QUALITY}",
        help="Quality level. Level 5 keeps the mean deviation of the face normals within 1 degree"
        " and the RMS distance within 0.15 % of the diagonal of the bounding box, in the whole and"
        " in each connected component and object by its own diagonal; each two levels more halve"
        f" both bounds.  [default: {DEFAULT_QUALITY}]",
    ),
    click.option(
        "--normal-error",
        type=positive,
        metavar="DEG",
        help="Upper bound on the mean deviation of the face normals, in degrees, in the whole and"
        " in each part.",
    ),
    click.option(
        "--dihedral-error",
        type=positive,
        metavar="DEG",
        help="Upper bound on the mean deviation of the dihedral angles, in degrees, likewise.",
    ),
    click.option(
        "--rms-error",
        type=positive,
        metavar="LENGTH",
        help="Upper bound on the RMS distance of the vertices from their original positions, in the"
        " unit of the mesh.",
    ),
    click.option(
        "--rms-error-rel",
        type=positive,
        metavar="FRACTION",
        help="The same bound as a fraction of the diagonal of the bounding box.",
    ),
    click.option(
        "--max-error",
        type=positive,
        metavar="LENGTH",
        help="Upper bound on the distance of each vertex from its original position, in the unit"
        " of the mesh.",
    ),
    click.option(
        "--max-error-rel",
        type=positive,
        metavar="FRACTION",
        help="The same bound as a fraction of the diagonal of the bounding box.",
    ),
    click.option(
        "--only",
        is_flag=True,
        default=None,
        help="Keep the given bounds alone. Without it, where only angles (normals, dihedral), or"
        f" only distances (RMS, max), are bounded, quality {DEFAULT_QUALITY} bounds the others.",
    ),
    click.option(
        "--effort",
        type=whole(1, MAX_EFFORT),
        metavar=f"1..{MAX_EFFORT}",
        help=f"Thoroughness of the search for the smallest file.  [default: {DEFAULT_EFFORT}]",
    ),
)

_METHOD: Final = options.combined(
    click.option(
        "--method",
        type=click.Choice(CHOICES),
        default=AUTO,
        show_default=True,
        help="Geometry method. refined quantizes differential coordinates coarsely along the"
        " surface and finely across it (for scans and organic shapes); highpass quantizes them"
        " equally in all directions; cartesian quantizes x, y, z (for CAD); lossless quantizes"
        " nothing. auto tries refined and cartesian and keeps the smaller file.",
    ),
    click.option(
        "--lossless",
        is_flag=True,
        help="Keep positions to the last bit, including the sign of zero; short for"
        " --method lossless.",
    ),
    click.option(
        "-b",
        "--bits",
        type=whole(0, MAX_BITS),
        metavar="B",
        help="Bits per coordinate, instead of a quality: the step is the range of the quantized"
        " values divided by 2^B. With 0 bits, only connectivity and anchors are stored. Errors are"
        " not bounded at a rate, only told.",
    ),
    click.option(
        "--step",
        type=positive,
        metavar="LENGTH",
        help="Quantization step, in the unit of the mesh, instead of a quality.",
    ),
    click.option(
        "--coarse",
        type=coarse_factor,
        metavar="C",
        help="With refined, the ratio of the step along the surface to the step across it,"
        f" 1 to {MAX_COARSE:g}.  [default: {DEFAULT_COARSE:g}, or found by search]",
    ),
)

_ANCHORS: Final = options.combined(
    click.option(
        "--anchors",
        type=anchor_count,
        metavar="K|FRACTION",
        help="Number of anchors, which are vertices with a stored position, or their fraction of"
        " all vertices.  [default: 0.001]",
    ),
    click.option(
        "--anchor-method",
        type=click.Choice(ANCHOR_METHODS),
        help="Choice of the anchors: farthest spreads them over the surface, greedy puts them"
        " where the error is largest (slower), random draws them.  [default: farthest]",
    ),
    click.option(
        "--diffusion/--no-diffusion",
        default=None,
        help="Pass each rounding error on to the neighbours that are coded later, which lowers the"
        " error at the same size, or use plain rounding.  [default: diffusion]",
    ),
    click.option(
        "--solution",
        type=click.Choice(SOLUTIONS),
        help="Positions that anchors and differential coordinates give: interpolated go through the"
        " anchors, and are found in a time that grows with the mesh alone; least-squares come as"
        " near to both as they can.  [default: interpolated with refined, else least-squares]",
    ),
    click.option(
        "--seed",
        type=whole(0, 2**64 - 1),
        metavar="N",
        help="Seed of the random anchors.  [default: 0]",
    ),
)

_CONTENT: Final = options.combined(
    click.option(
        "--drop-isolated",
        is_flag=True,
        default=None,
        help="Leave out vertices that belong to no face.",
    ),
    click.option(
        "--keep-order",
        is_flag=True,
        default=None,
        help="Keep vertices and faces in the order of IN, and the first corner of each face.",
    ),
    click.option(
        "--drop",
        multiple=True,
        callback=lambda context, parameter, names: list(names) or None,
        metavar="NAME",
        help="Leave out everything with this name: an attribute, a role (uv, normal, colour), a"
        " kind of parts (object, mesh, group, material, smoothing), a key of metadata, transforms,"
        " or all. The option may be repeated; names that IN does not have are ignored.",
    ),
    click.option(
        "--bits-uv",
        type=whole(1, MAX_BITS_UV),
        metavar="B",
        help="Bits of texture coordinates: the larger of their extents has 2^B steps."
        f"  [default: {DEFAULT_BITS_UV}]",
    ),
    click.option(
        "--bits-normal",
        type=whole(MIN_BITS_NORMAL, MAX_BITS_NORMAL),
        metavar="B",
        help="Bits of unit normals: each side of the unfolded octahedron has 2^B steps."
        f"  [default: {DEFAULT_BITS_NORMAL}]",
    ),
    click.option(
        "--lossless-attributes",
        is_flag=True,
        default=None,
        help="Keep all attributes to the last bit, as --lossless does. Otherwise texture"
        " coordinates, unit normals and floating-point colours are rounded.",
    ),
)

# All options that say how a file is encoded, and from which format.
encode_options: Final = options.combined(
    _BOUNDS,
    _METHOD,
    _ANCHORS,
    _CONTENT,
    options.input_format,
    options.solver,
    options.threads,
)


def check_encode_options(parameters: dict[str, Any]) -> None:
    """Refuse options that exclude each other, and replace `lossless` by the method.

    The parameters that remain are keywords of `deltamesh.encode`.
    """
    if parameters.pop("lossless"):
        _choose_lossless(parameters)
    try:
        check_together(parameters["method"], options.specified(parameters), options.flag_of)
    except OptionError as error:
        raise click.UsageError(f"{error}.") from error


def _choose_lossless(parameters: dict[str, Any]) -> None:
    source = click.get_current_context().get_parameter_source("method")
    method = parameters["method"]
    if source is not ParameterSource.DEFAULT and method != LOSSLESS.name:
        raise click.UsageError(f"--lossless and --method {method} exclude each other.")
    parameters["method"] = LOSSLESS.name
