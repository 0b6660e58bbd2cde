"""Errors of generated shapes under every option that sets a rate or a bound.

Shapes of few, large faces are where angles and distances part: a box may keep all of its angles and
lose a quarter of its size. A row an option: the largest errors over all shapes, each as it is and
turned, tiny and far away, and what they are of the bounds that were asked for.
"""

from __future__ import annotations

import ast
import json
import math
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import click
import corpus
import decoded
import pool
import shapes

from deltamesh._measures.metrics import diagonal
from deltamesh_cli.output import table
from deltamesh_formats.errors import DeltameshError, TargetError
from deltamesh_formats.polymesh.mesh import PolyMesh

_EXAMPLES = """\
python benchmarks/bounds.py
python benchmarks/bounds.py --shape box --shape comb --option "auto bits=12" --each"""

QUALITY_NORMAL, QUALITY_RMS = 1.0, 1.5e-3  # of quality 5
# Errors are recorded in binary32, and rounded up.
ROUNDING = 1e-6
# ... and those of a decoder may differ by that, in diagonals or degrees, from the encoder's.
NOTHING = 1e-9
# Options in diagonals of the mesh, and in its unit.
RELATIVE = {"step_rel": "step", "rms_rel": "rms_error", "max_rel": "max_error"}
METHODS = ("refined", "highpass", "cartesian")
OPTIONS = (
    *(f"auto bits={b}" for b in range(4, 13)),
    *(f"auto step_rel={s}" for s in (1e-3, 3e-3, 1e-2)),
    "auto",
    *(f"auto quality={q}" for q in range(1, 10)),
    *(f"auto normal_error={a}" for a in (0.1, 1, 10)),
    *(f"auto dihedral_error={a}" for a in (0.1, 1, 10)),
    *(f"auto rms_rel={d}" for d in (1e-4, 1e-2)),
    *(f"auto rms_error_rel={d}" for d in (1e-4, 1e-2)),
    *(f"auto max_rel={d}" for d in (1e-4, 1e-2)),
    *(f"auto max_error_rel={d}" for d in (1e-4, 1e-2)),
    "auto normal_error=1 max_error_rel=1e-3",
    "auto dihedral_error=1 rms_error_rel=1e-3",
    "auto normal_error=5 dihedral_error=1 rms_rel=1e-3 max_rel=5e-3",
    "auto quality=3 max_error_rel=1e-3",
    "auto quality=7 normal_error=2",
    "auto normal_error=1 only=True",
    "auto max_error_rel=1e-3 only=True",
    *(f"{m} {word}".strip() for m in METHODS for word in ("", "bits=8", "step_rel=1e-3")),
    *(f"{m} {word}" for m in METHODS for word in ("quality=5", "quality=7", "normal_error=1")),
    *(f"{m} max_error_rel=1e-3" for m in METHODS),
)


class Result(NamedTuple):
    """A shape under an option.

    Attributes
    ----------
    option, shape : str
    turned : bool
        Whether it is turned, tiny and far away.
    size : int
    rms, max : float
        Over the diagonal.
    normal, dihedral : float
        In degrees.
    share : float
        The largest error over its bound, of the whole and its parts; 0 without bounds.
    lost, turned_over : int
        Triangles.
    worse : tuple of str
        The errors that are larger than those of method refined at the same rate.
    failure : str
        The message where there is no file; a bound that cannot be met, for one.
    """

    option: str
    shape: str
    turned: bool
    size: int = 0
    rms: float = 0.0
    max: float = 0.0
    normal: float = 0.0
    dihedral: float = 0.0
    share: float = 0.0
    lost: int = 0
    turned_over: int = 0
    worse: tuple[str, ...] = ()
    failure: str = ""

    @property
    def wrong(self) -> bool:
        """Whether a file is not what was asked for."""
        return self.share > 1 + ROUNDING or bool(self.worse)

    @property
    def place(self) -> str:
        """The name of the shape, and how it lies."""
        return f"{self.shape}, turned" if self.turned else self.shape


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.option("--shape", "names", multiple=True, type=click.Choice(list(shapes.SHAPES)))
@click.option("--option", "options", multiple=True, metavar="LABEL", help="May be repeated.")
@click.option("--each", is_flag=True, help="Print a row a shape, too.")
@click.option("--json", "file", type=click.Path(dir_okay=False, path_type=Path), help="Write all.")
@pool.jobs
def command(
    names: tuple[str, ...], options: tuple[str, ...], each: bool, file: Path | None, jobs: int
) -> None:
    """Encode generated shapes under every rate and bound, decode them, and measure.

    Exits with 1 if an error exceeds a bound that was asked for, or if method auto is worse than
    method refined at the same rate.
    """
    start = time.perf_counter()
    tasks = [
        (name, turned, options or OPTIONS)
        for name in names or shapes.SHAPES
        for turned in (False, True)
    ]
    found = [one for results in pool.each(measured, tasks, jobs) for one in results]
    if each:
        click.echo(table(_each(found)))
    click.echo(table(_rows(found, options or OPTIONS)))
    for one in found:
        if one.failure:
            click.echo(f"no file: {one.option}, {one.place}: {one.failure}")
        if one.wrong:
            worse = f", worse than refined in {', '.join(one.worse)}" if one.worse else ""
            click.echo(f"wrong: {one.option}, {one.place}: {one.share:.3f} of the bound{worse}")
    click.echo(f"{time.perf_counter() - start:.0f} s", err=True)
    if file is not None:
        file.write_text(json.dumps([one._asdict() for one in found], indent=1) + "\n")
    if any(one.wrong for one in found):
        raise click.exceptions.Exit(1)


def measured(task: tuple[str, bool, Sequence[str]]) -> list[Result]:
    """Return the results of a shape under each of the options."""
    name, turned, options = task
    mesh = shapes.shape(name, turned)
    return [result(option, name, turned, mesh) for option in options]


def result(option: str, name: str, turned: bool, mesh: PolyMesh) -> Result:
    """Return the result of a mesh under an option."""
    settings = settings_of(option, mesh)
    try:
        one = decoded.found(mesh, **settings)
    except DeltameshError as error:
        kind = "" if isinstance(error, TargetError) else f"{type(error).__name__}: "
        return Result(option, name, turned, failure=f"{kind}{error}")
    return Result(
        option,
        name,
        turned,
        size=one.size,
        **one.whole._asdict(),
        share=share(one, settings, diagonal(mesh.vertices)),
        lost=one.lost,
        turned_over=one.turned,
        worse=worse(one, mesh, settings),
    )


def settings_of(option: str, mesh: PolyMesh) -> dict[str, Any]:
    """Return the keywords of `deltamesh.encode` that an option stands for."""
    method, *words = option.split()
    given: dict[str, Any] = {"method": method}
    for word in words:
        name, _, text = word.partition("=")
        value = ast.literal_eval(text)
        unit = diagonal(mesh.vertices) if name in RELATIVE else 1
        given[RELATIVE.get(name, name)] = value if unit == 1 else unit * value
    return given


def share(one: decoded.Found, given: Mapping[str, Any], unit: float) -> float:
    """Return the largest error over the bound that was asked for.

    As the help of `deltamesh encode` has it: a quality bounds normals and RMS; where a bound of one
    kind is given and none of the other, those of quality 5 hold for the other, unless `only` is.
    RMS and largest distances are those of the whole, angles those of every part too, as is the RMS
    distance of a quality, by the part's own diagonal.
    """
    angles = {e: given[f"{e}_error"] for e in ("normal", "dihedral") if f"{e}_error" in given}
    lengths = {
        e: min(given.get(f"{e}_error", math.inf) / unit, given.get(f"{e}_error_rel", math.inf))
        for e in ("rms", "max")
        if f"{e}_error" in given or f"{e}_error_rel" in given
    }
    quality = given.get("quality")
    bounded = given["method"] == "auto" and not {"bits", "step"} & set(given)
    if not (bounded or angles or lengths or quality):
        return 0.0
    default = None if given.get("only") else 5
    factor = {q: 2 ** ((5 - q) / 2) for q in range(1, 10)}
    of_angles = quality or (None if angles else default)
    of_lengths = quality or (None if lengths else default)
    of_parts = dict(angles)
    if of_angles is not None:
        of_parts["normal"] = min(angles.get("normal", math.inf), QUALITY_NORMAL * factor[of_angles])
    if of_lengths is not None:
        of_parts["rms"] = QUALITY_RMS * factor[of_lengths]
    shares = [getattr(one.whole, e) / bound for e, bound in (of_parts | lengths).items()]
    shares += [getattr(one.largest, e) / bound for e, bound in of_parts.items()]
    return max(shares)


def worse(one: decoded.Found, mesh: PolyMesh, given: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the errors in which method auto is worse than method refined at the same rate."""
    if given["method"] != "auto" or not {"bits", "step"} & set(given):
        return ()
    rival = decoded.found(mesh, **{**given, "method": "refined"})
    # Beside a face without an area, no two computers agree on the dihedral angles.
    unsure = {"dihedral"} if one.lost or rival.lost else set()
    pairs = [(e, one.whole, rival.whole) for e in ("rms", "max", "normal", "dihedral")]
    pairs += [(e, one.largest, rival.largest) for e in ("rms", "normal", "dihedral")]
    found = [
        e
        for e, ours, theirs in pairs
        if e not in unsure and getattr(ours, e) > (1 + ROUNDING) * getattr(theirs, e) + NOTHING
    ]
    return tuple(dict.fromkeys(found))


def _rows(found: Sequence[Result], options: Sequence[str]) -> Iterator[tuple[str, ...]]:
    yield (
        "option",
        "bytes",
        "max",
        "of shape",
        "rms",
        "normal",
        "of shape",
        "dihedral",
        "/ bound",
        "lost",
        "turned",
    )
    for option in options:
        of_option = [one for one in found if one.option == option and not one.failure]
        if not of_option:
            continue
        worst = {
            e: max(of_option, key=lambda one: getattr(one, e))
            for e in ("rms", "max", "normal", "dihedral", "share")
        }
        yield (
            option,
            str(sum(one.size for one in of_option)),
            f"{worst['max'].max:.2e}",
            worst["max"].place,
            f"{worst['rms'].rms:.2e}",
            f"{worst['normal'].normal:.3f}",
            worst["normal"].place,
            f"{worst['dihedral'].dihedral:.3f}",
            f"{worst['share'].share:.3f}" if worst["share"].share else "-",
            str(sum(one.lost for one in of_option)),
            str(sum(one.turned_over for one in of_option)),
        )


def _each(found: Sequence[Result]) -> Iterator[tuple[str, ...]]:
    yield (
        "option",
        "shape",
        "bytes",
        "max",
        "rms",
        "normal",
        "dihedral",
        "/ bound",
        "lost",
        "turned",
    )
    for one in found:
        if not one.failure:
            numbers = (
                f"{one.max:.2e}",
                f"{one.rms:.2e}",
                f"{one.normal:.3f}",
                f"{one.dihedral:.3f}",
            )
            yield (
                one.option,
                one.place,
                str(one.size),
                *numbers,
                f"{one.share:.3f}",
                str(one.lost),
                str(one.turned_over),
            )


if __name__ == "__main__":
    command()
