"""Options that say which content of a mesh is kept, and how exactly, for `encode_options`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import click

from deltamesh._options import (
    DEFAULT_BITS_NORMAL,
    DEFAULT_BITS_UV,
    MAX_BITS_NORMAL,
    MAX_BITS_UV,
    MIN_BITS_NORMAL,
)
from deltamesh_cli import options
from deltamesh_cli.value_types import named_error, positive, whole


def _listed_names(texts: Iterable[str]) -> list[str]:
    """Return names in texts, between commas and, since a name may have commas, as a whole."""
    names = [name for text in texts for name in (text, *map(str.strip, text.split(",")))]
    return list(dict.fromkeys(names))


content_options: Final = options.combined(
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
        callback=lambda context, parameter, texts: _listed_names(texts) or None,
        metavar="NAME",
        help="Leave out everything with this name: an attribute, a role (uv, normal, colour), a"
        " kind of parts (object, mesh, group, material, smoothing), a key of metadata, transforms,"
        " or all. Several names are separated by commas, or the option is repeated; names that IN"
        " does not have are ignored.",
    ),
    click.option(
        "--bits-uv",
        type=whole(1, MAX_BITS_UV),
        metavar="B",
        help="Bits of texture coordinates: the larger of their extents, but for a few outliers, has"
        f" 2^B steps.  [default: {DEFAULT_BITS_UV}]",
    ),
    click.option(
        "--bits-normal",
        type=whole(MIN_BITS_NORMAL, MAX_BITS_NORMAL),
        metavar="B",
        help="Bits of unit normals: each side of the unfolded octahedron has 2^B steps."
        f"  [default: {DEFAULT_BITS_NORMAL}]",
    ),
    click.option(
        "--bits-float",
        type=whole(1, MAX_BITS_UV),
        metavar="B",
        help="Bits of all other attributes of floating-point numbers, likewise.  [default: every"
        " bit is kept]",
    ),
    click.option(
        "--max-uv-error",
        type=positive,
        metavar="E",
        help="Largest error of each texture coordinate, instead of --bits-uv.",
    ),
    click.option(
        "--max-attribute-error",
        type=named_error,
        multiple=True,
        callback=lambda context, parameter, pairs: dict(pairs) or None,
        metavar="NAME=E",
        help="Largest error of each floating-point number of the attributes with this name or role"
        " (uv, normal, colour); of unit normals, the largest angle in degrees. The option may be"
        " repeated.",
    ),
    click.option(
        "--lossless-attributes",
        is_flag=True,
        default=None,
        help="Keep all attributes to the last bit, as --lossless does. Otherwise texture"
        " coordinates, unit normals and floating-point colours are rounded.",
    ),
)
