"""Writer of containers: its bytes, and what it refuses as the reader would."""

from __future__ import annotations

from dataclasses import replace

import pytest
from containers import CARTESIAN, HIGHPASS, META, PINNED, with_parameters, written

from deltamesh_formats.container.reader import read_container
from deltamesh_formats.container.writer import write_container
from deltamesh_formats.errors import MeshError


def test_bytes_are_pinned():
    """A change of these bytes is a change of the format."""
    assert written(CARTESIAN) == PINNED
    assert read_container(PINNED).parameters == CARTESIAN


def test_a_file_that_is_read_is_written_as_it_was():
    """Unused bits, too, which no field of a container has."""
    for data in (with_parameters(flags=0xFB), written(abcd=b"x"), PINNED):
        assert write_container(read_container(data)) == data


@pytest.mark.parametrize(
    "arguments",
    [
        {"parameters": replace(HIGHPASS, step=float("inf"))},
        {"parameters": replace(HIGHPASS, bits=0)},
        {"parameters": replace(HIGHPASS, seed=2**64)},
        {"parameters": replace(HIGHPASS, anchor_count=1001)},
        {"parameters": replace(CARTESIAN, anchor_method="random")},
        {"parameters": replace(CARTESIAN, anchor_count=1)},
        {"meta": replace(META, dihedral=1e39)},
        {"meta": replace(META, normal=float("nan"))},
        {"meta": replace(META, encoder="x" * 256)},
        {"meta": replace(META, source="a\nb")},
        {"meta": replace(META, lost=-1)},
        {"meta": replace(META, turned=2**63)},
        {"meta": replace(META, parts=0)},
        {"meta": replace(META, part="body")},
        {"meta": replace(META, turned=1, part_rms=0.5)},
        {"meta": replace(META, parts=2, part_normal=1e39)},
        {"meta": replace(META, parts=2, part_rms=float("inf"))},
        {"meta": replace(META, parts=2, part="a\nb")},
        {"vertices": 2**40 + 1},
        {"triangles": -1},
    ],
    ids=str,
)
def test_the_writer_refuses_what_the_reader_would(arguments):
    with pytest.raises(MeshError):
        written(**arguments)
