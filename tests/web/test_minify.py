"""Minified modules: shorter, and with the same results."""

from __future__ import annotations

import importlib.util
import re
from types import ModuleType

import children
import pytest
from places import ROOT

WEB = ROOT / "src" / "web"

# What short names could go wrong with; each line is a module that returns something.
MODULES = [
    "const first = [1, 2, 3]; return first.map((value) => value * 2);",
    "const { name, size: width = 4 } = { name: 'n' }; return { name, width };",
    "const label = 'x'; return `a ${label} ${[1].map((label) => `${label}!`)}  b`;",
    "const pattern = /[/\"'`]+/g; const text = '/x\"/'; return text.replace(pattern, '-');",
    'const word = "const word"; return { word, "quoted": word.length, class: word };',
    "class Held { #kept = 3; kept() { return this.#kept; } static made() { return new Held(); } }"
    " return Held.made().kept();",
    "let count = 1; const other = count++ + ++count - -count; return [count, other];",
    "function summed(...values) { return values.reduce((sum, value) => sum + value, 0); }"
    " return summed(1, 2, 3,);",
    "const kind = 2; const table = { kind: 1, other: kind ? kind : 0, [kind]: kind, kept(kind) {"
    " return kind + 1; } }; return [table, table.kept(4)];",
    "const pair = ([left, right], { depth = 1 } = {}) => left + right + depth;"
    " return pair([1, 2]) + pair([1, 2], { depth: 5 });",
    "for (const [key, value] of Object.entries({ a: 1 })) { if (value) return key; } return 0;",
    "const numbers = [4, 5]; const [, second] = numbers; return second / 5 / 1;",
    "try { throw new Error('no'); } catch (error) { return error.message; } finally { void 0; }",
    "const size = 3; const add = async (given) => given + size; return typeof add(size).then;",
]


@pytest.fixture(scope="module")
def minify() -> ModuleType:
    spec = importlib.util.spec_from_file_location("minify", WEB / "minify.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("text", MODULES)
def test_results_stay(minify: ModuleType, node: str, text: str) -> None:
    short, _ = minify.minified(text)
    results = "".join(f"console.log(JSON.stringify((() => {{{one}}})()));" for one in (text, short))
    done = children.run([node, "-e", results], text=True, check=True)
    before, after = done.stdout.splitlines()
    assert before == after
    assert before != "undefined"


def test_names_of_exports_are_told(minify: ModuleType) -> None:
    text, names = minify.minified("const longer = 1;\nfunction another(given) { return given; }\n")
    assert set(names) == {"longer", "another", "given"}
    assert f"const {names['longer']}=1;" in text
    assert re.fullmatch(r"[^ ]* ?[^ ]*function \w+\(\w+\)\{return \w+\}", text)


def test_modules_are_written_so_that_they_can_be_minified() -> None:
    for path in WEB.rglob("*.mjs"):
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"^\s*(?:switch|var)\b|^\s*\w+: (?:for|while)\b", text, re.MULTILINE)
        assert not re.search(r"\bclass \{|;;$", text, re.MULTILINE)
