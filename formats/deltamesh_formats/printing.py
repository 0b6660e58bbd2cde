"""Text and HTML for people: tables, numbers, and names that are safe to print."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def printable(text: str) -> str:
    """Return a text fit for a line: no control characters, no ends of lines."""
    return text if text.isprintable() else ascii(text)[1:-1]


def shortened(text: str, most: int) -> str:
    """Return a text that is printable, and of at most so many bytes of UTF-8."""
    text = printable(text)
    if len(text.encode(errors="replace")) <= most:
        return text
    return text.encode(errors="replace")[: most - 3].decode(errors="ignore") + "..."


def number(value: float) -> str:
    """Return a measured number with four significant digits."""
    return f"{value:.4g}"


def table(rows: Iterable[Sequence[str]], indent: str = "  ") -> str:
    """Return rows as aligned columns: the first to the left, all others to the right."""
    cells = [list(row) for row in rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return "\n".join((indent + "  ".join(_aligned(row, widths))).rstrip() for row in cells)


def _aligned(row: Sequence[str], widths: Sequence[int]) -> list[str]:
    first = row[0].ljust(widths[0])
    return [first, *(cell.rjust(width) for cell, width in zip(row[1:], widths[1:], strict=True))]


def html_table(rows: Iterable[Sequence[str]], head: Sequence[str] = ()) -> str:
    """Return rows as a table of HTML; every cell is escaped."""
    lines = [_html_row(head, "th")] if head else []
    return "\n".join(["<table>", *lines, *(_html_row(row, "td") for row in rows), "</table>"])


def _html_row(cells: Sequence[str], tag: str) -> str:
    from html import escape  # a large table, which texts do not need

    return f"<tr>{''.join(f'<{tag}>{escape(cell)}</{tag}>' for cell in cells)}</tr>"
