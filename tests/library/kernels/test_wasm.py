"""The core as WebAssembly: the calls that decode all golden and refused files, made by Node."""

from __future__ import annotations

import base64
import ctypes
import importlib.util
import json
import os
import shutil
import sys
from pathlib import Path
from typing import Any

import children
import pytest
from places import GOLDEN, REFUSED, ROOT

from deltamesh._kernels import core
from deltamesh._kernels.coding import coder, front
from deltamesh._pipeline.decoder import read_content
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import DeltameshError

# Functions that begin something that lives on, and so do the arrays that they take.
STARTS = ("dm_start", "dm_start_front")


def text(content: bytes) -> str:
    return base64.b64encode(content).decode()


class Recorder:
    """Calls of the core, with their arrays before and after."""

    def __init__(self) -> None:
        self.calls: list[dict[str, Any]] = []
        self.alive: list[object] = []  # an id is that of one object only

    def invoke(self, name: str, *arguments: Any) -> int:
        entries = [self.before(name, argument) for argument in arguments]
        result = INVOKE(name, *arguments)
        for entry, argument in zip(entries, arguments, strict=True):
            if "before" in entry and "kept" not in entry:
                entry["after"] = text(content_of(argument))
        # What a function without a result has left in the register means nothing.
        known = 0 if name == "dm_start_front" else result
        self.calls.append({"name": name, "arguments": entries, "result": str(known)})
        return result

    def before(self, name: str, argument: Any) -> dict[str, Any]:
        self.alive.append(argument)
        if isinstance(argument, float):
            return {"float": argument}
        if hasattr(argument, "__index__"):
            return {"integer": str(argument.__index__())}
        if hasattr(argument, "_obj") and isinstance(argument._obj, ctypes.Structure):
            return {"kept": id(argument._obj)}
        if name in STARTS and hasattr(argument, "array"):
            array = argument.array
            # Slots and mixers are filled by the call, a stream is read.
            before = text(array.tobytes()) if array.nbytes < 1 << 20 else ""
            return {"kept": id(array), "size": array.nbytes, "before": before}
        return {"before": text(content_of(argument))}


INVOKE = core.invoke


def content_of(argument: Any) -> bytes:
    """The bytes behind a pointer to an array or to a number."""
    return bytes(argument._obj) if hasattr(argument, "_obj") else argument.array.tobytes()


@pytest.fixture(scope="module")
def module(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The core as WebAssembly: that of DELTAMESH_WASM, or a new one."""
    if named := os.environ.get("DELTAMESH_WASM"):
        return Path(named)
    if not importlib.util.find_spec("ziglang"):
        pytest.skip("no ziglang, and no module in DELTAMESH_WASM")
    path = tmp_path_factory.mktemp("wasm") / "core.wasm"
    command = [sys.executable, str(ROOT / "src/core/build.py"), "--wasm", str(path)]
    children.run(command, check=True)
    return path


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("node"), reason="no node")
def test_golden_and_refused_files_decode_alike(
    module: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls, total = tmp_path / "calls", 0
    with calls.open("w", encoding="utf-8") as file:
        for path in sorted([*GOLDEN.glob("*.dmesh"), *REFUSED.glob("*.dmesh")]):
            recorder = Recorder()
            for place in (core, coder, front):
                monkeypatch.setattr(place, "invoke", recorder.invoke)
            try:
                read_content(read_container(path.read_bytes()), 10**6, 10**9)
            except DeltameshError:
                assert path.parent == REFUSED
            monkeypatch.undo()
            file.write(json.dumps(recorder.calls) + "\n")
            total += len(recorder.calls)
    script = ROOT / "tests/support/replay.mjs"
    done = children.run(["node", str(script), str(module), str(calls)], text=True)
    assert done.stderr == ""
    assert int(done.stdout) == total > 500
