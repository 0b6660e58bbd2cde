"""Tables of pages, in Markdown: a comment in the page names each that a script may write anew."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

_PLACE = r"^<!-- table: {} -->\n\n((?:\|.*\n)*)"


def lines(rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """Yield the lines of a table as its rows come; the first is the heading."""
    for i, row in enumerate(rows):
        yield f"| {' | '.join(row)} |"
        if i == 0:
            yield "| " + " | ".join(["---"] * len(row)) + " |"


def shown(page: str, name: str) -> str:
    """Return the table of a name that a page shows, as Markdown, "" where it has none yet."""
    (found,) = re.findall(_PLACE.format(name), page, re.MULTILINE)
    return str(found).strip()


def replaced(page: str, name: str, text: str) -> str:
    """Return a page with another table of that name."""
    return re.sub(
        _PLACE.format(name), f"<!-- table: {name} -->\n\n{text}\n", page, flags=re.MULTILINE
    )
