"""Joining of the modules and the core into one page that is complete in itself.

`src/core/build.py` calls it. There is no bundler: the modules of `src/web` import and export by
name only, one statement for each module, so that every module becomes a function that returns what
it exports.
"""

from __future__ import annotations

import importlib.util
import re
import zlib
from pathlib import Path
from types import ModuleType

SOURCES = Path(__file__).parent
ENTRY = SOURCES / "viewer" / "app.mjs"

_IMPORT = re.compile(r'^import \{([^}]*)\} from "(\.[^"]+)";[^\n]*\n', re.MULTILINE)
_REEXPORT = re.compile(r'^export \{([^}]*)\} from "(\.[^"]+)";\n', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?(?:function|class|const) (\w+))", re.MULTILINE)
# Templates, regular expressions, other strings, and signs that would become one with another.
_UNCERTAIN = re.compile(r"['`/]|[+-] [+-]")
_STRING = re.compile(r'("(?:[^"\\]|\\.)*")')
_SPACED = re.compile(r" ?([=+\-*%<>(){}\[\],;:?&|!^]) ?")
_COMMENT = re.compile(r"^\s*(?://[^\n]*|/\*\*.*?\*/)\n", re.MULTILINE | re.DOTALL)


def joined(entry: Path = ENTRY) -> str:
    """Return the text of a script whose global `deltamesh` has what a module exports."""
    parts: dict[Path, str] = {}
    _add(entry.resolve(), parts)
    body = "".join(parts.values())
    end = f"globalThis.deltamesh = {_at(entry)};"
    return f'"use strict";(() => {{\nconst $ = {{}};\n{body}{end}\n}})();\n'


def _at(module: Path) -> str:
    return f'$["{module.resolve().relative_to(SOURCES.resolve()).as_posix()}"]'


def _add(module: Path, parts: dict[Path, str]) -> None:
    """Add a module to the parts, after those that it imports."""
    if module in parts:
        return
    text = module.read_text(encoding="utf-8")
    for pattern in (_IMPORT, _REEXPORT):
        for _, name in pattern.findall(text):
            _add((module.parent / name).resolve(), parts)
    returned = _EXPORT.findall(text)
    for names, name in _REEXPORT.findall(text):
        source = _at(module.parent / name)
        returned += [f"{one.strip()}: {source}.{one.strip()}" for one in names.split(",")]

    def imported(match: re.Match[str]) -> str:
        source = _at(module.parent / match[2])
        return f"const {{{match[1].replace(' as ', ': ')}}} = {source};\n"

    text = _EXPORT.sub("", _REEXPORT.sub("", _IMPORT.sub(imported, text)))
    text = "\n".join(filter(None, map(_tight, _COMMENT.sub("", text).splitlines())))
    parts[module] = (
        f"{_at(module)} = (() => {{\n{text}\nreturn {{ {', '.join(returned)} }};\n}})();\n"
    )


def _tight(line: str) -> str:
    """Return a line without the spaces that it does not need, outside of its strings."""
    line = line.strip().removesuffix("// prettier-ignore").rstrip()
    if _UNCERTAIN.search(line):
        return line
    return "".join(
        part if part.startswith('"') else _SPACED.sub(r"\1", part) for part in _STRING.split(line)
    )


def packed(data: bytes) -> str:
    """Return bytes deflated, as text."""
    deflater = zlib.compressobj(9, zlib.DEFLATED, -15, 9)
    text: str = _module("text_of_bytes").as_text(deflater.compress(data) + deflater.flush())
    return text


def _module(name: str) -> ModuleType:
    """Return a module of `deltamesh._page` that needs nothing installed."""
    path = SOURCES.parent / "deltamesh" / "_page" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def page(core: bytes) -> str:
    """Return the page with the core, and places for `{title}`, `{facts}` and `{meshes}`."""
    viewer = SOURCES / "viewer"
    text = (viewer / "page.html").read_text(encoding="utf-8")
    known = {
        "style": (viewer / "page.css").read_text(encoding="utf-8").strip(),
        "core": packed(core),
        "program": packed(joined().encode()),
    }
    for name, value in known.items():
        text = text.replace(f"{{{name}}}", value)
    return text
