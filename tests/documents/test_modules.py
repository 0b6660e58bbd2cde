"""Modules and their tests: each module is imported by a test of its folder, or has a reason.

Tests mirror the source: `deltamesh._shape.stitches` is tested in `tests/library/shape`, a module
right below `deltamesh` in `tests/library`, `deltamesh_formats.container.reader` in
`tests/formats/container`, and all of the command line in `tests/cli`.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

import pytest
from places import ROOT

TESTS = ROOT / "tests"
SOURCES = {"deltamesh": "src", "deltamesh_formats": "formats", "deltamesh_cli": "cli"}
FOLDERS = {"deltamesh": "library", "deltamesh_formats": "formats", "deltamesh_cli": "cli"}

# Modules that no test of their folder imports, and why.
TYPES = "data only: types for annotations"
DATA = "data only: what is written in it, its users read"
COMMAND = "tested through the command line: cli/test_commands.py"
UNTESTED: Mapping[str, str] = {
    "deltamesh.__main__": "tested in a process: library/test_layers.py",
    "deltamesh._version": DATA,
    "deltamesh._kernels.coding.connectivity": "tested by library/shape/test_connectivity.py",
    "deltamesh._kernels.coding.face_order": "tested by library/order/test_order.py",
    "deltamesh._kernels.coding.vertex_order": "tested by library/order/test_order.py",
    "deltamesh._kernels.coding.steps": "tested by library/order/test_order.py",
    "deltamesh_formats.array_types": TYPES,
    **{
        f"deltamesh_formats.meshfiles.{name}{module}": f"tested through files: {test}"
        for name, test in {
            "glb": "formats/meshfiles/test_glb.py",
            "obj": "formats/meshfiles/test_obj.py",
            "off": "formats/meshfiles/test_off.py",
            "ply": "formats/meshfiles/test_ply.py",
            "stl": "formats/meshfiles/test_stl.py",
        }.items()
        for module in ("", ".reader", ".writer")
    },
    "deltamesh_formats.meshfiles.obj.statements": DATA,
    "deltamesh_cli.__main__": "tested in processes: cli/test_process.py",
    "deltamesh_cli.batch.settings": DATA,
    "deltamesh_cli.commands.compare": COMMAND,
    "deltamesh_cli.commands.completion": "tested by cli/test_completion.py",
    "deltamesh_cli.commands.edit": "tested by cli/test_edit.py",
    "deltamesh_cli.commands.info": COMMAND,
    "deltamesh_cli.commands.render": "tested by cli/test_render.py",
    "deltamesh_cli.commands.test": COMMAND,
}

# The twins of each kernel, names in tests/oracles or tests/reference_decoder that a test compares
# it with; or, where there is none, the reason.
TWINS: Mapping[str, tuple[str, ...] | str] = {
    "coding.choices": ("oracle.code_choices",),
    "coding.coder": ("oracle.RangeCoder",),
    "coding.connectivity": ("oracle.RegionGrower", "spec_decoder.decode"),
    "coding.delta": ("oracle.code_deltas", "oracle.code_refinements", "oracle.diffuse"),
    "coding.exact": ("spec_decoder.decode",),
    "coding.face_order": ("spec_decoder.read_order",),
    "coding.front": ("oracle.Waiting", "oracle.RegionGrower"),
    "coding.grid": ("spec_decoder.decode",),
    "coding.hidden_edges": ("polygon_oracle.Merging",),
    "coding.labels": ("oracle.code_labels",),
    "coding.merged_pairs": ("polygon_oracle.Merging",),
    "coding.models": "tables of the core: library/kernels/test_models.py has them by hand",
    "coding.parallelogram": ("oracle.code_positions", "oracle.predict"),
    "coding.points": ("spec_decoder.decode",),
    "coding.remaining": ("oracle.Left", "oracle.rings"),
    "coding.residual": ("oracle.code_deltas", "oracle.code_refinements"),
    "coding.signed_integers": ("oracle.code_number", "oracle.slot", "oracle.level"),
    "coding.steps": ("spec_decoder.read_order",),
    "coding.stitching": ("spec_decoder.decode",),
    "coding.valence": ("oracle.code_below", "spec_decoder.decode"),
    "coding.vertex_order": ("spec_decoder.read_order",),
    "coding.wedges": ("spec_decoder.decode",),
    "mesh.closest": ("oracle.squared_to_triangle", "oracle.largest_squared_distance"),
    "mesh.correspondence": ("oracle.patch",),
    "mesh.cutting": ("oracle.fans", "oracle.orient"),
    "mesh.diagonals": ("polygon_oracle.choose",),
    "mesh.differences": (
        "differences_oracle.distance",
        "differences_oracle.face_normal",
        "differences_oracle.face_change",
        "differences_oracle.dihedral_angle",
    ),
    "mesh.distance": ("oracle.farthest", "poisson_oracle.nearest"),
    "mesh.elimination": ("oracle.factor_entries",),
    "mesh.factor": ("oracle.solve_by_elimination", "oracle.factor_entries"),
    "mesh.halfedges": ("polygon_oracle.after", "polygon_oracle.before"),
    "mesh.laplacian": ("oracle.laplacian", "poisson_oracle.smoothed"),
    "mesh.motions": ("motions_oracle.span", "motions_oracle.walk", "motions_oracle.carry"),
    "mesh.multigrid": (
        "poisson_oracle.aggregates",
        "poisson_oracle.coarsened",
        "poisson_oracle.descended",
        "poisson_oracle.factor",
    ),
    "mesh.neighbours": ("oracle.neighbours", "oracle.component_labels"),
    "mesh.normals": ("oracle.normals",),
    "mesh.outlines": ("polygon_oracle.outlines",),
    "mesh.parallelograms": ("oracle.parallelograms",),
    "mesh.rotations": (
        "rotations_oracle.fit",
        "rotations_oracle.nearest",
        "rotations_oracle.turned",
    ),
}


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


def is_reason(value: object) -> bool:
    return isinstance(value, str)


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


def modules_of(path: Path, known: Mapping[str, Path]) -> set[str]:
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


def modules_below(folder: Path) -> list[Path]:
    return sorted(folder.rglob("test_*.py"))


@cache
def attributes(path: Path) -> set[str]:
    """All dotted names `module.name` in a file, and the names that it imports."""
    found = set(imported(path))
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            found.add(f"{node.value.id}.{node.attr}")
    return found


MODULES = modules()
TESTED = {path: modules_of(path, MODULES) for path in modules_below(TESTS)}
KERNELS = [
    name
    for name in MODULES
    if name.startswith(("deltamesh._kernels.coding.", "deltamesh._kernels.mesh."))
]


REASONS = sorted({*UNTESTED.values(), *filter(is_reason, TWINS.values())})


@pytest.mark.parametrize("module", MODULES)
def test_each_module_has_its_test_or_a_reason(module: str) -> None:
    folder = folder_of(module)
    tests = [path.name for path in modules_below(folder) if module in TESTED[path]]
    if module in UNTESTED:
        assert not tests, f"{module} has a test and needs no reason: {tests}"
    else:
        where = folder.relative_to(ROOT)
        assert tests, f"no test in {where} imports {module}, and no reason is given"


def test_reasons_are_of_modules_that_are_there() -> None:
    assert UNTESTED.keys() <= MODULES.keys()


@pytest.mark.parametrize("reason", REASONS)
def test_reasons_name_tests_that_are_there(reason: str) -> None:
    assert reason.strip()
    for name in re.findall(r"[\w/]+\.py", reason):
        assert (TESTS / name).is_file()


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
        used = [test.name for test in modules_below(TESTS) if twin in attributes(test)]
        assert used, f"no test compares {kernel} with {twin}"


def test_twins_are_of_kernels_that_are_there() -> None:
    assert {f"deltamesh._kernels.{name}" for name in TWINS} == set(KERNELS)


def test_each_test_module_says_what_it_tests() -> None:
    silent = [path.name for path in modules_below(TESTS) if not ast.get_docstring(tree_of(path))]
    assert not silent


def test_test_modules_have_different_names() -> None:
    """pytest imports them by their names alone."""
    names = [path.name for path in TESTS.rglob("*.py") if path.name != "conftest.py"]
    assert len(names) == len(set(names))
