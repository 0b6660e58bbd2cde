"""Options that say how a mesh is encoded, for `encode`, `batch` and `bench`."""

from __future__ import annotations

from typing import Any, Final

import click
from click.core import ParameterSource

from deltamesh._methods import AUTO, LOSSLESS
from deltamesh._options import (
    ANCHOR_METHODS,
    CHOICES,
    DEFAULT_COARSE,
    DEFAULT_EFFORT,
    DEFAULT_QUALITY,
    MAX_BITS,
    MAX_COARSE,
    MAX_EFFORT,
    MAX_QUALITY,
    SOLUTIONS,
    check_together,
)
from deltamesh_cli import options
from deltamesh_cli.content_options import content_options
from deltamesh_cli.lengths import settle_shares
from deltamesh_cli.value_types import (
    anchor_count,
    coarse_factor,
    length,
    length_or_share,
    positive,
    positive_share,
    whole,
)
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
        type=length_or_share,
        metavar="LENGTH",
        help="Upper bound on the RMS distance of the vertices from their original positions: a"
        " number in the unit of the file, a length such as 0.05mm if the file has a unit (3MF,"
        " glTF, COLLADA), or a share such as 0.1% of the diagonal of the bounding box.",
    ),
    click.option(
        "--rms-error-rel",
        type=positive_share,
        metavar="FRACTION",
        help="The same bound as a fraction of the diagonal of the bounding box.",
    ),
    click.option(
        "--max-error",
        type=length_or_share,
        metavar="LENGTH",
        help="Upper bound on the distance of each vertex from its original position, likewise.",
    ),
    click.option(
        "--max-error-rel",
        type=positive_share,
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
        "--importance",
        metavar="NAME",
        help="Attribute of the vertices, from 0 to 1, that says where the bounds hold: where it is"
        " 1; one half allows twice the error and takes a bit less of each vertex, 0 allows any and"
        " takes none. MeshLab writes such an attribute as quality.",
    ),
    click.option(
        "--effort",
        type=whole(1, MAX_EFFORT),
        metavar=f"1..{MAX_EFFORT}",
        help="Thoroughness of the search for the smallest file; of meshes from two million"
        f" vertices on, 2 takes fewer trials.  [default: {DEFAULT_EFFORT}]",
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
        type=length,
        metavar="LENGTH",
        help="Quantization step instead of a quality: a number in the unit of the file, or a length"
        " such as 0.05mm if the file has a unit.",
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
        " where the error is largest (slower), random draws them.  [default: farthest with refined"
        " and above 50 million vertices times anchors, else greedy]",
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
        " near to both as they can.  [default: interpolated with refined, or what makes a small"
        " mesh smaller; else least-squares]",
    ),
    click.option(
        "--seed",
        type=whole(0, 2**64 - 1),
        metavar="N",
        help="Seed of the random anchors.  [default: 0]",
    ),
)

# All options that say how a file is encoded, and from which format.
encode_options: Final = options.combined(
    _BOUNDS,
    _METHOD,
    _ANCHORS,
    content_options,
    options.input_format,
    options.solver,
    options.threads,
)


def check_encode_options(parameters: dict[str, Any]) -> None:
    """Refuse options that exclude each other, and replace `lossless` by the method.

    The parameters that remain are keywords of `deltamesh.encode`, but for the units of lengths.
    """
    if parameters.pop("lossless"):
        _choose_lossless(parameters)
    settle_shares(parameters)
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
