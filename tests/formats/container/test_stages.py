"""Stages of prefixes: by the sections that have come, at every byte of a file."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

import pytest
from containers import CARTESIAN, HIGHPASS, META, written
from forging import section

from deltamesh_formats.container.container import Container, Parameters
from deltamesh_formats.container.layout import DELTAS, ID_SIZE
from deltamesh_formats.container.lines import prefix_text
from deltamesh_formats.container.reader import progress_of, read_container, read_prefix
from deltamesh_formats.container.stages import awaited, stage_of, stages_of
from deltamesh_formats.container.summary import container_text
from deltamesh_formats.errors import FormatError

MORE = {"CELL": b"c", "FIXS": b"f", "ATTR": b"a", "ORDR": b"o"}


def file(**more: bytes) -> bytes:
    return written(replace(HIGHPASS, interpolated=True), **more)


def at(data: bytes, name: str) -> int:
    """Where a section ends."""
    return read_container(data).sections[name].end


def stage(data: bytes) -> str:
    return stage_of(read_prefix(data))


@pytest.mark.parametrize("parameters", [HIGHPASS, CARTESIAN], ids=lambda p: p.method)
def test_every_prefix_is_read_or_truncated(parameters: Parameters) -> None:
    data = written(parameters, abcd=b"unknown")
    whole, ends = read_container(data), stages_of(read_container(data))
    first = whole.sections["PARM"].end
    for size in range(1, first):
        with pytest.raises(FormatError, match="truncated"):
            read_prefix(data[:size])
    for size in range(first, len(data) + 1):
        found = read_prefix(data[:size])
        kept = {name: one for name, one in whole.sections.items() if one.end <= size}
        assert found.sections == kept
        assert list(found.sections) == list(kept)
        assert found.is_whole == (size == len(data)) == bool(found.digest)
        reached = [name for name, end in ends.items() if end <= size]
        assert stage_of(found) == (reached[-1] if reached else "")
        assert list(stages_of(found)) == reached
        assert found.size <= size
        container_text(found)
    assert read_prefix(data) == whole


def test_the_stages_of_each_method() -> None:
    data = file(**MORE)
    assert stages_of(read_container(data)) == {
        "anchors": at(data, "ANCH"),
        "deltas": at(data, "DELT"),
        "positions": at(data, "FIXS"),
        "whole": len(data),
    }
    assert list(stages_of(read_container(written(CARTESIAN)))) == ["positions", "whole"]


def test_positions_are_known_by_what_follows() -> None:
    for name, followed in (("DELT", "CELL"), ("CELL", "FIXS"), ("CELL", "ATTR"), ("DELT", "meta")):
        data = file(**{n: MORE[n] for n in (name, followed) if n in MORE})
        end = at(data, name)
        assert stage(data[: end + ID_SIZE - 1]) == "deltas"
        is_known = followed in ("ATTR", "meta")
        assert stage(data[: end + ID_SIZE]) == ("positions" if is_known else "deltas")
    data = file(FIXS=b"f")
    assert stage(data[: at(data, "FIXS") - 1]) == "deltas"
    assert stage(data[: at(data, "FIXS")]) == "positions"


def test_what_has_not_come_is_named() -> None:
    data = file(**MORE)

    def absent(name: str, more: int = 0) -> tuple[str, ...]:
        return awaited(read_prefix(data[: at(data, name) + more]))

    last: tuple[str, ...] = "attributes", "names, parts and metadata", "order of the source"
    last += ("poses", "frames beyond the first")
    assert absent("PARM") == ("deltas", "vectors of cells", "corrections", *last)
    assert absent("ANCH", 9) == absent("PARM")
    assert absent("DELT") == ("vectors of cells", "corrections", *last)
    assert absent("CELL") == ("corrections", *last)
    assert absent("FIXS", ID_SIZE) == last
    assert absent("ATTR") == last[1:]
    assert absent("ATTR", ID_SIZE) == last[2:]
    assert absent("ORDR") == last[3:]
    assert absent("meta") == absent("CHEK") == ()
    assert prefix_text(read_prefix(data[: at(data, "ATTR") + 7])) == (
        f"stage positions, {at(data, 'ATTR')} bytes, then ORDR is cut;"
        " not there yet, if the file has them: order of the source, poses,"
        " frames beyond the first"
    )
    text = container_text(read_prefix(data[: at(data, "CONN")]))
    assert f"no positions yet, {at(data, 'CONN')} bytes; not there yet" in text


def test_damage_in_a_whole_section_is_refused() -> None:
    data = written(abcd=b"unknown")
    end = at(data, "DELT")
    cut = data[: end + 6]
    for i in range(8 * end):
        flipped = bytearray(cut)
        flipped[i // 8] ^= 1 << i % 8
        with suppress(FormatError):
            found = read_prefix(flipped)  # of a length that is longer now
            lengths = [one.offset + ID_SIZE for one in read_container(data).sections.values()]
            assert any(0 <= i // 8 - at < 2 for at in lengths)
            assert len(found.sections) < len(read_prefix(cut).sections)


@pytest.mark.parametrize(
    ("added", "message"),
    [
        (b"!", "cannot be called"),
        (b"ANCH" + bytes(8), "damaged"),
        (b"AN\x80H", "cannot be called"),
        (b"DELT\x80\x00" + bytes(9), "longer than it needs to be"),
        (b"DELT" + b"\xff" * 9, "more than 9 bytes"),
        (section("NORM", b""), "section DELT is missing, NORM is in its place"),
        (section("CHEK", b"01234567"), "section DELT is missing, CHEK is in its place"),
        (section("XYZW", b""), "unknown"),
    ],
)
def test_what_cannot_begin_a_section_is_refused(added: bytes, message: str) -> None:
    data = written()
    with pytest.raises(FormatError, match=message):
        read_prefix(data[: at(data, "ANCH")] + added)


def test_bytes_after_a_whole_file_are_refused() -> None:
    with pytest.raises(FormatError, match="1 bytes follow the last section"):
        read_prefix(written() + b"\0")


def test_progress_is_counted_once() -> None:
    data = written(meta=META, abcd=b"unknown")
    whole = read_container(data)
    position = 0
    for size in range(len(data) + 1):
        before = position
        position, has_id = progress_of(data[:size], position)
        ends = [one.end for one in whole.sections.values() if one.end <= size]
        assert position == max([0, *ends])
        assert has_id == (position > 0 and size >= position + ID_SIZE)
        assert position >= before
    assert position == len(data)
    with pytest.raises(FormatError):
        progress_of(b"!" * 64, 0)


def test_a_prefix_is_copied_like_a_file() -> None:
    found: Container = read_prefix(written()[:-3])
    assert replace(found).sections[DELTAS].payload == found.sections[DELTAS].payload
