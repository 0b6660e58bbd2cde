"""Errors, and the positions that they name."""

from __future__ import annotations

import pytest

from deltamesh_formats.errors import FormatError, MeshError, located


def test_offsets_count_from_where_the_bytes_are():
    for inner, outer in ((None, 40), (0, 40), (7, 47)):
        with pytest.raises(FormatError) as caught, located(40, "ATTR: "):
            raise FormatError("empty palette", inner)
        assert (caught.value.reason, caught.value.offset) == ("ATTR: empty palette", outer)
        assert str(caught.value) == f"ATTR: empty palette (at byte {outer})"
    with pytest.raises(FormatError) as caught, located(100), located(20, "a: "), located(3):
        raise FormatError("fault", 1)
    assert (caught.value.reason, caught.value.offset) == ("a: fault", 124)
    with pytest.raises(MeshError, match=r"^no faces$"), located(40):
        raise MeshError("no faces")
