"""The fuzzers' reading of the format against the library's, and a short run of the fuzzer."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import children
import numpy as np
import pytest
from places import GOLDEN, REFUSED, ROOT

from deltamesh._content import Content
from deltamesh._geometry.integers import Integers
from deltamesh._pipeline.decoder import read_content
from deltamesh._sections.frames import frame_integers
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.frame_table import Frame
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import FormatError, LimitError

sys.path.insert(0, str(ROOT / "tests" / "fuzz"))
from harness import build, clang, core
from seeds import sequences

Arrays = list[tuple[str, np.ndarray]]


def decoded(path: Path) -> tuple[Mapping[str, object], Content]:
    container = read_container(path.read_bytes())
    content = read_content(container, 10**6, 10**9)
    for frame in container.frames:
        frame_integers(container, content, frame)
    return container.sections, content


def expected_arrays(path: Path) -> list[Arrays]:
    """What `replay` has to print of each frame of a file, but for attributes and parts."""
    container = read_container(path.read_bytes())
    sections, content = decoded(path)
    s = content.structure
    found = [
        ("CONN", s.complex.manifold.faces),
        ("STCH", s.complex.stitches.points),
        ("COPY", s.faces),
        ("POLY", s.merged),
        ("STEP", content.integers.exponents),
        *arrays_of(content.integers),
    ]
    found = [(name, array) for name, array in found if name in sections]
    if "ANCH" in sections:
        found += [("anchors", content.integers.anchors), ("isolated", content.integers.isolated)]
    if "CELL" in sections:
        found.append(("units", content.integers.units))
    if content.poses:
        found.append(("POSE", content.poses[-1].numbers))
    if content.order is not None:
        order = content.order
        found += [("vertices", order.vertices), ("polygons", order.polygons)]
        found += [("rotations", order.rotations)]
    return [found, *(arrays_of_frame(container, content, frame) for frame in container.frames)]


def arrays_of(integers: Integers) -> Arrays:
    return [
        ("ANCH", integers.positions),
        ("DELT", integers.values),
        ("CELL", integers.cells),
        ("FIXS", integers.corrections),
        ("NORM", integers.refinements),
        ("CART", integers.values),
    ]


def arrays_of_frame(container: Container, content: Content, frame: Frame) -> Arrays:
    motion, integers = frame_integers(container, content, frame)
    found = [(name, array) for name, array in arrays_of(integers) if name in frame.sections]
    if motion is not None:
        found.append(("MAPS", motion.rows))
    if "ANCH" in frame.sections:
        found.append(("isolated", integers.isolated))
    if "CELL" in frame.sections:
        found.append(("units", integers.units))
    return found


def by_frames(arrays: Arrays) -> list[Arrays]:
    """The arrays that `replay` has printed of each frame."""
    frames: dict[int, Arrays] = {0: []}
    at = 0
    for name, array in arrays:
        if name == "FRAM":
            at = int(array[0])
        else:
            frames.setdefault(at, []).append((name, array))
    return list(frames.values())


def replayed(program: Path, paths: list[Path]) -> dict[str, tuple[Arrays, str]]:
    """The arrays that the harness decodes, and why it refuses a file, by the names of files."""
    done = children.run([str(program), *map(str, paths)], text=True)
    assert (done.returncode, done.stderr) == (0, "")
    result: dict[str, tuple[Arrays, str]] = {}
    for line in done.stdout.splitlines():
        what, _, rest = line.partition(" ")
        if what == "FILE":
            name = Path(rest).stem
            result[name] = [], ""
        elif what == "REFUSED":
            result[name] = result[name][0], rest
        else:
            result[name][0].append((what, np.array(rest.split(), dtype=np.int64)))
    return result


@pytest.fixture(scope="module")
def replay(tmp_path_factory: pytest.TempPathFactory) -> Path:
    compiler = core.compiler()
    if compiler is None or sys.platform != "linux":
        pytest.skip("no C compiler, or no Linux")
    try:
        return build(tmp_path_factory.mktemp("replay"), compiler, fuzzer=False)
    except subprocess.CalledProcessError as error:
        if any(missing in error.stderr for missing in ("zlib.h", "-lz", "asan", "ubsan")):
            pytest.skip(f"no zlib or no sanitizers: {error.stderr[-200:]}")
        pytest.fail(error.stderr)


def compare(replay: Path, paths: list[Path]) -> set[tuple[str, bool]]:
    """Compare what is read of files; return names of arrays, and whether of further frames."""
    found = replayed(replay, paths)
    assert len(found) == len(paths)
    seen = set()
    for path in paths:
        arrays, refusal = found[path.stem]
        if refusal == "a block of Zstandard":  # which the harness does not read
            assert "zstd" in path.stem
            continue
        assert refusal == "", path.stem
        frames = zip(by_frames(arrays), expected_arrays(path), strict=True)
        for i, (known, expected) in enumerate(frames):
            for name, array in expected:
                where = f"{path.stem} {name} of frame {i}"
                np.testing.assert_array_equal(dict(known)[name], array.ravel(), err_msg=where)
                seen.add((name, i > 0))
    return seen


OF_FRAMES = ("DELT", "NORM", "CART", "FIXS", "CELL", "ANCH", "isolated")


@pytest.mark.slow
def test_golden_files_are_read_as_the_library_reads_them(replay: Path) -> None:
    seen = compare(replay, sorted(GOLDEN.glob("*.dmesh")))
    names = ("CONN", "STCH", "COPY", "POLY", "STEP", "POSE", *OF_FRAMES)
    assert {(name, False) for name in names} <= seen


@pytest.mark.slow
def test_frames_are_read_as_the_library_reads_them(replay: Path, tmp_path: Path) -> None:
    for name, data in sequences():
        (tmp_path / f"{name}.dmesh").write_bytes(data)
    seen = compare(replay, sorted(tmp_path.iterdir()))
    assert {(name, True) for name in ("MAPS", *OF_FRAMES)} <= seen


@pytest.mark.slow
def test_attributes_are_read_to_the_last_stream(replay: Path) -> None:
    paths = [path for path in sorted(GOLDEN.glob("*.dmesh")) if "ATTR" in decoded(path)[0]]
    for name, (arrays, _) in replayed(replay, paths).items():
        _, content = decoded(GOLDEN / f"{name}.dmesh")
        columns = iter([array for what, array in arrays if what in ("columns", "normals")])
        for one in content.attributes:
            if one.entry.coding == "exact":
                continue
            width = one.codes.shape[1]
            threes = [next(columns).reshape(-1, 3) for _ in range(-(-width // 3))]
            if one.entry.mixed:
                threes[0][:, [0, 2]] += threes[0][:, [1]]
            np.testing.assert_array_equal(
                np.concatenate([np.zeros((len(one.codes), 0), np.int64), *threes], axis=1)[
                    :, :width
                ],
                one.codes,
                err_msg=f"{name} {one.entry.name!r}",
            )
        assert next(columns, None) is None, name


@pytest.mark.slow
def test_whatever_kernels_refuse_is_refused(replay: Path) -> None:
    """The harness leaves out floats, words, checksums, the order of sections and the digest."""
    found = replayed(replay, sorted(REFUSED.glob("*.dmesh")))
    refused = {name for name, (_, refusal) in found.items() if refusal}
    assert len(refused) > 100
    for name in refused:
        with pytest.raises((FormatError, LimitError)):
            decoded(REFUSED / f"{name}.dmesh")


@pytest.mark.slow
@pytest.mark.skipif(clang() is None, reason="no clang with libFuzzer")
def test_twenty_thousand_hostile_files(tmp_path: Path) -> None:
    command = [sys.executable, str(ROOT / "benchmarks/fuzz.py"), "--runs", "20000"]
    done = children.run([*command, "--folder", str(tmp_path)], text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = [line.split() for line in done.stdout.splitlines() if line.endswith(" findings")]
    assert rows == [["0", "findings"]]
    executions = [int(line.split()[0]) for line in done.stdout.splitlines()[2:4]]
    assert sum(executions) >= 20000
