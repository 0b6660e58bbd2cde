"""The record of a run on disk."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from deltamesh.batch import _manifest as manifest
from deltamesh.batch._manifest import (
    ManifestError,
    begun_record,
    file_state,
    line,
    open_manifest,
    read_records,
    still_done,
    wrote_target,
)

# Names of files may be any bytes, which Python writes as lone surrogates; and they may hold lines.
names = st.text(min_size=1)
records = st.builds(
    lambda status, source, target, seconds: {
        "status": status, "source": source, "target": target, "seconds": seconds
    },
    st.sampled_from(["begun", "done", "failed", "skipped"]),
    names,
    names,
    st.floats(allow_nan=False, allow_infinity=False),
)  # fmt: skip


@given(st.lists(records))
def test_what_is_written_is_read(made: list[dict[str, Any]]) -> None:
    data = b"".join(map(line, made))
    assert data.count(b"\n") == len(made)
    assert read_records(data) == made


@given(st.lists(records, min_size=1), st.data())
def test_a_torn_last_line_is_left_out(made: list[dict[str, Any]], data: st.DataObject) -> None:
    lines = [line(record) for record in made]
    cut = data.draw(st.integers(0, len(lines[-1]) - 1))
    assert read_records(b"".join(lines[:-1]) + lines[-1][:cut]) == made[:-1]


def test_names_that_are_not_text_survive() -> None:
    name = os.fsdecode(b"\xff\n\xfe.ply")
    assert read_records(line(begun_record(name, name)))[0]["source"] == name


@pytest.mark.parametrize("text", [b"{", b"[]", b"{}", b"nonsense", b'{"status": 1}', b"\xff"])
def test_a_line_that_is_no_record_is_named(text: bytes) -> None:
    with pytest.raises(ManifestError, match="line 2 is not a record"):
        read_records(line(begun_record("a", "b")) + text + b"\n")


def test_records_are_appended_and_the_last_counts(tmp_path: Path) -> None:
    path = str(tmp_path / "run.jsonl")
    with open_manifest(path, resume=False) as (known, append):
        assert known == {}
        append([begun_record("a", "b"), begun_record("c", "d")])
        append([{"source": "a", "target": "b", "status": "done"}])
    with open_manifest(path, resume=True) as (known, append):
        assert known["a", "b"]["status"] == "done"
        assert known["c", "d"] == begun_record("c", "d")
        append([])
    assert len(read_records(Path(path).read_bytes())) == 3


@pytest.mark.parametrize("cut", [1, 5, 12, 30])
def test_resuming_cuts_off_a_torn_line(tmp_path: Path, cut: int) -> None:
    path = tmp_path / "run.jsonl"
    path.write_bytes(line(begun_record("a", "b")) + line(begun_record("c", "d"))[:cut])
    with open_manifest(str(path), resume=True) as (known, append):
        assert list(known) == [("a", "b")]
        append([begun_record("e", "f")])
    assert read_records(path.read_bytes()) == [begun_record("a", "b"), begun_record("e", "f")]


@pytest.mark.parametrize(
    "data", [b"ply", b"ply\nformat ascii", line(begun_record("a", "b")) + b"x"]
)
def test_another_file_stays_as_it_is(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "mesh.ply"
    path.write_bytes(data)
    with (
        pytest.raises(ManifestError, match=r"is not a record|does not end"),
        open_manifest(str(path), resume=True),
    ):
        pass
    assert path.read_bytes() == data


def test_a_manifest_is_not_overwritten_by_mistake(tmp_path: Path) -> None:
    path = tmp_path / "run.jsonl"
    path.write_bytes(line(begun_record("a", "b")))
    with pytest.raises(FileExistsError), open_manifest(str(path), resume=False):
        pass
    assert path.read_bytes()
    with open_manifest(str(path), resume=False, force=True) as (known, _):
        assert known == {}
    assert path.read_bytes() == b""


@pytest.mark.skipif(os.name != "posix", reason="locks of POSIX")
def test_two_runs_cannot_write_one_manifest(tmp_path: Path) -> None:
    path = tmp_path / "run.jsonl"
    with open_manifest(str(path), resume=True) as (_, append):
        append([begun_record("a", "b")])
        for options in ({"resume": True}, {"resume": False, "force": True}):
            with (
                pytest.raises(ManifestError, match="another run"),
                open_manifest(str(path), **options),
            ):
                pass
    with open_manifest(str(path), resume=True) as (known, _):
        assert known


@pytest.fixture
def done(tmp_path: Path) -> dict[str, Any]:
    source, target = tmp_path / "in", tmp_path / "out"
    source.write_bytes(b"input")
    target.write_bytes(b"output")
    return {
        "status": "done",
        "source": str(source),
        "target": str(target),
        **file_state(str(source), "source"),
        **file_state(str(target), "target"),
        "options": {"bits": 8},
        "version": "1",
    }


def test_done_is_done(done: dict[str, Any]) -> None:
    assert still_done(done, {"bits": 8}, "1")
    assert wrote_target(done)


def test_other_options_or_another_version_undo_it(done: dict[str, Any]) -> None:
    assert not still_done(done, {"bits": 9}, "1")
    assert not still_done(done, {"bits": 8}, "2")
    for status in ("begun", "failed", "skipped"):
        assert not still_done({**done, "status": status}, {"bits": 8}, "1")


@pytest.mark.parametrize("prefix", ["source", "target"])
def test_a_change_undoes_it_and_a_touch_does_not(done: dict[str, Any], prefix: str) -> None:
    path = Path(done[prefix])
    data = path.read_bytes()
    os.utime(path, ns=(1, 1))
    assert still_done(done, {"bits": 8}, "1"), "the content decides"
    path.write_bytes(data.upper())
    assert not still_done(done, {"bits": 8}, "1")
    path.write_bytes(data + b"!")
    os.utime(path, ns=(0, done[f"{prefix}_mtime_ns"]))
    assert not still_done(done, {"bits": 8}, "1"), "the size is another one"
    path.unlink()
    assert not still_done(done, {"bits": 8}, "1")


def test_whose_output_it_is(done: dict[str, Any]) -> None:
    assert wrote_target(begun_record(done["source"], done["target"]))
    assert not wrote_target({**done, "status": "failed"})
    Path(done["target"]).write_bytes(b"edited by somebody")
    assert not wrote_target(done)


def test_the_digest_is_that_of_sha256sum(tmp_path: Path) -> None:
    (tmp_path / "abc").write_bytes(b"abc")
    digest = manifest.digest_of([str(tmp_path / "abc")])
    # FIPS 180-2, appendix B.1
    assert digest == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
