"""Shorter texts of modules: without space, and with short names for what is local to them.

Modules are written so that this is easy: no empty statements, no `switch`, no labels, no `var`, no
templates in which the indent of a line matters, and no global that is also the name of something
local.
"""

from __future__ import annotations

import itertools
import re
import string
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import NamedTuple

# Strings, comments, words, space, and signs; templates and regular expressions begin with a sign.
_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|//[^\n]*|[\w$]+|\s+|\+\+|--|.', re.DOTALL)
_EXPRESSION = re.compile(r"/(?:[^/\\\[]|\\.|\[(?:[^\]\\]|\\.)*\])+/\w*")
_COMMENT = re.compile(r"^\s*(?://[^\n]*|/\*\*.*?\*/)\n", re.MULTILINE | re.DOTALL)
_INDENT = re.compile(r"\n\s+")
_WORD = re.compile(r"[A-Za-z_$][\w$]*\Z")
# A slash behind one of these begins a regular expression, elsewhere it divides.
_OPENING = frozenset(["return", *"(,=:[!&|?{};"])
# A brace behind one of these begins an object, or a pattern of one; behind others, a block.
_BEFORE_OBJECTS = frozenset(["return", "const", "let", *"(,=:[!&|?."])
_KEYWORDS = frozenset(
    re.findall(
        r"\w+",
        """
    async await break case catch class const continue default delete do else export extends false
    finally for from function get if import in instanceof let new null of return set static super
    this throw true try typeof undefined void while yield
    """,
    )
)


class _Token(NamedTuple):
    """Token of a module; `role` says whether it is a variable, and how it is written.

    "variable" is one by itself, "both" one that is a property by the same name, as in `{ name }`;
    "private" is a member that only its class sees.
    """

    text: str
    role: str = ""


def minified(text: str) -> tuple[str, dict[str, str]]:
    """Return a shorter text of a module, and the names that it has in place of others."""
    tokens = list(_with_roles([one for one in _tokens(_COMMENT.sub("", text)) if _matters(one)]))
    names = _short_names(tokens)
    return _tight(_renamed(one, names) for one in tokens), names


def _matters(token: str) -> bool:
    return not (token.isspace() or token.startswith("//"))


def _tight(tokens: Iterator[str]) -> str:
    """Return tokens as text, with no more space and semicolons than they need."""
    kept: list[str] = []
    for token in tokens:
        last = kept[-1] if kept else ""
        one, other = last[-1:], token[0]
        if (token == "}" and last == ";") or (token in ")]}" and last == ","):
            kept.pop()
        elif (_is_word(one) and _is_word(other)) or (one == other and other in "+-"):
            kept.append(" ")
        kept.append(token)
    return "".join(kept)


def _is_word(letter: str) -> bool:
    return letter.isalnum() or letter in ("_", "$")


def _renamed(token: _Token, names: Mapping[str, str]) -> str:
    text, role = token
    if text[0] == "`":
        return _renamed_template(text, names)
    short = names.get(text, text) if role else text
    return f"{text}:{short}" if role == "both" and short != text else short


def _renamed_template(text: str, names: Mapping[str, str]) -> str:
    """Return a template with other names in its expressions."""
    made, at = [], 0
    for begin, end in _places(text):
        inner = [one for one in _tokens(text[begin:end]) if _matters(one)]
        made += [_INDENT.sub("\n", text[at:begin])]
        made += [_tight(_renamed(one, names) for one in _with_roles(inner))]
        at = end
    return "".join([*made, _INDENT.sub("\n", text[at:])])


def _short_names(tokens: list[_Token]) -> dict[str, str]:
    """Return short names for the variables that a module declares, the most frequent first."""
    counts = Counter(text for text, role in tokens if role)
    for text, _ in tokens:
        if text[0] == "`":
            for begin, end in _places(text):
                counts.update(one for one in _tokens(text[begin:end]) if _WORD.match(one))
    declared = {*_declared(tokens), *(text for text, role in tokens if role == "private")}
    taken = {text for text, _ in tokens} | set(counts)
    letters = (string.ascii_letters, string.ascii_letters)
    possible = ("".join(one) for size in (1, 2) for one in itertools.product(*letters[:size]))
    free = (one for one in possible if one not in taken and one not in _KEYWORDS)
    chosen = [name for name, _ in counts.most_common() if name in declared and len(name) > 2]
    return dict(zip(chosen, free, strict=False))


def _declared(tokens: list[_Token]) -> Iterator[str]:
    """Yield the variables that are declared, or parameters."""
    groups = _groups(tokens)
    for i, (text, _) in enumerate(tokens):
        before = tokens[i - 1].text if i else ""
        if before in ("const", "let", "function", "class") and _WORD.match(text):
            yield text
        following = "".join(one.text for one in tokens[i + 1 : i + 3])
        if _WORD.match(text) and following == "=>":
            yield text
        if text in "([{" and i in groups:
            end = groups[i]
            after = "".join(one.text for one in tokens[end + 1 : end + 3])
            is_list = text == "(" and before not in ("if", "while", "for")
            is_parameters = is_list and (after == "=>" or after[:1] == "{")
            if before in ("const", "let") or is_parameters:
                yield from _of_pattern(tokens[i : end + 1])


def _of_pattern(tokens: list[_Token]) -> Iterator[str]:
    for before, one in itertools.pairwise(tokens):
        if one.role and before.text in ("(", ",", "{", "[", ":", "."):
            yield one.text


def _groups(tokens: list[_Token]) -> dict[int, int]:
    """Return where each bracket is closed."""
    found, opened = {}, []
    for i, (text, _) in enumerate(tokens):
        if text in "([{":
            opened.append(i)
        elif text in ")]}":
            found[opened.pop()] = i
    return found


def _with_roles(tokens: list[str]) -> Iterator[_Token]:
    """Yield tokens with their roles."""
    inside: list[str] = []
    is_class = False
    for i, text in enumerate(tokens):
        before = tokens[i - 1] if i else ""
        after = tokens[i + 1] if i + 1 < len(tokens) else ""
        kind = inside[-1] if inside else ""
        role = ""
        if text == "class" and _WORD.match(after):
            is_class = True
        elif text == "{":
            inside.append(
                "class" if is_class else "object" if before in _BEFORE_OBJECTS else "block"
            )
            is_class = False
        elif text in ("(", "["):
            inside.append(text)
        elif text in (")", "]", "}"):
            inside.pop()
        elif _WORD.match(text) and text not in _KEYWORDS:
            is_first = before in ("{", ",", "async", "get", "set")
            is_property = before == "." and tokens[i - 2] != "."
            is_key = kind == "object" and is_first and after in (":", "(")
            if before == "#":
                role = "private"
            elif not (is_property or is_key or kind == "class"):
                is_both = kind == "object" and is_first and after in (",", "}", "=")
                role = "both" if is_both else "variable"
        yield _Token(text, role)


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
        last = token if _matters(token) else last
        yield token


def _end_of_template(text: str, begin: int) -> int:
    """Return the end of a template."""
    at = begin + 1
    while text[at] != "`":
        if text.startswith("${", at):
            at = _end_of_place(text, at)
        at += 2 if text[at] == "\\" else 1
    return at + 1


def _end_of_place(text: str, begin: int) -> int:
    """Return where the brace is that ends `${` in a template."""
    at, depth = begin + 2, 0
    while text[at] != "}" or depth:
        if text[at] == "`":
            at = _end_of_template(text, at)
            continue
        depth += (text[at] == "{") - (text[at] == "}")
        at += 1
    return at


def _places(template: str) -> Iterator[tuple[int, int]]:
    """Yield where the expressions in a template begin and end."""
    at = 1
    while at < len(template) - 1:
        if template.startswith("${", at):
            end = _end_of_place(template, at)
            yield at + 2, end
            at = end
        at += 2 if template[at] == "\\" else 1
