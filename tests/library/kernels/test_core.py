"""The compiled core: what it was built from, and what is checked before it gets a pointer."""

from __future__ import annotations

import importlib.util
import shutil
import sys
import threading
import time
from pathlib import Path
from types import ModuleType

import children
import meshes
import numpy as np
import pytest
from places import ROOT

from deltamesh._graph.adjacency import adjacency
from deltamesh._kernels import core
from deltamesh._kernels.coding import residual
from deltamesh._kernels.coding.delta import code_deltas
from deltamesh._kernels.coding.models import Model
from deltamesh._streams import entropy


def builder() -> ModuleType:
    """The script that compiles the core."""
    spec = importlib.util.spec_from_file_location("build_core", ROOT / "src/core/build.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_library_is_that_of_the_sources() -> None:
    """Else `python src/core/build.py` has been forgotten, and the tests test another core."""
    core.LIBRARY.dm_sources.restype = core.ctypes.c_char_p
    assert core.LIBRARY.dm_sources().decode() == builder().digest()


@pytest.mark.parametrize(
    ("system", "target", "command"),
    [
        (["cc"], "", ["cc"]),
        (None, "", ["zig", "-mcpu=baseline", "-s"]),  # not for this very processor
        (["cc"], "aarch64-macos.11.0", ["zig", "-target", "aarch64-macos.11.0", "-s"]),
    ],
)
def test_ziglang_compiles_for_others_and_where_there_is_no_compiler(
    system: list[str] | None, target: str, command: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    build, commands = builder(), []
    monkeypatch.setattr(build, "compiler", lambda: system)
    monkeypatch.setattr(build, "zig", lambda: ["zig"])
    monkeypatch.setattr(build, "_compile", lambda command, *_: commands.append(command))
    build.build(target)
    always = ("-fPIC", "-shared", build.FAST)
    assert [part for part in commands[0] if part not in always] == command


def test_the_tables_are_those_of_their_script() -> None:
    done = children.run(
        [sys.executable, str(ROOT / "src/core/make_tables.py")], text=True, check=True
    )
    assert done.stdout == (ROOT / "src/core/tables.c").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "array",
    [
        np.zeros(3, dtype=np.int32),
        np.zeros(3),
        np.zeros(4, dtype=np.int64),
        np.zeros((3, 1), dtype=np.int64),
        np.zeros(6, dtype=np.int64)[::2],
        np.zeros(3, dtype=">i8"),
    ],
)
def test_arrays_of_another_kind_are_refused(array: np.ndarray) -> None:
    with pytest.raises(ValueError, match="where the core takes"):
        core.ints(array, 3)


def test_arrays_that_cannot_be_written_are_read_only() -> None:
    array = np.zeros(3, dtype=np.int64)
    array.flags.writeable = False
    core.ints(array, 3)
    with pytest.raises(ValueError, match="where the core takes"):
        core.ints_out(array, 3)


def test_unknown_names_are_refused() -> None:
    with pytest.raises(KeyError):
        core.constant("DM_NOTHING")
    with pytest.raises(AttributeError):
        core.call("dm_nothing")


@pytest.mark.parametrize(
    ("indptr", "indices"),
    [
        ([0, 1, 2], [1, 2]),  # a neighbour that does not exist
        ([0, 1, 2], [1, -1]),
        ([0, 2, 1], [1, 0]),  # a row that ends before it begins
        ([1, 1, 2], [1, 0]),
        ([0, 1, 1], [1, 0]),  # an entry of no row
    ],
)
def test_graphs_that_are_none_are_refused(indptr: list[int], indices: list[int]) -> None:
    coder = entropy.encoder(10, *residual.MODEL)
    values = np.zeros((2, 3), dtype=np.int64)
    with pytest.raises(ValueError, match="dm_code_deltas: arguments that contradict each other"):
        code_deltas(coder, np.array(indptr, np.int32), np.array(indices, np.int32), values)


def test_a_coder_without_the_memory_of_a_model_is_refused() -> None:
    coder = entropy.encoder(10, *Model(residual.SLOTS - 1, residual.MIXERS))
    with pytest.raises(ValueError, match="dm_code_deltas"):
        code_deltas(coder, *adjacency(np.zeros((0, 3), np.int64), 0), np.zeros((0, 3), np.int64))


def test_a_checkout_without_its_library_says_how_to_build_it(tmp_path: Path) -> None:
    package = Path(core.__file__).parent
    shutil.copytree(
        package, tmp_path / "kernels", ignore=shutil.ignore_patterns("_core.*", "__pycache__")
    )
    code = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); import kernels.core"
    done = children.run([sys.executable, "-c", code], text=True)
    assert done.returncode == 1
    assert "`python src/core/build.py`" in done.stderr.splitlines()[-1]


def test_calls_release_the_interpreter_lock() -> None:
    """While one thread is in the core, another goes on."""
    V, F = meshes.torus(200, 150)
    graph, values = adjacency(F, len(V)), np.full((len(V), 3), 5, dtype=np.int64)
    turns, done = [0], threading.Event()

    def count() -> None:
        while not done.is_set():
            turns[0] += 1
            time.sleep(0)

    thread = threading.Thread(target=count)
    interval = sys.getswitchinterval()
    sys.setswitchinterval(100.0)  # no thread loses the lock unless it gives it away
    try:
        coder = entropy.encoder(len(V), *residual.MODEL)
        thread.start()
        before = turns[0]
        code_deltas(coder, *graph, values)
        assert turns[0] > before + 10
    finally:
        done.set()
        sys.setswitchinterval(interval)
        thread.join(60)
