"""Filling of the page with files, and with what is said of them."""

from __future__ import annotations

import html
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from deltamesh._page.text_of_bytes import as_text
from deltamesh_formats.errors import DeltameshError
from deltamesh_formats.printing import printable

PAGE: Final = Path(__file__).with_name("page.html")
REPORT: Final = PAGE.with_name("report.html")
_PLACE: Final = re.compile(r"\{(title|facts|meshes)\}")


@dataclass(frozen=True)
class PageFile:
    """A file that the page holds.

    Attributes
    ----------
    name : str
        What the page calls it.
    data : bytes
        A `.dmesh` file.
    role : {"", "original"}
        Whether errors are measured against it.
    size : int
        Bytes that the page says it has: those of the file that it stands for.
    """

    name: str
    data: bytes
    role: Literal["", "original"]
    size: int


def page_of(
    files: Sequence[PageFile], title: str, compared: Sequence[Sequence[tuple[str, ...]]] = ()
) -> str:
    """Return the page as HTML.

    Parameters
    ----------
    files : sequence of PageFile
        In the order in which they are seen, from the left.
    title : str
    compared : sequence of sequences of tuples of str
        Tables of differences; each row is a name and its values.

    Raises
    ------
    DeltameshError
        If this installation was made without the page.
    """
    return filled(PAGE, files, title, {"compared": list(compared)})


def filled(page: Path, files: Sequence[PageFile], title: str, facts: Mapping[str, object]) -> str:
    """Return a page with files and facts in it, as HTML.

    Parameters
    ----------
    page : Path
        `PAGE` or `REPORT`.
    files : sequence of PageFile
    title : str
    facts : mapping
        What JSON can express.

    Raises
    ------
    DeltameshError
        If this installation was made without the page.
    """
    values = {
        "title": html.escape(printable(title)),
        # Nothing in it may end the script that it is in.
        "facts": json.dumps(facts, allow_nan=False).replace("<", "\\u003c"),
        "meshes": "\n".join(map(_element, files)),
    }
    # At once: what is put in is not looked at for places.
    return _PLACE.sub(lambda place: values[place[1]], template(page))


def template(page: Path) -> str:
    """Return a page to be filled, `PAGE` or `REPORT`.

    Raises
    ------
    DeltameshError
        If this installation was made without it.
    """
    try:
        return page.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise DeltameshError(
            "this installation was made without the page: install ziglang, then deltamesh from"
            " source again, or run `python src/core/build.py --page` in a checkout"
        ) from None


def _element(file: PageFile) -> str:
    name = html.escape(printable(file.name), quote=True)
    attributes = f'data-name="{name}" data-role="{file.role}" data-size="{file.size}"'
    return f'<script type="text/plain" class="mesh" {attributes}>{as_text(file.data)}</script>'
