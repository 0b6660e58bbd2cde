"""Names, metadata and losses of a `.dmesh` file, for `deltamesh info`.

They come from users' files: control characters, which could steer a terminal, are escaped.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from deltamesh_formats.container.pose_table import PoseEntry
from deltamesh_formats.container.texts import Texts
from deltamesh_formats.polymesh.kinds import KIND_WORDS
from deltamesh_formats.printing import printable

# Of a list, and of one text in it.
_MOST_SHOWN: Final = 6
_LONGEST_SHOWN: Final = 40


def text_lines(texts: Texts) -> Iterator[str]:
    """Yield lines for people; of long lists, the beginning and how many more there are."""
    for one in texts.divisions:
        placed = ", with transforms" if one.moved else ""
        yield f"{KIND_WORDS[one.kind]} ({len(one.names)}{placed}): {_listed(one.names)}"
    for key, lines in texts.metadata.items():
        yield f"{printable(key)} ({len(lines)}): {_listed(lines)}"
    if texts.lost:
        yield f"not kept of the source: {', '.join(map(printable, texts.lost))}"


def pose_lines(poses: Sequence[PoseEntry]) -> Iterator[str]:
    """Yield a line with the names of poses and their bytes, if there are any."""
    if poses:
        shown = [f'"{_cut(one.name)}" {one.size} bytes' for one in poses[:_MOST_SHOWN]]
        if len(poses) > _MOST_SHOWN:
            shown.append(f"and {len(poses) - _MOST_SHOWN} more")
        yield f"poses ({len(poses)}): {', '.join(shown)}"


def poses_object(poses: Sequence[PoseEntry]) -> list[dict[str, object]]:
    """Return all poses, for `--json`."""
    return [{"name": one.name, "step": one.step, "bytes": one.size} for one in poses]


def texts_object(texts: Texts) -> dict[str, object]:
    """Return all of it, for `--json`."""
    return {
        "parts": [
            {"kind": one.kind, "names": list(one.names), "transforms": one.moved}
            for one in texts.divisions
        ],
        "metadata": {key: list(lines) for key, lines in texts.metadata.items()},
        "not_kept": list(texts.lost),
    }


def _listed(names: Sequence[str]) -> str:
    shown = [f'"{_cut(name)}"' for name in names[:_MOST_SHOWN]]
    if len(names) > _MOST_SHOWN:
        shown.append(f"and {len(names) - _MOST_SHOWN} more")
    return ", ".join(shown) or "none"


def _cut(name: str) -> str:
    text = printable(name[: _LONGEST_SHOWN + 1])
    return text if len(text) <= _LONGEST_SHOWN else f"{text[: _LONGEST_SHOWN - 3]}..."
