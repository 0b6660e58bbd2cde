"""Where compiled kernels are kept."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import children

from deltamesh._kernels import jit

PACKAGE = Path(jit.__file__).parent

# A package whose __pycache__ cannot be a folder: what a read-only installation is to the kernels.
PROBE = """
import sys
sys.dont_write_bytecode = True
sys.path.insert(0, sys.argv[1])
from kernels import jit
@jit.kernel
def twice(x):
    return 2 * x
twice(21)
print(jit.CACHE_FOLDER)
print(twice.stats.cache_hits.__len__(), twice.stats.cache_misses.__len__())
"""


def run(package: Path, cache: Path) -> list[str]:
    script = package.parent / "probe.py"
    script.write_text(PROBE)
    result = children.run(
        [sys.executable, str(script), str(package.parent)],
        text=True,
        check=True,
        env={"XDG_CACHE_HOME": str(cache), "PATH": "", "HOME": str(cache)},
    )
    return result.stdout.split("\n")


def test_a_read_only_installation_caches_in_the_cache_folder_of_the_user(tmp_path: Path) -> None:
    package, cache = tmp_path / "site" / "kernels", tmp_path / "cache"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    (package / "__pycache__").write_text("in the way")
    folder, first, *_ = run(package, cache)
    assert Path(folder).is_relative_to(cache / "deltamesh")
    assert first == "0 1"
    assert run(package, cache)[1] == "1 0"


def test_an_edit_of_any_kernel_names_another_folder(tmp_path: Path) -> None:
    package = tmp_path / "site" / "kernels"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    before = run(package, tmp_path)[0]
    with (package / "front.py").open("a") as file:
        file.write("# an edit\n")
    after = run(package, tmp_path)[0]
    assert Path(before).is_relative_to(package / "__pycache__")
    assert before != after


def test_numba_cache_dir_overrides(monkeypatch) -> None:
    monkeypatch.setitem(vars(jit.config), "CACHE_DIR", "elsewhere")

    @jit.kernel
    def thrice(x: int) -> int:
        return 3 * x

    assert vars(jit.config)["CACHE_DIR"] == "elsewhere"
    assert "elsewhere" in thrice.stats.cache_path
