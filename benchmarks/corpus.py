"""The meshes that are measured: the repository's own and, where they are, well-known ones.

Those are not ours to give away. They are looked for in the folder that the environment variable
DELTAMESH_MESHES names, else in `../shared/meshes` beside the repository; what is not there is
skipped, and said to be.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from functools import lru_cache
from pathlib import Path
from typing import Any

import click

from deltamesh._compare.welding import welded, without_isolated
from deltamesh._mesh import TriangleMesh, triangulated
from deltamesh_formats.meshfiles.files import read_mesh
from deltamesh_formats.meshfiles.formats import EXTENSIONS
from deltamesh_formats.polymesh.mesh import PolyMesh, from_triangles

GENERATED = "torus"
_GENERATED_PATH = Path(__file__).parent / "meshes" / "torus.ply"

# Scans, organic shapes and CAD, closed and with boundaries, the papers' models among them.
_ORGANIC = {
    "bunny": "unstated/bun_zipper.ply",
    "horse": "unstated/horse.ply",
    "armadillo": "unstated/armadillo.obj",
    "camelhead": "unstated/camelhead.off",
    "skull": "clean/skull.obj",
    "turbineblade": "clean/turbineblade.ply",
    "screwdriver": "unstated/screwdriver.ply",
    "sphere": "unstated/sphere.off",
}
_CAD = {
    "fandisk": "unstated/fandisk.obj",
    "tray": "clean/1002_tray_bottom.STL",
    "mountain": "clean/mountain.obj",
    "plane_holes": "clean/plane_holes.obj",
}
_PLACES = {**_ORGANIC, **_CAD}
GROUPS = {"organic": tuple(_ORGANIC), "CAD": tuple(_CAD)}
NAMES = (GENERATED, *_PLACES)

# Half a million vertices in many components: too slow for the tables, what memory is measured on.
LARGE = "mni152"
_LARGE_PLACE = "unstated/mni152_gm_isosurface.ply"


def folder() -> Path:
    """Return where the well-known meshes are, if anywhere."""
    beside = Path(__file__).parents[2] / "shared" / "meshes"
    return Path(os.environ.get("DELTAMESH_MESHES", beside))


def path(name: str) -> Path:
    """Return where a mesh is, or would be."""
    if name == GENERATED:
        return _GENERATED_PATH
    return folder() / (_LARGE_PLACE if name == LARGE else _PLACES[name])


def present(names: Iterable[str]) -> tuple[str, ...]:
    """Return the meshes that are there, and name the others on standard error.

    Raises
    ------
    click.ClickException
        When there are none.
    """
    wanted = tuple(names)
    found = tuple(name for name in wanted if path(name).is_file())
    missing = [name for name in wanted if name not in found]
    if missing:
        click.echo(f"skipped, not in {folder()}: {', '.join(missing)}", err=True)
    if not found:
        raise click.ClickException("none of these meshes is there; DELTAMESH_MESHES names a folder")
    return found


def files() -> list[Path]:
    """Return the repository's mesh and every mesh file of the folder, in the order of its names."""
    found = (file for file in folder().rglob("*") if file.suffix[1:].lower() in EXTENSIONS)
    return [_GENERATED_PATH, *sorted(found)]


@lru_cache(maxsize=1)
def load(name: str) -> TriangleMesh:
    """Read a mesh; the last one is kept."""
    return read(path(name))


def as_polymesh(mesh: TriangleMesh) -> PolyMesh:
    """Return a mesh for the encoder."""
    return from_triangles(mesh.vertices, mesh.faces)


def bare(name: str) -> TriangleMesh:
    """Read a mesh, each position once and without isolated vertices, which not all codecs keep."""
    return without_isolated(welded(load(name)))


def read(file: Path) -> TriangleMesh:
    """Read a mesh file.

    Raises
    ------
    MeshError
    """
    return triangulated(read_mesh(file))


def selection(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options `--mesh` and `--quick`; `chosen` makes names of them."""
    command = click.option(
        "--quick", is_flag=True, help=f"Measure the repository's own mesh, {GENERATED}, only."
    )(command)
    return click.option(
        "--mesh",
        "names",
        type=click.Choice(NAMES),
        multiple=True,
        metavar="NAME",
        help=f"Measure this mesh only; may be repeated.  [{', '.join(NAMES)}]",
    )(command)


def chosen(names: tuple[str, ...], quick: bool) -> tuple[str, ...]:
    """Return the meshes that `--mesh` and `--quick` ask for and that are there, in our order."""
    if quick and names:
        raise click.UsageError("--quick and --mesh exclude each other.")
    if quick:
        return (GENERATED,)
    return present(name for name in NAMES if not names or name in names)


def epilog(examples: str) -> str:
    """Return what a help page ends with."""
    return "\b\nExamples:\n" + "\n".join(f"  {line}" for line in examples.splitlines())
