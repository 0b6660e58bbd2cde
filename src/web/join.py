"""Joining of the modules and the core into pages that are complete in themselves.

`making.py` calls it. There is no bundler: the modules of `src/web` import and export by
name only, one statement for each module, so that every module becomes a function that returns what
it exports.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeAlias

SOURCES = Path(__file__).parent
# The folders whose modules, style and sections make a page; the last one begins.
PAGES = {"page": ("viewer",), "report": ("viewer", "report")}

AsText: TypeAlias = Callable[[bytes], str]

_IMPORT = re.compile(r'^import \{([^}]*)\} from "(\.[^"]+)";[^\n]*\n', re.MULTILINE)
_REEXPORT = re.compile(r'^export \{([^}]*)\} from "(\.[^"]+)";\n', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?(?:function|class|const) (\w+))", re.MULTILINE)
_COMMENT = re.compile(r"^\s*(?://[^\n]*|/\*\*.*?\*/)\n", re.MULTILINE | re.DOTALL)
# Strings, comments, words, space, and signs; templates and regular expressions begin with a sign.
_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|//[^\n]*|[\w$]+|\s+|.', re.DOTALL)
_EXPRESSION = re.compile(r"/(?:[^/\\\[]|\\.|\[(?:[^\]\\]|\\.)*\])+/\w*")
_INDENT = re.compile(r"\n\s+")
# A slash behind one of these begins a regular expression, elsewhere it divides.
_OPENING = frozenset(["return", *"(,=:[!&|?{};"])


def joined(entry: Path) -> str:
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
    text = tight(_COMMENT.sub("", text))
    parts[module] = (
        f"{_at(module)} = (() => {{\n{text}\nreturn {{ {', '.join(returned)} }};\n}})();\n"
    )


def tight(text: str) -> str:
    """Return the text of a module without the space and the semicolons that it does not need.

    Modules have no empty statements, and no templates in which the indent of a line matters.
    """
    kept: list[str] = []
    space = ""
    for token in _tokens(text):
        if token.isspace() or token.startswith("//"):
            space = " "
            continue
        last = kept[-1] if kept else ""
        if token[0] == "`":
            token = _INDENT.sub("\n", token)
        if token == "}" and last == ";":
            kept.pop()
        elif space and ((_is_word(last[-1:]) and _is_word(token[0])) or token == last in "+-"):
            kept.append(" ")
        kept.append(token)
        space = ""
    return "".join(kept)


def _is_word(letter: str) -> bool:
    return letter.isalnum() or letter in ("_", "$")


def _tokens(text: str) -> Iterator[str]:
    """Yield the tokens of a module, space and comments among them."""
    at, last = 0, ""
    while at < len(text):
        if text[at] == "`":
            end = _end_of_template(text, at)
        elif text[at] == "/" and last in _OPENING and (found := _EXPRESSION.match(text, at)):
            end = found.end()
        else:
            match = _TOKEN.match(text, at)
            assert match is not None
            end = match.end()
        token, at = text[at:end], end
        last = last if token.isspace() else token
        yield token


def _end_of_template(text: str, begin: int) -> int:
    """Return the end of a template, in which others may be."""
    at, depth = begin + 1, 0
    while text[at] != "`" or depth:
        if text[at] == "`":
            at = _end_of_template(text, at)
            continue
        if text[at] == "\\":
            at += 1
        elif text.startswith("${", at):
            depth += 1
        elif text[at] == "}" and depth:
            depth -= 1
        at += 1
    return at + 1


def packed(data: bytes, as_text: AsText) -> str:
    """Return bytes deflated, as text."""
    deflater = zlib.compressobj(9, zlib.DEFLATED, -15, 9)
    return as_text(deflater.compress(data) + deflater.flush())


def page(name: str, core: bytes, as_text: AsText) -> str:
    """Return a page with the core, and places for `{title}`, `{facts}` and `{meshes}`.

    Parameters
    ----------
    name : str
        One of `PAGES`.
    core : bytes
    as_text : callable
        `deltamesh._page.text_of_bytes.as_text`.
    """
    folders = [SOURCES / folder for folder in PAGES[name]]
    text = (folders[0] / "page.html").read_text(encoding="utf-8")
    styles = [(folder / "page.css").read_text(encoding="utf-8").strip() for folder in folders]
    further = [folder / "section.html" for folder in folders[1:]]
    known = {
        "style": "\n".join(styles),
        "sections": "".join(one.read_text(encoding="utf-8").strip() for one in further),
        "core": packed(core, as_text),
        "program": packed(joined(folders[-1] / "app.mjs").encode(), as_text),
    }
    for place, value in known.items():
        text = text.replace(f"{{{place}}}", value)
    return text
