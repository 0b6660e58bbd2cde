"""Joining of the modules and the core into pages that are complete in themselves.

`making.py` calls it. There is no bundler: the modules of `src/web` import and export by
name only, one statement for each module, so that every module becomes a function that returns what
it exports.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

SOURCES = Path(__file__).parent
# The folders whose modules, style and sections make a page; the last one begins.
PAGES = {"page": ("viewer",), "report": ("viewer", "report")}

AsText: TypeAlias = Callable[[bytes], str]
Minified: TypeAlias = Callable[[str], tuple[str, dict[str, str]]]

_IMPORT = re.compile(r'^import \{([^}]*)\} from "(\.[^"]+)";[^\n]*\n', re.MULTILINE)
_REEXPORT = re.compile(r'^export \{([^}]*)\} from "(\.[^"]+)";\n', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?(?:function|class|const) (\w+))", re.MULTILINE)


def joined(entry: Path, minified: Minified) -> str:
    """Return the text of a script whose global `deltamesh` has what a module exports.

    `minified` is that of `minify.py`.
    """
    parts: dict[Path, str] = {}
    _add(entry.resolve(), parts, minified)
    body = "".join(parts.values())
    return f'"use strict";(() => {{\n{body}globalThis.deltamesh={_at(entry, parts)}\n}})();\n'


def _at(module: Path, parts: dict[Path, str]) -> str:
    """Return the variable that has what a module of the parts exports."""
    return f"${list(parts).index(module.resolve())}"


def _add(module: Path, parts: dict[Path, str], minified: Minified) -> None:
    """Add a module to the parts, after those that it imports."""
    if module in parts:
        return
    text = module.read_text(encoding="utf-8")
    for pattern in (_IMPORT, _REEXPORT):
        for _, name in pattern.findall(text):
            _add((module.parent / name).resolve(), parts, minified)
    returned = _EXPORT.findall(text)
    for names, name in _REEXPORT.findall(text):
        source = _at(module.parent / name, parts)
        returned += [f"{one.strip()}:{source}.{one.strip()}" for one in names.split(",")]

    def imported(match: re.Match[str]) -> str:
        source = _at(module.parent / match[2], parts)
        return f"const {{{match[1].replace(' as ', ': ')}}} = {source};\n"

    text = _EXPORT.sub("", _REEXPORT.sub("", _IMPORT.sub(imported, text)))
    text, names = minified(text)
    own = [f"{one}:{names[one]}" if one in names else one for one in returned]
    own_name = f"${len(parts)}"
    parts[module] = f"const {own_name}=(()=>{{{text}return{{{','.join(own)}}}}})();\n"


def packed(data: bytes, as_text: AsText) -> str:
    """Return bytes deflated, as text; how often codes change is what `memory` decides."""
    found = []
    for memory in range(6, 10):
        deflater = zlib.compressobj(9, zlib.DEFLATED, -15, memory)
        found.append(deflater.compress(data) + deflater.flush())
    return as_text(min(found, key=len))


def page(name: str, core: bytes, as_text: AsText, minified: Minified) -> str:
    """Return a page with the core, and places for `{title}`, `{facts}` and `{meshes}`.

    Parameters
    ----------
    name : str
        One of `PAGES`.
    core : bytes
    as_text : callable
        `deltamesh._page.text_of_bytes.as_text`.
    minified : callable
        `minify.minified`.
    """
    folders = [SOURCES / folder for folder in PAGES[name]]
    text = (folders[0] / "page.html").read_text(encoding="utf-8")
    styles = [(folder / "page.css").read_text(encoding="utf-8").strip() for folder in folders]
    further = [folder / "section.html" for folder in folders[1:]]
    known = {
        "style": "\n".join(styles),
        "sections": "".join(one.read_text(encoding="utf-8").strip() for one in further),
        "core": packed(core, as_text),
        "program": packed(joined(folders[-1] / "app.mjs", minified).encode(), as_text),
    }
    for place, value in known.items():
        text = text.replace(f"{{{place}}}", value)
    return text
