"""Errors of what is important and of the rest: the optional section regs."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from containers import META, written

from deltamesh_formats.container.reader import read_container
from deltamesh_formats.container.regions import Regions, regions_of, write_regions
from deltamesh_formats.container.summary import container_text
from deltamesh_formats.errors import FormatError

REGIONS = Regions(10, 200, 3, 0.5, 1.5, 0.25, 0.75, 1.0, 8.0, 4.0, 2.0)


def test_what_is_written_is_read() -> None:
    container = read_container(written(regs=write_regions(REGIONS)))
    assert regions_of(container) == REGIONS
    assert regions_of(read_container(written())) is None


def test_both_regions_are_described() -> None:
    text = container_text(read_container(written(regs=write_regions(REGIONS))))
    first = (
        "errors are weighted: importance 1 of 10 vertices: RMS 0.0625, max 0.1875, normals 0.25,"
    )
    assert f"  {first} dihedral angles 0.75\n" in text
    rest = "less importance of 203 vertices, 3 of them without bits: RMS 0.125, max 1, normals 4,"
    assert f"  {rest} dihedral angles 2\n" in text
    without = container_text(read_container(written(meta=None, regs=write_regions(REGIONS))))
    assert "weighted" not in without
    flat = container_text(
        read_container(written(meta=replace(META, diagonal=0.0), regs=write_regions(REGIONS)))
    )
    assert "10 vertices: RMS 0, max 0" in flat


@pytest.mark.parametrize(
    ("payload", "message"),
    [
        (b"", "regs: truncated"),
        (write_regions(REGIONS)[:-1], "regs: truncated"),
        (write_regions(REGIONS) + b"x", "regs: 1 bytes follow the last field"),
        (write_regions(replace(REGIONS, rms_full=math.nan)), "regs: rms_full is nan"),
        (write_regions(replace(REGIONS, normal_reduced=-1.0)), "regs: normal_reduced is -1"),
    ],
)
def test_a_damaged_section_is_refused_where_it_is_read(payload: bytes, message: str) -> None:
    container = read_container(written(regs=payload))
    with pytest.raises(FormatError, match=message):
        regions_of(container)
