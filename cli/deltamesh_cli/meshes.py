"""Meshes in and out of files for the commands, with failures that name the file."""

from __future__ import annotations

import io
from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from deltamesh_cli import files, options
from deltamesh_cli.failures import attempt
from deltamesh_cli.output import shown
from deltamesh_cli.progress import Stage
from deltamesh_cli.signals import interruptible
from deltamesh_formats.container.layout import MAGIC
from deltamesh_formats.meshfiles.formats import format_of_beginning, format_of_extension

if TYPE_CHECKING:
    from deltamesh_formats.container.container import Container
    from deltamesh_formats.polymesh.mesh import PolyMesh


@dataclass(frozen=True)
class Loaded:
    """A mesh, the size of its file in bytes and, of a `.dmesh`, what the file says about itself."""

    mesh: PolyMesh
    size: int
    container: Container | None


def parsed(name: str, data: bytes, file_format: str | None, stage: Stage) -> PolyMesh:
    """Return the mesh that the bytes of a file hold; the name tells the format if nothing else.

    Raises
    ------
    Failure
        They are not a mesh.
    """
    stage("reading")
    named = file_format or files.extension(name)
    with attempt(name, "cannot read", _format_hint(named, data)):
        from deltamesh_formats.meshfiles.files import read_mesh

        return read_mesh(io.BytesIO(data), named)


def _format_hint(named: str, data: bytes) -> str:
    """Return what to try when a file cannot be read as the format `named`."""
    if data.startswith(MAGIC):
        return "deltamesh decode turns it into a mesh file"
    known, found = format_of_extension(named), format_of_beginning(data)
    if found not in (None, known):
        return f"it begins like {found.title}: --input-format {found.name}"
    return "" if known is not None else "--input-format names the format"


def write_mesh_file(name: str, mesh: PolyMesh, file_format: str, *, force: bool) -> tuple[str, ...]:
    """Write a mesh file, or a mesh to standard output; return what the format has no place for.

    With `force` a file that exists is replaced.

    Raises
    ------
    Failure
        It cannot be written.
    """
    from deltamesh_formats.meshfiles.files import written

    with attempt(name, "cannot write"):
        made = written(mesh, file_format)
    files.write_output(name, made.data, force=force)
    return made.lost


def note_not_kept(name: str, words: Collection[str], *, quiet: bool) -> None:
    """Say on standard error, in one line, what of a mesh is left out."""
    if words and not quiet:
        listed = ", ".join(map(shown, words))
        click.echo(f"note: {shown(name)}: {listed} are not kept", err=True)


def note_memory(name: str, container: Container, *, quiet: bool) -> None:
    """Say on standard error, in one line, that decoding takes more than the default limit."""
    from deltamesh._limits import DEFAULT_MEMORY, memory_needed

    needed = memory_needed(container)
    if needed > DEFAULT_MEMORY and not quiet:
        least = f"{-(-needed >> 30)}G"
        text = "decoding takes more memory than its default limit"
        click.echo(f"note: {shown(name)}: {text}: give deltamesh decode --memory {least}", err=True)


def container_of(name: str, data: bytes, what: str) -> Container:
    """Return the sections of a `.dmesh` file, checked but not decoded.

    Raises
    ------
    Failure
        The bytes are not a valid file; `what` says what could not be done therefore.
    """
    from deltamesh_formats.container.reader import read_container

    with attempt(name, what):
        return read_container(data)


def decoded(name: str, container: Container, stage: Stage, **parameters: Any) -> PolyMesh:
    """Return the mesh of a `.dmesh` file; `parameters` are the keywords of `deltamesh.decode`.

    Raises
    ------
    Failure
        It cannot be decoded, or needs more than the limits.
    """
    with attempt(name, "cannot decode"):
        import deltamesh

        given = options.given(parameters)
        return interruptible(lambda: deltamesh.decode(container, progress=stage, **given))


def load_any(name: str, file_format: str | None, stage: Stage, **parameters: Any) -> Loaded:
    """Read a mesh file or decode a `.dmesh`; the first bytes tell which it is, not the name.

    Raises
    ------
    Failure
        It is neither, or needs more than the limits.
    """
    from deltamesh._mesh import LARGEST
    from deltamesh_formats.polymesh.validation import checked

    data = files.read_input(name)
    if data[: len(MAGIC)] == MAGIC:
        container = container_of(name, data, "cannot decode")
        return Loaded(decoded(name, container, stage, **parameters), len(data), container)
    found = parsed(name, data, file_format, stage)
    with attempt(name, "cannot read"):
        return Loaded(checked(found, LARGEST), len(data), None)
