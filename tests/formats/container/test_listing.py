"""Text of a file as lines for people and as JSON."""

from __future__ import annotations

import json

from deltamesh_formats.container.listing import text_lines, texts_object
from deltamesh_formats.container.texts import Division, Texts


def test_lists_are_cut_and_control_characters_escaped() -> None:
    names = ("\x1b[2J", "a\nb", "", "\udcff", "é", "x" * 100, "last")
    told = Texts(
        (Division("material", names, False, True),), {"com\rments": ("one",)}, ("a\ttexture",)
    )
    first, second, third = text_lines(told)
    assert first == (
        r'materials (7, with transforms): "\x1b[2J", "a\nb", "", "\udcff", "é",'
        f' "{"x" * 37}...", and 1 more'
    )
    assert second == r'com\rments (1): "one"'
    assert third == r"not kept of the source: a\ttexture"
    assert list(text_lines(Texts((Division("mesh", (), True, False),), {}, ()))) == [
        "names of meshes (0): none"
    ]


def test_everything_is_in_the_json() -> None:
    told = Texts(
        (Division("object", ("a", "\udcff"), True, True),), {"header": ("x", "y")}, ("lines",)
    )
    assert json.loads(json.dumps(texts_object(told))) == {
        "parts": [{"kind": "object", "names": ["a", "\udcff"], "transforms": True}],
        "metadata": {"header": ["x", "y"]},
        "not_kept": ["lines"],
    }
