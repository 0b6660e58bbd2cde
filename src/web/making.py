"""Making of what runs in browsers, of `src/web` and the core as WebAssembly.

`src/core/build.py` loads this module, and compiles the core for it.
"""

from __future__ import annotations

import importlib.util
import os
import re
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType

WEB = Path(__file__).parent
CORE = WEB.parent / "core"
LIBRARY = WEB / "freestanding"
PAGES = WEB.parent / "deltamesh" / "_page"

# A module of WebAssembly without any library, and small, for it travels in every page; whoever
# calls it looks after its memory.
_TARGET = ("-target", "wasm32-freestanding", "-mcpu=generic+bulk_memory+simd128", "-nostdlib", "-s")
FLAGS = (*_TARGET, f"-I{LIBRARY}")
# Inlining of the smallest functions alone, and fewer induction variables: the module is a tenth
# smaller, and decoding takes as long.
_SMALL = (
    "-inline-threshold=0",
    "-inlinehint-threshold=30",
    "-inlinecold-threshold=0",
    "-disable-lsr",
)
_LINKED = (
    "-Os",
    *(argument for flag in _SMALL for argument in ("-mllvm", flag)),
    "-Wl,--no-entry",
    "-Wl,-z,stack-size=1048576",
    "-Wl,--export=__heap_base",
)
# Functions of the core in modules of JavaScript, quoted or as exports.
CALLED = re.compile(r'(?:"|exports\.)(dm_\w+)')

# Functions that the core has for others, and that have a body.
DECLARED = re.compile(r"DM_API [^;]*?\b(dm_\w+)\(")
# What WebAssembly has no instruction for: functions of these sources only measure errors.
NEEDS_LIBRARY = re.compile(r"\batan2\(")


def linked(names: Sequence[str]) -> list[str]:
    """Return the arguments that link a module with these functions of the core."""
    exports = [f"-Wl,--export={name}" for name in names]
    return [*_LINKED, *exports, *map(str, sorted(LIBRARY.glob("*.c")))]


def called_functions() -> list[str]:
    """Return the names of the functions of the core that `src/web` calls."""
    texts = [path.read_text(encoding="utf-8") for path in WEB.glob("decoder/*.mjs")]
    return sorted({name for text in texts for name in CALLED.findall(text)})


def decoding_functions() -> list[str]:
    """Return the names of the functions of the core that need no library of mathematics."""
    header = (CORE / "deltamesh_core.h").read_text(encoding="utf-8")
    texts = [path.read_text(encoding="utf-8") for path in CORE.glob("*.c")]
    bare = "".join(text for text in texts if not NEEDS_LIBRARY.search(text))
    return [name for name in DECLARED.findall(header) if f"{name}(" in bare]


def make_pages(core: bytes, folder: Path = PAGES) -> list[Path]:
    """Make the pages, with the compiled core in them; return their paths."""
    join, minify = _module(WEB / "join.py"), _module(WEB / "minify.py")
    as_text = _module(PAGES / "text_of_bytes.py").as_text
    made = []
    for name in join.PAGES:
        page = folder / f"{name}.html"
        unfinished = page.with_name(f"{page.name}.{os.getpid()}")
        text = join.page(name, core, as_text, minify.minified)
        unfinished.write_text(text, encoding="utf-8", newline="\n")
        made.append(unfinished.replace(page))
    return made


def make_package(folder: Path, compiled: Callable[[Path, Sequence[str]], object]) -> Path:
    """Make a package for the npm registry, a new folder; `compiled` compiles the core."""
    ignored = shutil.ignore_patterns("*.py", "freestanding", "viewer", "report", "__pycache__")
    shutil.copytree(WEB, folder, ignore=ignored)
    shutil.copy(WEB.parents[1] / "LICENSE", folder)
    compiled(folder / "core.wasm", called_functions())
    return folder


def _module(path: Path) -> ModuleType:
    """Return a module that is in no package, or in one that cannot be imported yet."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
