"""Build of the compiled core as a shared library.

`python src/core/build.py` writes it beside the modules that load it; an installation does the same
(`hatch_build.py`). The compiler is the one that CC names, else the system's, else the one of the
package ziglang.
"""

from __future__ import annotations

import argparse
import hashlib
import importlib.util
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

SOURCES = Path(__file__).parent
LIBRARY = (
    SOURCES.parent
    / "deltamesh"
    / "_kernels"
    / {
        "win32": "_core.dll",
        "darwin": "_core.dylib",
    }.get(sys.platform, "_core.so")
)

# No contraction: a fused multiply-add rounds once where the others round twice.
FLAGS = ("-std=c11", "-O2", "-ffp-contract=off", "-fvisibility=hidden", "-shared")
STRICT = ("-Wall", "-Wextra", "-Wconversion", "-Werror")
# Faults end the process: what goes on after one proves nothing.
SANITIZED = ("-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")


class BuildError(Exception):
    """Failure of a build, with the reason."""


def compiler() -> list[str] | None:
    """Return the command of the system's C compiler, None where there is none."""
    if named := os.environ.get("CC"):
        return shlex.split(named)
    found = next((name for name in ("cc", "gcc", "clang") if shutil.which(name)), None)
    return [found] if found else None


def command() -> list[str]:
    """Return the command of a C compiler.

    Raises
    ------
    BuildError
        If there is none.
    """
    if found := compiler():
        return found
    if importlib.util.find_spec("ziglang"):
        return [sys.executable, "-m", "ziglang", "cc"]
    raise BuildError(
        "deltamesh needs a C compiler to be installed from source, and found none: no CC in the "
        "environment, no cc, gcc or clang on PATH, no package ziglang"
    )


def digest() -> str:
    """Return a short digest of the sources, which the library carries."""
    found = hashlib.blake2b(digest_size=8)
    for path in sorted(SOURCES.glob("*.[ch]")):
        found.update(path.read_bytes().replace(b"\r\n", b"\n"))
    return found.hexdigest()


def build(library: Path = LIBRARY, flags: Sequence[str] = ()) -> Path:
    """Compile the core; return the path of the library.

    Parameters
    ----------
    library : Path
        Written when it is complete.
    flags : sequence of str
        For the compiler, beside the usual ones.

    Raises
    ------
    BuildError
        If there is no compiler, or if it fails.
    """
    unfinished = library.with_name(f"{library.name}.{os.getpid()}")
    position = () if sys.platform == "win32" else ("-fPIC",)
    libraries = () if sys.platform == "win32" else ("-lm",)
    done = subprocess.run(
        [
            *(*command(), *FLAGS, *position, *flags, f'-DDM_SOURCES="{digest()}"'),
            *map(str, sorted(SOURCES.glob("*.c"))),
            *("-o", str(unfinished), *libraries),
        ],
        capture_output=True,
        text=True,
        errors="replace",
    )
    if done.returncode:
        unfinished.unlink(missing_ok=True)
        raise BuildError(f"{shlex.join(command())} failed:\n{done.stderr}")
    unfinished.replace(library)
    return library


def main() -> None:
    """Build the library of this checkout."""
    parser = argparse.ArgumentParser(description="Build the compiled core of this checkout.")
    parser.add_argument("--strict", action="store_true", help="take warnings for errors")
    parser.add_argument(
        "--sanitize", action="store_true", help="check accesses and arithmetic while it runs"
    )
    arguments = parser.parse_args()
    try:
        print(build(flags=STRICT * arguments.strict + SANITIZED * arguments.sanitize))
    except BuildError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
