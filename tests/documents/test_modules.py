"""Modules and their tests: each module is imported by a test of its folder, or has a reason.

Tests mirror the source: `deltamesh._shape.stitches` is tested in `tests/library/shape`, a module
right below `deltamesh` in `tests/library`, `deltamesh_formats.container.reader` in
`tests/formats/container`, and all of the command line in `tests/cli`.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

import pytest
from places import ROOT

TESTS = ROOT / "tests"
SOURCES = {"deltamesh": "src", "deltamesh_formats": "formats", "deltamesh_cli": "cli"}
FOLDERS = {"deltamesh": "library", "deltamesh_formats": "formats", "deltamesh_cli": "cli"}

# Modules that no test of their folder imports, and why.
UNTESTED: Mapping[str, str] = {}

# The twin of each kernel, a name in tests/oracles or tests/reference_decoder that a test compares
# it with; or, where there is none, the reason.
TWINS: Mapping[str, tuple[str, ...] | str] = {}


def modules() -> dict[str, Path]:
    """All modules by name, but packages that have nothing but a docstring."""
    found = {}
    for package, folder in SOURCES.items():
        for path in sorted((ROOT / folder / package).rglob("*.py")):
            parts = path.relative_to(ROOT / folder).with_suffix("").parts
            body = tree_of(path).body
            if parts[-1] != "__init__":
                found[".".join(parts)] = path
            elif any(not is_text(node) for node in body):
                found[".".join(parts[:-1])] = path
    return found


def is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


@cache
def tree_of(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def imported(path: Path) -> Iterator[str]:
    """Names of modules, and dotted names in them, that a file imports wherever in it."""
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


@cache
def homes(path: Path) -> dict[str, str]:
    """Of each name that a module has from another one, that module."""
    return {
        alias.asname or alias.name: node.module
        for node in ast.walk(tree_of(path))
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    }


def tested_by(path: Path, known: Mapping[str, Path]) -> set[str]:
    """The modules that a test imports; a public name counts for the module that defines it."""
    found = set()
    for name in imported(path):
        if name in known:
            found.add(name)
            continue
        package, _, attribute = name.rpartition(".")
        if package in known and known[package].stem == "__init__":
            home = homes(known[package]).get(attribute)
            found |= {home} if home in known else set()
    return found


def folder_of(module: str) -> Path:
    """The folder of the tests of a module."""
    package, *rest = module.split(".")
    folder = TESTS / FOLDERS[package]
    if package == "deltamesh_cli" or not rest:
        return folder
    below = folder / rest[0].removeprefix("_")
    return below if below.is_dir() else folder


def tests_in(folder: Path) -> list[Path]:
    return sorted(folder.rglob("test_*.py"))


def attributes(path: Path) -> set[str]:
    """All dotted names `module.name` in a file, and the names that it imports."""
    found = set(imported(path))
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            found.add(f"{node.value.id}.{node.attr}")
    return found


MODULES = modules()
TESTED = {path: tested_by(path, MODULES) for path in tests_in(TESTS)}
KERNELS = [
    name
    for name in MODULES
    if name.startswith(("deltamesh._kernels.coding.", "deltamesh._kernels.mesh."))
]


@pytest.mark.parametrize("module", MODULES)
def test_each_module_has_its_test_or_a_reason(module: str) -> None:
    folder = folder_of(module)
    tests = [path.name for path in tests_in(folder) if module in TESTED[path]]
    if module in UNTESTED:
        assert not tests, f"{module} has a test and needs no reason: {tests}"
    else:
        where = folder.relative_to(ROOT)
        assert tests, f"no test in {where} imports {module}, and no reason is given"


def test_reasons_are_of_modules_that_are_there() -> None:
    assert UNTESTED.keys() <= MODULES.keys()
    assert all(reason.strip() for reason in UNTESTED.values())


@pytest.mark.parametrize("kernel", KERNELS)
def test_each_kernel_has_its_twin_or_a_reason(kernel: str) -> None:
    twins = TWINS[kernel.removeprefix("deltamesh._kernels.")]
    if isinstance(twins, str):
        assert twins.strip()
        return
    for twin in twins:
        module, _, name = twin.partition(".")
        (path,) = (
            p for f in ("oracles", "reference_decoder") for p in TESTS.glob(f"{f}/{module}.py")
        )
        assert name in {getattr(node, "name", "") for node in tree_of(path).body}
        used = [test.name for test in tests_in(TESTS) if twin in attributes(test)]
        assert used, f"no test compares {kernel} with {twin}"


def test_twins_are_of_kernels_that_are_there() -> None:
    assert {f"deltamesh._kernels.{name}" for name in TWINS} == set(KERNELS)


def test_each_test_module_says_what_it_tests() -> None:
    silent = [path.name for path in tests_in(TESTS) if not ast.get_docstring(tree_of(path))]
    assert not silent


def test_test_modules_have_different_names() -> None:
    """pytest imports them by their names alone."""
    names = [path.name for path in TESTS.rglob("*.py") if path.name != "conftest.py"]
    assert len(names) == len(set(names))
