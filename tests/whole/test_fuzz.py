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
from deltamesh._pipeline.decoder import read_content
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import FormatError, LimitError

sys.path.insert(0, str(ROOT / "tests" / "fuzz"))
from harness import build, clang, core

Arrays = list[tuple[str, np.ndarray]]


def decoded(path: Path) -> tuple[Mapping[str, object], Content]:
    container = read_container(path.read_bytes())
    return container.sections, read_content(container, 10**6, 10**9)


def expected_arrays(path: Path) -> Arrays:
    """What `replay` has to print of a file, but for attributes and parts."""
    sections, content = decoded(path)
    s, i = content.structure, content.integers
    found = [
        ("CONN", s.complex.manifold.faces),
        ("STCH", s.complex.stitches.points),
        ("COPY", s.faces),
        ("POLY", s.merged),
        ("STEP", i.exponents),
        ("ANCH", i.positions),
        ("DELT", i.values),
        ("CELL", i.cells),
        ("FIXS", i.corrections),
        ("NORM", i.refinements),
        ("CART", i.values),
    ]
    found = [(name, array) for name, array in found if name in sections]
    if "ANCH" in sections:
        found += [("anchors", i.anchors), ("isolated", i.isolated)]
    if "CELL" in sections:
        found.append(("units", i.units))
    if content.poses:
        found.append(("POSE", content.poses[-1].numbers))
    if content.order is not None:
        order = content.order
        found += [("vertices", order.vertices), ("polygons", order.polygons)]
        found += [("rotations", order.rotations)]
    return found


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


@pytest.mark.slow
def test_golden_files_are_read_as_the_library_reads_them(replay: Path) -> None:
    paths = sorted(GOLDEN.glob("*.dmesh"))
    found = replayed(replay, paths)
    assert len(found) == len(paths)
    sections = set()
    for path in paths:
        arrays, refusal = found[path.stem]
        if refusal == "a block of Zstandard":  # which the harness does not read
            assert "zstd" in path.stem
            continue
        assert refusal == "", path.stem
        known = dict(arrays)
        for name, array in expected_arrays(path):
            np.testing.assert_array_equal(known[name], array.ravel(), err_msg=f"{path.stem} {name}")
            sections.add(name)
    assert {
        "CONN",
        "STCH",
        "COPY",
        "POLY",
        "STEP",
        "DELT",
        "NORM",
        "CART",
        "FIXS",
        "CELL",
        "POSE",
    } <= sections


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
