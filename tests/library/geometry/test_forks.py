"""The codec in forked processes, which have the memory of their parent but not its threads."""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path

import children
import forking
import pytest

from deltamesh._geometry import rslab_loading, solvers
from deltamesh_formats.errors import SolveError

pytestmark = [
    pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork"),
    pytest.mark.skipif(not importlib.util.find_spec("rslab"), reason="rslab is not installed"),
]


# One of a fork after, one of a fork before rslab was loaded.
QUICK = ("after_decode", "before_decode")


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[pytest.mark.slow] * (n not in QUICK)) for n in forking.PROGRAMS],
)
def test_every_process_decodes(name: str) -> None:
    program = Path(forking.__file__)
    done = children.run([sys.executable, program, name], text=True, seconds=120)
    assert done.returncode == 0, done.stderr


def test_rslab_of_a_parent_is_not_used(monkeypatch: pytest.MonkeyPatch) -> None:
    assert not rslab_loading.is_inherited()
    assert solvers.solver_name("auto") == solvers.solver_name("rslab") == "rslab"
    monkeypatch.setattr(rslab_loading, "_inherited", True)
    assert solvers.solver_name("auto") == "scipy"
    with pytest.raises(SolveError, match="forked from one that has loaded it"):
        solvers.solver_name("rslab")
