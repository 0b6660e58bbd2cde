"""Public names of the packages: lists that agree, types, pickles between processes."""

from __future__ import annotations

import ast
import importlib
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import deltamesh
import deltamesh.batch
import deltamesh.differential
from deltamesh_formats import errors
from deltamesh_formats.errors import DeltameshError, FormatError

PACKAGES = (deltamesh, deltamesh.batch, deltamesh.differential)
TRIANGLE = ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])


def imported_for_types(file: str) -> dict[str, str]:
    """Return the module of each name that a file imports `as` itself for type checkers."""
    found = {}
    for node in ast.walk(ast.parse(Path(file).read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            found |= {a.name: str(node.module) for a in node.names if a.asname == a.name}
    return found


@pytest.mark.parametrize("package", PACKAGES)
def test_names_are_those_that_type_checkers_see(package):
    homes = imported_for_types(package.__file__)
    assert package.__all__ == sorted(homes) == dir(package)
    for name, module in homes.items():
        assert getattr(package, name) is getattr(importlib.import_module(module), name)


@pytest.mark.parametrize("package", PACKAGES)
def test_other_names_are_refused(package):
    with pytest.raises(AttributeError, match=f"module '{package.__name__}' has no attribute 'no'"):
        package.no  # noqa: B018
    with pytest.raises(ImportError):
        exec(f"from {package.__name__} import nothing")


def test_all_names_can_be_imported_at_once():
    names: dict[str, object] = {}
    exec("from deltamesh import *", names)
    assert {*deltamesh.__all__} <= {*names}


def test_types_of_the_public_names_are_known(tmp_path):
    """What a strict type checker says of a program of a user, and of names that are not there."""
    pytest.importorskip("mypy")
    program = tmp_path / "program.py"
    program.write_text(
        "import deltamesh\n"
        "from deltamesh.batch import Task, run_here\n"
        "mesh: deltamesh.PolyMesh = deltamesh.decode(b'')\n"
        "data: bytes = deltamesh.encode(mesh, quality=8)\n"
        "tasks: list[Task] = []\n"
        "outcomes = run_here(tasks, lambda task: {'name': task.source})\n"
        "reveal_type(mesh.triangles)\n"
        "wrong: int = deltamesh.encode(mesh)\n"
        "deltamesh.nothing\n"
    )
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file=", str(program)]
    said = subprocess.run(command, capture_output=True, text=True, timeout=300).stdout
    faults = [line.partition("program.py:")[2] for line in said.splitlines()[:-1]]
    assert [fault.partition(":")[0] for fault in faults] == ["7", "8", "9"]
    assert "ndarray" in faults[0]
    assert '"bytes", variable has type "int"' in faults[1]
    assert 'no attribute "nothing"' in faults[2]


def test_errors_are_named_as_users_know_them():
    own = [one for one in vars(errors).values() if isinstance(one, type)]
    tree = [one for one in own if issubclass(one, DeltameshError)]
    assert len(tree) == 8
    for error in tree:
        assert error.__module__ == "deltamesh"
        assert getattr(deltamesh, error.__name__) is error


def test_pickles_are_read_by_another_process():
    mesh = deltamesh.from_arrays(*TRIANGLE, vertex={"T": [1, 2, 3]})
    error = FormatError("wrong", 7)
    code = (
        "import pickle, sys\n"
        "mesh, error = pickle.load(sys.stdin.buffer)\n"
        "error.add_note(str(mesh.vertex_data['T'].tolist()))\n"
        "sys.stdout.buffer.write(pickle.dumps((error, mesh)))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        input=pickle.dumps((mesh, error)),
        capture_output=True,
        timeout=100,
        check=True,
    )
    other, back = pickle.loads(done.stdout)
    assert (type(other), str(other), other.offset) == (FormatError, "wrong (at byte 7)", 7)
    assert other.__notes__ == ["[1, 2, 3]"]
    np.testing.assert_array_equal(back.vertices, mesh.vertices)


def test_pickles_of_the_module_of_the_errors_are_read():
    """Those that were written when the errors had the module that they are defined in."""
    old = b"cdeltamesh_formats.errors\nMeshError\n(S'empty'\ntR."
    error = pickle.loads(old)
    assert (type(error), str(error)) == (deltamesh.MeshError, "empty")
