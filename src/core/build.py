"""Build of the compiled core.

`python src/core/build.py` writes a shared library beside the modules that load it; an installation
does the same (`hatch_build.py`). The compiler is the one that CC names, else the system's, else the
one of the package ziglang, which also compiles for other systems and for WebAssembly.

With ziglang, it also makes what runs in browsers, of `src/web`: pages that are complete in
themselves (`--page`), beside the module that fills them in, and a package for the npm registry
(`--npm FOLDER`).
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
import tempfile
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

SOURCES = Path(__file__).parent
FOLDER = SOURCES.parent / "deltamesh" / "_kernels"
MAKING = SOURCES.parent / "web" / "making.py"

# No contraction: a fused multiply-add rounds once where the others round twice.
FLAGS = ("-std=c11", "-ffp-contract=off", "-fvisibility=hidden")
# Factoring is 15 % faster than with -O2, coding 5 %, for 3 s more of compilation.
FAST = "-O3"
STRICT = ("-Wall", "-Wextra", "-Wconversion", "-Werror")
# Faults end the process: what goes on after one proves nothing.
SANITIZED = ("-g", "-O2", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")

# Targets of ziglang, and the tags of the wheels that have a library for them.
TARGETS = {
    "x86_64-linux-gnu.2.17": "manylinux_2_17_x86_64",
    "aarch64-linux-gnu.2.17": "manylinux_2_17_aarch64",
    "x86_64-linux-musl": "musllinux_1_1_x86_64",
    "aarch64-linux-musl": "musllinux_1_1_aarch64",
    "x86_64-macos.11.0": "macosx_11_0_x86_64",
    "aarch64-macos.11.0": "macosx_11_0_arm64",
    "x86_64-windows-gnu": "win_amd64",
}


class BuildError(Exception):
    """Failure of a build, with the reason."""


class NoCompilerError(BuildError):
    """The compiler that a build needs is not installed."""


def compiler() -> list[str] | None:
    """Return the command of the system's C compiler, None where there is none."""
    if named := os.environ.get("CC"):
        return shlex.split(named)
    found = next((name for name in ("cc", "gcc", "clang") if shutil.which(name)), None)
    return [found] if found else None


def zig() -> list[str]:
    """Return the command of the compiler of the package ziglang.

    Raises
    ------
    NoCompilerError
        If it is not installed.
    """
    if importlib.util.find_spec("ziglang"):
        return [sys.executable, "-m", "ziglang", "cc"]
    raise NoCompilerError("the package ziglang is not installed")


def digest() -> str:
    """Return a short digest of the sources, which the library carries."""
    found = hashlib.blake2b(digest_size=8)
    for path in sorted(SOURCES.glob("*.[ch]")):
        found.update(path.read_bytes().replace(b"\r\n", b"\n"))
    return found.hexdigest()


def library_of(target: str = "") -> Path:
    """Return the path of the library for a target or, by default, for this machine."""
    if target:
        suffix = "dylib" if "macos" in target else "dll" if "windows" in target else "so"
    else:
        suffix = {"win32": "dll", "darwin": "dylib"}.get(sys.platform, "so")
    return FOLDER / f"_core.{suffix}"


def build(target: str = "", flags: Sequence[str] = ()) -> Path:
    """Compile the core; return the path of the library.

    Parameters
    ----------
    target : str
        One of `TARGETS`, for which ziglang compiles. Default: this machine.
    flags : sequence of str
        For the compiler, beside the usual ones.

    Raises
    ------
    BuildError
        If there is no compiler, or if it fails.
    """
    library = library_of(target)
    # Of itself, ziglang compiles for the very processor that it runs on, but libraries get around.
    kind = ("-target", target) if target else ("-mcpu=baseline",)
    command = (None if target else compiler()) or [*_last_compiler(), *kind, "-s"]
    if library.suffix != ".dll":
        command += ["-fPIC"]
    _compile([*command, "-shared", FAST, *flags], library, ["-lm"])
    return library


def _last_compiler() -> list[str]:
    """Return the command of ziglang, where no other compiler was found."""
    try:
        return zig()
    except NoCompilerError as error:
        raise NoCompilerError(
            "deltamesh needs a C compiler to be installed from source, and found none: no CC in "
            f"the environment, no cc, gcc or clang on PATH, and {error}"
        ) from None


def build_wasm(module: Path, names: Sequence[str] = ()) -> Path:
    """Compile the core as WebAssembly, with ziglang; return the path of the module.

    Parameters
    ----------
    module : Path
    names : sequence of str
        Functions that it has. Default: all that need no library of mathematics.

    Raises
    ------
    BuildError
    """
    web = _web()
    _compile([*zig(), *web.FLAGS], module, web.linked(names or web.decoding_functions()))
    return module


def build_pages() -> list[Path]:
    """Make the pages that show meshes, with the core in them; return their paths.

    Raises
    ------
    BuildError
    """
    web = _web()
    with tempfile.TemporaryDirectory() as folder:
        core = build_wasm(Path(folder) / "core.wasm", web.called_functions()).read_bytes()
    pages: list[Path] = web.make_pages(core)
    return pages


def build_package(folder: Path) -> Path:
    """Make a package for the npm registry: a new folder with the modules and the core.

    Raises
    ------
    BuildError
    """
    package: Path = _web().make_package(folder, build_wasm)
    return package


def _web() -> ModuleType:
    """Return the module `src/web/making.py`, which is in no package."""
    spec = importlib.util.spec_from_file_location("making_for_web", MAKING)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _compile(command: Sequence[str], target: Path, linked: Sequence[str]) -> None:
    """Compile the core into a file that is there when it is complete."""
    unfinished = target.with_name(f"{target.name}.{os.getpid()}")
    sources = map(str, sorted(SOURCES.glob("*.c")))
    named = (f'-DDM_SOURCES="{digest()}"', *sources, "-o", str(unfinished))
    done = subprocess.run(
        [*command, *FLAGS, *named, *linked], capture_output=True, text=True, errors="replace"
    )
    if done.returncode:
        unfinished.unlink(missing_ok=True)
        raise BuildError(f"{shlex.join(command)} failed:\n{done.stderr}")
    unfinished.replace(target)


def main() -> None:
    """Build the core of this checkout."""
    parser = argparse.ArgumentParser(description="Build the compiled core of this checkout.")
    parser.add_argument("--strict", action="store_true", help="take warnings for errors")
    parser.add_argument(
        "--sanitize", action="store_true", help="check accesses and arithmetic while it runs"
    )
    parser.add_argument("--target", choices=TARGETS, default="", help="compile for it, by ziglang")
    parser.add_argument("--wasm", type=Path, metavar="FILE", help="write WebAssembly, by ziglang")
    parser.add_argument("--page", action="store_true", help="make the pages, by ziglang")
    parser.add_argument("--npm", type=Path, metavar="FOLDER", help="make a package, by ziglang")
    arguments = parser.parse_args()
    flags = STRICT * arguments.strict + SANITIZED * arguments.sanitize
    try:
        if arguments.wasm:
            print(build_wasm(arguments.wasm))
        elif arguments.page:
            print(*build_pages(), sep="\n")
        elif arguments.npm:
            print(build_package(arguments.npm))
        else:
            print(build(arguments.target, flags))
    except BuildError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
