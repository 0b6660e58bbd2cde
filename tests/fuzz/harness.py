"""Build of the harness: `replay`, which decodes files, and the fuzzer, for which clang is needed.

Both have the core in them, compiled with the sanitizers.
"""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
from pathlib import Path

HERE = Path(__file__).parent
CORE = HERE.parents[1] / "src" / "core"

_SPEC = importlib.util.spec_from_file_location("build_of_core", CORE / "build.py")
assert _SPEC is not None
assert _SPEC.loader is not None
core = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(core)

# Edges of the core alone count as reached. Comparisons are not traced: what a decoder compares are
# bits of a stream, which no constant tells, and tracing takes two thirds of the time.
COUNTED = "-fsanitize-coverage=inline-8bit-counters,pc-table"


def clang() -> str | None:
    """Return the compiler that has libFuzzer, None where there is none."""
    found = shutil.which("clang")
    if found is None:
        return None
    printed = [found, "-print-runtime-dir"]
    folder = Path(
        subprocess.run(printed, capture_output=True, text=True, check=True).stdout.strip()
    )
    return found if any(folder.glob("*clang_rt.fuzzer*")) else None


def build(folder: Path, compiler: list[str], fuzzer: bool) -> Path:
    """Compile `replay`, or the fuzzer, into a folder; return the program.

    Raises
    ------
    subprocess.CalledProcessError
    """
    left_out = {"replay.c"} if fuzzer else {"mutate.c"}
    own = [path for path in sorted(HERE.glob("*.c")) if path.name not in left_out]
    flags = [*core.FLAGS, *core.SANITIZED, f"-I{CORE}", f"-I{HERE}"]
    objects = []
    for path in (*sorted(CORE.glob("*.c")), *own):
        objects.append(str(folder / f"{path.parent.name}-{path.stem}.o"))
        noted = ["-include", "touched.h", *([COUNTED] if fuzzer else [])]
        extra = noted if path.parent == CORE else ["-Wall", "-Wextra", "-Werror"]
        _run([*compiler, *flags, *extra, "-c", str(path), "-o", objects[-1]])
    program = folder / ("fuzzer" if fuzzer else "replay")
    kind = ["-fsanitize=fuzzer"] if fuzzer else []
    # The slots that a stream of connectivity begins with are computed once; see `coders.c`.
    linked = ["-Wl,--wrap=dm_set_prior", "-lm", "-lz", "-o", str(program)]
    _run([*compiler, *core.SANITIZED, *kind, *objects, *linked])
    return program


def _run(command: list[str]) -> None:
    subprocess.run(command, capture_output=True, text=True, check=True, timeout=300)
