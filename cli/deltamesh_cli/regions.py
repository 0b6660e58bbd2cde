"""Regions of a mesh on the command line, and the motions of what is in them.

A region is written as terms with "&" between them, a motion as words with blanks between them; the
help of `deltamesh edit` has both.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import click

if TYPE_CHECKING:
    from deltamesh_formats.array_types import Bools, Floats
    from deltamesh_formats.polymesh.mesh import PolyMesh

_HALF: Final = re.compile(r"([xyz])([<>])(-?[0-9.]+(?:[eE][+-]?[0-9]+)?)(%?)")
# Numbers of vertices that a float has exactly; no mesh has as many.
_SPAN: Final = re.compile(r"(\d{1,15})(?:-(\d{1,15}))?")
_AXES: Final = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
_PART: Final = "part:"


@dataclass(frozen=True)
class Term:
    """One condition of a region.

    Attributes
    ----------
    kind : {"part", "vertices", "half", "box", "ball"}
    name : str
        Of the part; of a half of the box, the axis and "<" or ">", and "%" if its number is one.
    numbers : tuple of float
        Pairs of first and last vertices; where the half ends; both corners of the box; the centre
        and the radius of the ball.
    """

    kind: str
    name: str = ""
    numbers: tuple[float, ...] = ()


@dataclass(frozen=True)
class Motion:
    """Motion of the vertices of a region.

    Attributes
    ----------
    shift : tuple of float, 3
    axis : tuple of float, 3, or None
        Of a rotation, where one is given.
    degrees : float
    about : tuple of float, 3, or None
        A point on the axis; None for the middle of the vertices.
    """

    shift: tuple[float, ...] = (0.0, 0.0, 0.0)
    axis: tuple[float, ...] | None = None
    degrees: float = 0.0
    about: tuple[float, ...] | None = None


def region(text: str) -> tuple[Term, ...]:
    """Read a region, such as "y<45%", "ball:0,0,1,0.2", "part:ear" or "y>80% & z>70%"."""
    if text.strip().startswith(_PART):  # a name may have any characters
        return (Term("part", text.strip().removeprefix(_PART)),)
    return tuple(_term(term.strip()) for term in text.split("&"))


def _term(text: str) -> Term:
    half = _HALF.fullmatch(text.replace(" ", ""))
    if half is not None:
        return Term("half", half[1] + half[2] + half[4], (_number(half[3], text),))
    kind, colon, rest = text.partition(":")
    if colon and kind == "vertices":
        spans = [_SPAN.fullmatch(one.strip()) for one in rest.split(",")]
        pairs = [(int(one[1]), int(one[2] or one[1])) for one in spans if one is not None]
        if len(pairs) == len(spans) and all(first <= last for first, last in pairs):
            return Term(kind, numbers=tuple(float(end) for pair in pairs for end in pair))
    if colon and kind in ("box", "ball"):
        return Term(kind, numbers=_numbers(rest, 6 if kind == "box" else 4, text))
    raise click.BadParameter(
        f"{text!r} is no region, such as 'y<45%', 'ball:X,Y,Z,R', 'box:X,Y,Z,X,Y,Z', 'part:NAME'"
        " or 'vertices:3,7-9'."
    )


def motion(text: str) -> Motion:
    """Read a motion, such as "turn=y,120 about=0,0,3 shift=1,0,2"."""
    found: dict[str, str] = {}
    for word in text.split():
        name, _, value = word.partition("=")
        if name not in ("shift", "about", "turn") or name in found:
            raise click.BadParameter(
                f"{word!r} is none of shift=X,Y,Z, turn=AXIS,DEGREES and about=X,Y,Z, each once."
            )
        found[name] = value
    if not found:
        raise click.BadParameter("an empty motion: it has no shift and no turn.")
    shift = _numbers(found.get("shift", "0,0,0"), 3, text)
    about = _numbers(found["about"], 3, text) if "about" in found else None
    if "turn" in found:
        axis, _, degrees = found["turn"].rpartition(",")
        turn = _AXES.get(axis) or _numbers(axis, 3, text)
        if not any(turn):
            raise click.BadParameter(f"{text!r} turns about an axis without a direction.")
        return Motion(shift, turn, _number(degrees, text), about)
    if about is not None:
        raise click.BadParameter(f"{text!r} has a point to turn about, and no turn.")
    return Motion(shift)


def _numbers(text: str, count: int, whole: str) -> tuple[float, ...]:
    numbers = tuple(_number(one, whole) for one in text.split(","))
    if len(numbers) != count:
        raise click.BadParameter(f"{whole!r} has {len(numbers)} numbers where {count} are needed.")
    return numbers


def _number(text: str, whole: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise click.BadParameter(f"{text!r} in {whole!r} is not a number.")
    return value


def vertices_in(mesh: PolyMesh, terms: tuple[Term, ...]) -> Bools:
    """Return which vertices of a mesh are in a region, bool (n,).

    Raises
    ------
    OptionError
        If there are none.
    """
    import numpy as np

    from deltamesh_formats.errors import OptionError

    chosen = np.ones(len(mesh.vertices), dtype=bool)
    for term in terms:
        chosen &= _in_term(mesh, term)
    if not chosen.any():
        raise OptionError("no vertices are in a region")
    return chosen


def _in_term(mesh: PolyMesh, term: Term) -> Bools:
    import numpy as np

    from deltamesh._handles import indices_of

    V = mesh.vertices
    if term.kind in ("part", "vertices"):
        chosen = np.zeros(len(V), dtype=bool)
        if term.kind == "part":
            chosen[indices_of(mesh, term.name)] = True
        ends = np.array(term.numbers, dtype=np.int64)
        indices_of(mesh, ends)  # refuses those that are not there
        for first, last in ends.reshape(-1, 2):
            chosen[first : last + 1] = True
        return chosen
    if term.kind == "half":
        column = V[:, "xyz".index(term.name[0])]
        (end,) = term.numbers
        if term.name.endswith("%"):
            end = column.min() + end / 100 * np.ptp(column)
        return np.asarray(column < end if term.name[1] == "<" else column > end)
    if term.kind == "box":
        low, high = np.sort(np.array(term.numbers).reshape(2, 3), axis=0)
        return np.asarray((np.clip(V, low, high) == V).all(axis=1))
    *centre, radius = term.numbers
    return np.asarray(((V - centre) ** 2).sum(axis=1) <= radius * radius)


def target_of(motion: Motion, positions: Floats) -> Floats:
    """Return where vertices (k, 3) go, as `deltamesh.edit` takes it: a shift, or a matrix."""
    import numpy as np

    shift = np.array(motion.shift)
    if motion.axis is None:
        return shift
    axis = np.array(motion.axis) / math.hypot(*motion.axis)
    cross = np.cross(np.eye(3), axis)
    angle = math.radians(motion.degrees)
    turn = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    centre = positions.mean(axis=0) if motion.about is None else np.array(motion.about)
    matrix = np.eye(4)
    matrix[:3, :3] = turn
    matrix[:3, 3] = centre + shift - turn @ centre
    return matrix
