"""Sequences of meshes, in numbered files, for `encode --sequence` and `decode --all`."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final

import click

from deltamesh._progress import Progress
from deltamesh_cli import files, options
from deltamesh_cli.decoding import output_name_and_format
from deltamesh_cli.encoding import EncodedFile
from deltamesh_cli.failures import Failure, attempt
from deltamesh_cli.lengths import in_unit_of
from deltamesh_cli.meshes import parse_mesh, write_mesh_file
from deltamesh_cli.output import display_name
from deltamesh_cli.signals import interruptible
from deltamesh_formats.container.texts import texts_of
from deltamesh_formats.wrappers import without_wrapper

if TYPE_CHECKING:
    from deltamesh._pipeline.encoder import Encoded
    from deltamesh_formats.container.container import Container
    from deltamesh_formats.polymesh.mesh import PolyMesh

# The place of the number in a name: %d, or %04d with at least four digits; %% is a sign.
_NUMBER: Final = re.compile(r"(?<!%)((?:%%)*)%(?:0(\d))?d")
_DIGITS: Final = re.compile(r"(\d+)")


def in_order(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return names in the order of the numbers in them, if a shell has sorted them as texts.

    Another order is one that somebody has chosen, and stays.
    """
    return tuple(sorted(names, key=_by_numbers)) if list(names) == sorted(names) else names


def _by_numbers(name: str) -> list[tuple[int, str]]:
    parts = _DIGITS.split(name)
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in parts]


def encode_sequence_file(
    sources: tuple[str, ...],
    target: str,
    input_format: str | None,
    progress: Progress,
    parameters: dict[str, Any],
    *,
    force: bool,
) -> EncodedFile:
    """Compress mesh files of one connectivity, the frames of a sequence, into a `.dmesh` file.

    Parameters, and what is returned, are those of `encoding.encode_file`; one mesh is read at a
    time.

    Raises
    ------
    Failure
        It names the file that cannot be read or encoded, or does not go with the first one; the
        first one where the fault is none of a single frame.
    """
    reading = _Reading(sources, input_format, progress)
    first = reading.mesh(sources[0])
    with attempt(sources[0], "cannot encode"):
        parameters, unit = in_unit_of(first, parameters)
    try:
        encoded = interruptible(lambda: _encode(first, reading, progress, parameters))
    except Failure:
        raise
    except Exception as error:
        frame = getattr(error, "frame", None)
        with attempt(reading.current if frame is None else sources[frame], "cannot encode"):
            raise
    files.write_output(target, encoded.data, force=force)
    lost, draft = texts_of(encoded.container).lost, encoded.draft
    return EncodedFile(reading.size, encoded.container, lost, draft.report, draft.costliest, unit)


class _Reading:
    """Frames that are read one after the other, and the name of the one that is in work."""

    def __init__(
        self, sources: tuple[str, ...], input_format: str | None, progress: Progress
    ) -> None:
        self._sources, self._format, self._progress = sources, input_format, progress
        self.size, self.current = 0, sources[0]

    def mesh(self, name: str) -> PolyMesh:
        raw = files.read_raw(name)
        data = files.unwrapped_input(name, raw)
        self.size += files.source_size(name, raw, self._format)
        return parse_mesh(name, data, self._format, self._progress)

    def others(self) -> Iterator[PolyMesh]:
        """Yield the meshes of all files but the first."""
        for name in self._sources[1:]:
            self.current = name
            yield self.mesh(name)
        self.current = self._sources[0]


def _encode(
    first: PolyMesh, reading: _Reading, progress: Progress, parameters: dict[str, Any]
) -> Encoded:
    from itertools import chain

    from deltamesh._codec.inputs import encode_sequence
    from deltamesh._options import Options

    given = options.specified(parameters)
    drop = tuple(given.pop("drop", ()))
    frames = chain([first], reading.others())
    settings = Options(**given, drop=drop, source_format=first.format)
    return encode_sequence(frames, settings, progress)


class NumberedFiles:
    """Names of the mesh files of all frames.

    Parameters
    ----------
    source : str
        Name of the `.dmesh` file.
    target : str or None
        A name with %d or %04d for the number, a folder, or nothing: names after the source.
    output_format : str or None
    container : Container

    Raises
    ------
    click.UsageError
        If the target has no place for a number, and is no folder.
    """

    def __init__(
        self, source: str, target: str | None, output_format: str | None, container: Container
    ) -> None:
        self.count = container.frame_count
        stored = container.meta.source if container.meta is not None else ""
        pattern = None if target is None or os.path.isdir(target) else target
        if pattern is not None and not _NUMBER.search(os.path.basename(pattern)):
            raise click.UsageError(
                f"{display_name(pattern)} is no folder, and has no %04d for the number of a frame."
            )
        name, self.file_format = output_name_and_format(source, pattern, output_format, stored)
        if pattern is None:
            base, wrapper = without_wrapper(name)
            stem, extension = os.path.splitext(base)
            digits = len(str(self.count - 1))
            name = f"{stem.replace('%', '%%')}_%0{digits}d{extension}{wrapper}"
            if target is not None:
                name = os.path.join(target.replace("%", "%%"), os.path.basename(name))
        self._pattern = name

    def name(self, index: int) -> str:
        """Return the name of the file of a frame."""
        folder, base = os.path.split(self._pattern)
        match = _NUMBER.search(base)
        assert match is not None
        number = str(index).zfill(int(match[2] or 0))
        filled = base[: match.end(1)] + number + base[match.end() :]
        return os.path.join(folder, filled).replace("%%", "%")


def decode_all_to_files(
    names: NumberedFiles,
    source: str,
    container: Container,
    progress: Progress,
    parameters: dict[str, Any],
    *,
    force: bool,
) -> tuple[str, ...]:
    """Decode all frames of a `.dmesh` file, each into a mesh file.

    Returns
    -------
    tuple of str
        Descriptions of the content that the format of the mesh files cannot hold.

    Raises
    ------
    Failure
        If the file cannot be decoded, or a mesh file cannot be written.
    """
    import deltamesh

    keywords = options.specified(
        {name: value for name, value in parameters.items() if name != "digits"}
    )
    frames = deltamesh.frames(container, progress=progress, **keywords)
    lost: dict[str, None] = {}
    for index in range(names.count):
        with attempt(source, "cannot decode"):
            mesh = interruptible(lambda: next(frames))
        written = write_mesh_file(
            names.name(index), mesh, names.file_format, parameters.get("digits"), force=force
        )
        lost |= dict.fromkeys(written)
    return tuple(lost)
