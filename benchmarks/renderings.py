"""The papers' figures from our own code: what quantization does to the look of a surface."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import click
import corpus
import numpy as np
import paper_curves
from equal_sizes import fitting, nearest_bits
from paper_models import is_there
from paper_models import model as paper_model
from paper_pictures import FIGURES
from scenes import Look, Panel, Scale, draw, save

from deltamesh._measures.metrics import diagonal, vertex_errors
from deltamesh._mesh import TriangleMesh
from deltamesh.bench import codec_of
from deltamesh.bench._peers import Coded, draco_file, missing

_EXAMPLES = """\
python benchmarks/renderings.py
python benchmarks/renderings.py --figure equal_bytes --mesh horse --mesh skull --output pictures
python benchmarks/renderings.py --figure sphere"""

FOLDER = Path(__file__).parents[1] / "docs" / "figures"
DRACO_BITS = range(5, 15)
# Those of docs/paper.md.
PAPER = ("paper_curves", *(f"paper_{name}" for name in FIGURES))

# Pixels of two rows of three panels, and of one of four.
_SIZE, _WIDE = (1080, 750), (1480, 480)
# Where the well-known meshes are looked at from: the whole, and a part.
LOOKS: Mapping[str, tuple[Look, Look]] = {
    "bunny": (
        Look((0.1, 0.15, 1), focus=(0.5, 0.4, 0.5), height=0.88),
        Look((-0.3, 0.2, 1), focus=(0.27, 0.66, 0.7), height=0.3),
    ),
    "horse": (
        Look((1, 0, 0.2), up=(0, 0, 1), focus=(0.5, 0.5, 0.4), height=0.88),
        Look((1, 0, 0.2), up=(0, 0, 1), focus=(0.5, 0.75, 0.72), height=0.3),
    ),
    "skull": (
        Look((0.1, 0.15, 1), focus=(0.5, 0.38, 0.5), height=0.92),
        Look((-0.3, 0.2, 1), focus=(0.5, 0.6, 0.7), height=0.3),
    ),
}
# Stages that look different.
STREAM = ("anchors", "deltas", "whole")
_SPHERE = Look((0.7, 0.45, 0.9), focus=(0.5, 0.42, 0.5), height=0.76)


def icosphere(levels: int) -> TriangleMesh:
    """Return a unit sphere of 10 * 4^levels + 2 vertices."""
    from trimesh.creation import icosphere as make

    made = make(subdivisions=levels)
    return TriangleMesh(np.asarray(made.vertices, np.float64), np.asarray(made.faces, np.int64))


def caption(title: str, coded: Coded) -> str:
    """Return what is printed below a decoded mesh: bytes, and how far normals are off."""
    V, W, F = coded.reference.vertices, coded.decoded.vertices, coded.decoded.faces
    bpv, errors = 8 * coded.size / len(V), vertex_errors(V, W, F)
    rms = errors.rms / diagonal(V)
    size = f"{coded.size:,} bytes, {bpv:.2f} bits/vertex"
    return f"{title}\n{size}\nnormals {errors.normal_deviation:.2f}°, rms {rms:.1e}"


def original(mesh: TriangleMesh, look: Look) -> Panel:
    """Return the panel of what went in."""
    return Panel(mesh, mesh, look, f"original\n{len(mesh.vertices):,} vertices\n")


def panel(title: str, coded: Coded, look: Look) -> Panel:
    """Return the panel of what came out."""
    return Panel(coded.decoded, coded.reference, look, caption(title, coded))


def sphere() -> list[list[Panel]]:
    """Return a coarse and a fine sphere: quantized coordinates harm the fine one more."""
    rows = []
    for levels in (4, 6):
        mesh = icosphere(levels)
        titles = {"Cartesian, 8 bits": "cartesian bits=8", "high-pass, 8 bits": "highpass bits=8"}
        coded = {title: codec_of(label).code(mesh) for title, label in titles.items()}
        panels = (panel(title, one, _SPHERE) for title, one in coded.items())
        rows.append([original(mesh, _SPHERE), *panels])
    return rows


def model(mesh: TriangleMesh, look: Look) -> list[list[Panel]]:
    """Return a mesh at few bits high-pass and at many Cartesian, and where the errors are."""
    row = []
    for title, label in (
        ("high-pass, 5 bits", "highpass bits=5"),
        ("Cartesian, 11 bits", "cartesian bits=11"),
    ):
        coded = codec_of(label).code(mesh)
        V, W = coded.reference.vertices, coded.decoded.vertices
        distances = np.linalg.norm(W - V, axis=1) / diagonal(V)
        text = f"distance / diagonal\nmean {distances.mean():.1e}\nmax {distances.max():.1e}"
        row.append(panel(title, coded, look))
        row.append(Panel(coded.decoded, coded.reference, look, text, distances))
    return [row]


def equal_bytes(mesh: TriangleMesh, looks: tuple[Look, Look], bpv: float) -> list[list[Panel]]:
    """Return the original, ours and Draco's in as many bytes; below them a part of each.

    Draco's file is the nearest to `bpv` bits a vertex, ours the largest found that is no larger.
    """
    sizes = {bits: len(draco_file(mesh, bits)) for bits in DRACO_BITS}
    bits = nearest_bits(sizes, bpv * len(mesh.vertices) / 8)
    draco = codec_of(f"draco bits={bits}").code(mesh)

    @cache
    def coded(setting: float) -> Coded:
        return codec_of(f"auto normal_error={setting!r}").code(mesh)

    setting = fitting(lambda one: coded(one).size, draco.size, 2.5)
    whole, part = looks
    row = [
        original(mesh, whole),
        panel(f"deltamesh --normal-error {setting:g}", coded(setting), whole),
        panel(f"Draco, {bits} bits", draco, whole),
    ]
    return [row, [Panel(one.mesh, one.frame, part) for one in row]]


def stream(mesh: TriangleMesh, look: Look) -> list[list[Panel]]:
    """Return the shapes that the beginning of a file makes, stage by stage."""
    from partial import stages_of_mesh

    shown = [stage for stage in stages_of_mesh(mesh) if stage.name in STREAM]
    panels = [original(mesh, look)]
    for stage in shown:
        size = f"{stage.bytes:,} bytes, {100 * stage.share:.0f} %"
        errors = f"normals {stage.normals:.2f}°, rms {stage.rms:.1e}"
        panels.append(Panel(stage.mesh, mesh, look, f"{stage.name}\n{size}\n{errors}"))
    return [[*panels[1:], panels[0]]]


def importance() -> list[list[Panel]]:
    """Return a bunny whose head matters, and a camel's head of which nothing does but the neck."""
    from importance import HEADS, head_of, hole, row_of

    mesh, look, row = corpus.bare("bunny"), LOOKS["bunny"][0], []
    inside = head_of(mesh, HEADS["bunny"])
    for outside in (0.125, 0.0):
        found, made = row_of("bunny", mesh, inside, outside, {})
        decoded = TriangleMesh(made.mesh.vertices, np.asarray(made.mesh.triangulation().faces))
        degrees = f"normals {found.normals[0]:.2f}° inside, {found.normals[1]:.1f}° outside"
        text = f"importance {outside:g} outside the head\n{found.bytes:,} bytes\n{degrees}"
        row.append(Panel(decoded, mesh, look, text))
    camel, side = hole(), Look((1, 0.25, 0.5), height=1.1)
    text = f"{int(camel.none.sum()):,} of {len(camel.none):,} vertices\nwithout bits (dark)\n"
    row.append(Panel(camel.original, camel.original, side, text, np.where(camel.none, 0.0, 1.0)))
    text = f"from connectivity and anchors\n{camel.bytes:,} bytes of {camel.whole:,}\n"
    row.append(Panel(camel.mesh, camel.original, side, text))
    return [row]


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.option(
    "--figure",
    "figures",
    type=click.Choice(["sphere", "model", "equal_bytes", "stream", "importance", *PAPER]),
    multiple=True,
    help="Draw this figure only; may be repeated.",
)
@click.option(
    "--mesh",
    "names",
    type=click.Choice(list(LOOKS)),
    multiple=True,
    default=("bunny",),
    show_default=True,
    help="The mesh of equal_bytes; may be repeated.",
)
@click.option(
    "--bpv", default=5.5, show_default=True, help="Bits per vertex of equal_bytes, about."
)
@click.option(
    "--output",
    type=click.Path(file_okay=False, path_type=Path),
    default=FOLDER,
    show_default="docs/figures",
    help="Folder for the PNGs.",
)
def command(figures: tuple[str, ...], names: tuple[str, ...], bpv: float, output: Path) -> None:
    """Render the figures of the README and docs/paper.md; print their numbers.

    Needs the extra `view`.

    equal_bytes needs the extra `bench`, too. What needs a mesh that is not there is skipped.
    """
    if importlib.util.find_spec("pyvista") is None:
        raise click.ClickException("pyvista is missing: pip install '.[view]'")
    output.mkdir(parents=True, exist_ok=True)
    if not figures or "sphere" in figures:
        _render(output / "sphere.png", sphere(), _SIZE)
    if (not figures or "model" in figures) and _there("model", "bunny"):
        rows = model(corpus.bare("bunny"), LOOKS["bunny"][0])
        _render(output / "model.png", rows, _WIDE, Scale("", 2e-5, 2e-3))
    if (not figures or "stream" in figures) and _there("stream", "bunny"):
        _render(output / "stream.png", stream(corpus.bare("bunny"), LOOKS["bunny"][0]), _WIDE)
    of_importance = not figures or "importance" in figures
    if of_importance and all(_there("importance", name) for name in ("bunny", "camelhead")):
        _render(output / "importance.png", importance(), _WIDE, Scale("", 0.01, 1.0))
    for name in names if not figures or "equal_bytes" in figures else ():
        if not _there("equal_bytes", name):
            continue
        if absent := missing("draco"):
            raise click.ClickException(f"{absent[0]} is missing: pip install '.[bench]'")
        file = "equal_bytes.png" if name == "bunny" else f"equal_bytes_{name}.png"
        rows = equal_bytes(corpus.bare(name), LOOKS[name], bpv)
        _render(output / file, rows, _SIZE)
    if (not figures or "paper_curves" in figures) and _there("paper_curves", paper_curves.BASES):
        paper_curves.draw(output / "paper_curves.png")
        click.echo(f"paper_curves.png, {(output / 'paper_curves.png').stat().st_size:,} bytes")
    for name, figure in FIGURES.items():
        file = f"paper_{name}"
        if (not figures or file in figures) and _there(file, figure.mesh):
            rows = figure.rows(paper_model(figure.mesh))
            _render(output / f"{file}.png", rows, figure.size, figure.scale)


def _there(figure: str, name: str) -> bool:
    """Tell whether a mesh is there, and on standard error where it is not."""
    if is_there(name):
        return True
    click.echo(f"{figure} skipped: no {name} in {corpus.folder()}", err=True)
    return False


def _render(
    path: Path, rows: list[list[Panel]], size: tuple[int, int], scale: Scale | None = None
) -> None:
    """Draw and write a figure, and print its captions."""
    save(draw(rows, size, scale), path)
    click.echo(f"{path.name}, {path.stat().st_size:,} bytes")
    for text in (panel.text for row in rows for panel in row if panel.text):
        click.echo("  " + "; ".join(text.strip().splitlines()))


if __name__ == "__main__":
    command()
