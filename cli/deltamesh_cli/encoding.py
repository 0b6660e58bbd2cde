"""Encoding of one file into another, for `encode` and `batch`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from deltamesh._progress import Progress
from deltamesh_cli import files, options
from deltamesh_cli.failures import attempt
from deltamesh_cli.lengths import in_unit_of
from deltamesh_cli.meshes import parse_mesh
from deltamesh_cli.signals import interruptible
from deltamesh_formats.container.texts import texts_of

if TYPE_CHECKING:
    from deltamesh._measures.report import Report
    from deltamesh._pipeline.encoder import Encoded
    from deltamesh._sections.draft import Cost
    from deltamesh_formats.container.container import Container
    from deltamesh_formats.polymesh.mesh import PolyMesh


@dataclass(frozen=True)
class EncodedFile:
    """A file that was encoded.

    Attributes
    ----------
    source_size : int
        Bytes of the input, with the compression around it and the files that are read with it.
    container : Container
        The sections of the output.
    lost : tuple of str
        Descriptions of the content that is not kept.
    report : Report or None
        What became of the shape.
    cost : Cost or None
        The bound that cost the bytes.
    unit : str
        The unit of the lengths among the options, in words; "" if there are none.
    """

    source_size: int
    container: Container
    lost: tuple[str, ...]
    report: Report | None
    cost: Cost | None
    unit: str


def encode_file(
    source: str,
    target: str,
    input_format: str | None,
    progress: Progress,
    parameters: dict[str, Any],
    *,
    force: bool,
) -> EncodedFile:
    """Compress a mesh file into a `.dmesh` file.

    Parameters
    ----------
    source, target : str
        Names of the input and of the output.
    input_format : str or None
        Format of the input; None if its name determines it.
    progress : callable
    parameters : dict
        Keywords of `deltamesh.encode`, None for those that the user did not give; lengths may have
        units of their own.
    force : bool
        Whether an existing output is overwritten.

    Returns
    -------
    EncodedFile

    Raises
    ------
    Failure
        If the input cannot be read or encoded, or the output cannot be written.
    """
    from deltamesh._machine import return_freed_memory

    return_freed_memory()
    raw = files.read_raw(source)
    original = files.unwrapped_input(source, raw)
    mesh = parse_mesh(source, original, input_format, progress)
    size = files.source_size(source, raw, input_format)
    del raw, original  # as large as the mesh
    with attempt(source, "cannot encode"):
        parameters, unit = in_unit_of(mesh, parameters)
        encoded = interruptible(lambda: _encode(mesh, progress, parameters))
    files.write_output(target, encoded.data, force=force)
    lost = texts_of(encoded.container).lost
    draft = encoded.draft
    return EncodedFile(size, encoded.container, lost, draft.report, draft.cost, unit)


def _encode(mesh: PolyMesh, progress: Progress, parameters: dict[str, Any]) -> Encoded:
    from deltamesh._codec.inputs import encode_checked
    from deltamesh._options import Options

    given = options.specified(parameters)
    drop = tuple(given.pop("drop", ()))
    return encode_checked(mesh, Options(**given, drop=drop, source_format=mesh.format), progress)
