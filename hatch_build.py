"""Build hook: an installation compiles the core, for every Python of its platform, and pages."""

from __future__ import annotations

import importlib.util
import os
import sysconfig
from pathlib import Path
from types import ModuleType
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

# One of the targets of `src/core/build.py`; none for a wheel of this machine.
TARGET = os.environ.get("DELTAMESH_TARGET", "")


def _builder(root: str) -> ModuleType:
    """Return the module `src/core/build.py`, which is in no package."""
    path = Path(root) / "src" / "core" / "build.py"
    spec = importlib.util.spec_from_file_location("build_core", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class CustomBuildHook(BuildHookInterface[Any]):
    """Hook that puts the core and the pages into the wheel; editable ones find them as sources."""

    def dependencies(self) -> list[str]:
        """Return a compiler that is a wheel: only it makes WebAssembly everywhere."""
        return ["ziglang>=0.13"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile the core, make the pages, and tag the wheel by its platform alone."""
        builder = _builder(self.root)
        library = builder.build(TARGET)
        made = [library]
        try:
            made += builder.build_pages()
        except builder.NoCompilerError as error:
            # A build without isolation may lack it; `deltamesh view` and others then say so.
            self.app.display_warning(str(error))
        build_data["artifacts"] += [path.relative_to(self.root).as_posix() for path in made]
        build_data["pure_python"] = False
        here = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        platform = builder.TARGETS[TARGET] if TARGET else here
        build_data["tag"] = f"py3-none-{platform}"
