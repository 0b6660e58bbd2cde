"""References in docstrings and comments: dotted names in backticks lead somewhere."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest
from places import ROOT

PACKAGES = {"deltamesh": "src", "deltamesh_formats": "formats", "deltamesh_cli": "cli"}
FILES = sorted(
    path for package, root in PACKAGES.items() for path in (ROOT / root / package).rglob("*.py")
)
DOTTED = re.compile(r"`([A-Za-z_]\w*(?:\.[A-Za-z_]\w*)+)`")
# Other libraries that docstrings name, as code does.
LIBRARIES = {"math", "meshio", "np", "numpy", "os", "trimesh"}


def module_of(path: Path) -> str:
    """The name of the module in a file."""
    parts = path.relative_to(ROOT).with_suffix("").parts[1:]
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def members(body: list[ast.stmt]) -> Iterator[tuple[str, ast.stmt]]:
    """The names that statements define or import, and the statements."""
    for node in body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node.name, node
        elif isinstance(node, ast.If | ast.Try | ast.With):
            yield from members(node.body)
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
                for name in ast.walk(target):
                    if isinstance(name, ast.Name):
                        yield name.id, node
        elif isinstance(node, ast.ImportFrom):
            for alias in node.names:
                yield alias.asname or alias.name, node


MODULES = {
    module_of(path): dict(members(ast.parse(path.read_text(encoding="utf-8")).body))
    for path in FILES
}
PACKAGE_MODULES = {module_of(path) for path in FILES if path.name == "__init__.py"}
# A module may be named by the last parts of its name.
ENDINGS: dict[str, list[str]] = {}
for module in MODULES:
    parts = module.split(".")
    for begin in range(len(parts)):
        ENDINGS.setdefault(".".join(parts[begin:]), []).append(module)


def references(source: str) -> Iterator[str]:
    """Dotted names in backticks, in the docstrings and comments of a module."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Module | ast.FunctionDef | ast.ClassDef):
            yield from DOTTED.findall(ast.get_docstring(node) or "")
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            yield from DOTTED.findall(token.string)


def is_defined(module: str, path: list[str]) -> bool:
    """Whether a module defines a name, or a class of it the name after that."""
    node = MODULES[module].get(path[0])
    if isinstance(node, ast.ImportFrom):
        return module in PACKAGE_MODULES and len(path) == 1  # a public name
    if len(path) == 1 or node is None:
        return node is not None
    return isinstance(node, ast.ClassDef) and path[1] in dict(members(node.body))


def leads_somewhere(reference: str, module: str) -> bool:
    """Whether a name in a module is that of a module, or is defined in one."""
    path = reference.split(".")
    node = MODULES[module].get(path[0])
    if isinstance(node, ast.ImportFrom):
        (name,) = (a.name for a in node.names if path[0] in (a.name, a.asname))
        imported = f"{node.module}.{name}"
        if imported in MODULES and is_defined(imported, path[1:]):
            return True
    for end in range(len(path), 0, -1):
        for found in ENDINGS.get(".".join(path[:end]), []):
            if end == len(path) or is_defined(found, path[end:]):
                return True
    return any(is_defined(each, path) for each in MODULES)


@pytest.mark.parametrize("path", FILES, ids=module_of)
def test_references_lead_somewhere(path: Path) -> None:
    found = set(references(path.read_text(encoding="utf-8")))
    stale = {name for name in found if not leads_somewhere(name, module_of(path))}
    assert {name for name in stale if name.partition(".")[0] not in LIBRARIES} == set()


@pytest.mark.parametrize(
    ("reference", "leads"),
    [
        ("topology.build_topology", True),
        ("deltamesh._kernels.coding.coder", True),
        ("PolyMesh.vertex_data", True),
        ("deltamesh.encode", True),
        ("topology.pair_halfedges", False),  # imported there, but defined elsewhere
        ("kernels.coding.coder", False),
        ("PolyMesh.colour", False),
    ],
)
def test_a_name_leads_to_its_definition(reference: str, leads: bool) -> None:
    source = f'"""About `{reference}`."""\n# And `{reference}`.\n'
    assert list(references(source)) == [reference, reference]
    assert leads_somewhere(reference, "deltamesh._shape.complexes") == leads
