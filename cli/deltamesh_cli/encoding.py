"""Encoding of one file into another, for `encode` and `batch`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from deltamesh._progress import Progress
from deltamesh_cli import files, options
from deltamesh_cli.failures import attempt
from deltamesh_cli.meshes import parse_container, parse_mesh
from deltamesh_cli.signals import interruptible
from deltamesh_formats.container.texts import texts_of

if TYPE_CHECKING:
    from deltamesh_formats.container.container import Container
    from deltamesh_formats.polymesh.mesh import PolyMesh


def encode_file(
    source: str,
    target: str,
    input_format: str | None,
    progress: Progress,
    parameters: dict[str, Any],
    *,
    force: bool,
) -> tuple[int, Container, tuple[str, ...]]:
    """Compress a mesh file into a `.dmesh` file.

    Parameters
    ----------
    source, target : str
        Names of the input and of the output.
    input_format : str or None
        Format of the input; None if its name determines it.
    progress : callable
    parameters : dict
        Keywords of `deltamesh.encode`, None for those that the user did not give.
    force : bool
        Whether an existing output is overwritten.

    Returns
    -------
    size : int
        Bytes of the input.
    container : Container
        The sections of the output.
    lost : tuple of str
        Descriptions of the content that is not kept.

    Raises
    ------
    Failure
        If the input cannot be read or encoded, or the output cannot be written.
    """
    original = files.read_input(source)
    mesh = parse_mesh(source, original, input_format, progress)
    with attempt(source, "cannot encode"):
        data = interruptible(lambda: _encode(mesh, progress, parameters))
    files.write_output(target, data, force=force)
    container = parse_container(target, data, "cannot encode")
    return len(original), container, texts_of(container).lost


def _encode(mesh: PolyMesh, progress: Progress, parameters: dict[str, Any]) -> bytes:
    import deltamesh

    return deltamesh.encode(
        mesh,
        source_format=mesh.format,
        progress=progress,
        **options.specified(parameters),
    )
