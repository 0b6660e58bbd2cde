"""Lines that a terminal shows of what a program has written to it."""

from __future__ import annotations

import re

# An escape sequence, or a character.
_TOKEN = re.compile(r"\x1b\[[?0-9;]*[A-Za-z]|.", re.DOTALL)


def shown(written: bytes) -> list[str]:
    """Return the lines of a screen that is never full: cursor movements and erased lines count."""
    lines: list[list[str]] = [[]]
    row = column = 0
    for token in _TOKEN.findall(written.decode()):
        if token == "\r":
            column = 0
        elif token == "\n":
            row, column = row + 1, 0
            lines += [[]] * (row + 1 - len(lines))
        elif token[-1] == "K" and token[0] == "\x1b":
            lines[row] = []
        elif token[-1] == "A" and token[0] == "\x1b":
            row = max(row - int(token[2:-1] or 1), 0)
        elif token[0] != "\x1b":
            line = lines[row] + [" "] * (column - len(lines[row]))
            lines[row] = [*line[:column], token, *line[column + 1 :]]
            column += 1
    return ["".join(line).rstrip() for line in lines]
