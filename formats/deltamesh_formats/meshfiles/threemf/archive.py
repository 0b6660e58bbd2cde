"""Files in the ZIP of a 3MF: their bytes, and the one that has the model."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final
from xml.parsers import expat

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.zip_files import opened, reading

MODEL: Final = "3D/3dmodel.model"
RELATIONS: Final = "_rels/.rels"
MODEL_TYPE: Final = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
# Bytes of XML that are read at most; a ZIP of a few megabytes can ask for that many.
_MOST: Final = 1 << 31

Start = Callable[[str, dict[str, str]], Any]


class Archive:
    """ZIP whose files are found by their names in lower case."""

    def __init__(self, data: bytes) -> None:
        self._zip = opened(data)
        self._names = {one.filename.lower(): one for one in self._zip.infolist()}

    def model(self) -> str:
        """Return the name of the model, which the relations of the package say."""
        found: list[str] = []

        def start(name: str, fields: dict[str, str]) -> None:
            if fields.get("Type") == MODEL_TYPE:
                found.append(fields.get("Target", ""))

        if RELATIONS in self._names:
            self.parse(RELATIONS, start)
        return found[0] if found else MODEL

    def parse(self, path: str, start: Start, end: Callable[[str], Any] | None = None) -> None:
        """Call functions for the elements of an XML file, by names without namespaces.

        Raises
        ------
        MeshError
            For a file that is missing or damaged.
        """
        info = self._names.get(path.lstrip("/").lower())
        if info is None:
            raise MeshError(f"it has no file {path[:80]!r}")
        if info.file_size > _MOST:
            raise MeshError(f"its {path} has {info.file_size} bytes, more than {_MOST}")
        parser = expat.ParserCreate(namespace_separator=" ")
        parser.buffer_text = True
        parser.StartElementHandler = lambda name, fields: start(_local(name), fields)
        if end is not None:
            parser.EndElementHandler = lambda name: end(_local(name))
        parser.StartDoctypeDeclHandler = _refuse_doctype
        try:
            with reading(path), self._zip.open(info) as stream:
                parser.ParseFile(stream)
        except expat.ExpatError as error:
            raise MeshError(f"its {path} is not readable as XML: {error}") from None


def _local(name: str) -> str:
    return name.rpartition(" ")[2]


def _refuse_doctype(*_: object) -> None:
    raise MeshError("its XML has a document type, which 3MF forbids")
