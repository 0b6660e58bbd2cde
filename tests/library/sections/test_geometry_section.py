"""Geometry of a file, where positions could be beyond what a decoder computes with."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import pytest
from containers import CARTESIAN

from deltamesh import encode, info
from deltamesh._content import NOTHING
from deltamesh._geometry.integers import Integers
from deltamesh._geometry.interpolation import Interpolation
from deltamesh._mesh import LARGEST
from deltamesh._pipeline.decoder import read_content
from deltamesh._sections import geometry
from deltamesh._sections.trials import has_scale
from deltamesh_formats.errors import MeshError, SolveError


def test_the_section_gives_back_its_integers() -> None:
    container = info(encode(*meshes.torus(9, 7), method="refined", step=0.05))
    content = read_content(container, 2**40, 2**50)
    bare = replace(content, integers=NOTHING.integers)
    found = geometry.decode(container, bare).integers
    assert found.values.any()
    for name, array in vars(content.integers).items():
        np.testing.assert_array_equal(getattr(found, name), array)


ONES = np.ones((2, 3), dtype=np.int64)


@pytest.mark.parametrize("name", ["values", "positions", "isolated", "refinements", "corrections"])
def test_any_integer_times_the_step_has_to_be_small(name: str) -> None:
    none = Integers(0 * ONES, np.arange(2), 0 * ONES)
    integers = replace(none, **{name: -1000 * ONES})
    assert has_scale(replace(CARTESIAN, step=LARGEST / 100), integers)
    assert not has_scale(replace(CARTESIAN, step=LARGEST), integers)
    assert not has_scale(replace(CARTESIAN, step=1.0, anchor_step=LARGEST), integers)
    assert not has_scale(replace(CARTESIAN, coarse=1e3, step=LARGEST / 100), integers)


def test_the_origin_counts() -> None:
    integers = Integers(ONES)
    assert has_scale(replace(CARTESIAN, origin=(0.0, -LARGEST, 0.0)), integers)
    assert not has_scale(replace(CARTESIAN, origin=(0.0, -101 * LARGEST, 0.0)), integers)


def test_in_fine_steps_more_of_them_are_small() -> None:
    """Of a vertex with the finest step, 2^-30 of the coarsest; isolated vertices have that one."""
    exponents, far = np.array([0, 120]), np.array([[0, 0, 0], [0, 2**59, 0]])
    parameters = replace(CARTESIAN, step=LARGEST / 2**24, anchor_step=LARGEST / 2**24)
    for integers in (
        Integers(far, exponents=exponents),
        Integers(0 * ONES, np.arange(2), far, exponents=exponents),
        Integers(0 * ONES, corrections=far, exponents=exponents),
    ):
        assert has_scale(parameters, integers)
        assert not has_scale(parameters, replace(integers, exponents=exponents[::-1]))
    far = Integers(np.concatenate([far, far]), exponents=exponents)
    assert not has_scale(parameters, far)


def test_a_step_that_is_not_solved_does_not_end_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    V, F = meshes.icosphere(3)
    solve, steps = Interpolation.solve, []

    def second_fails(self, delta, positions, each, *others, **more):
        steps.append(float(np.max(each)))
        if len(set(steps)) == 2:
            raise SolveError("no solution")
        return solve(self, delta, positions, each, *others, **more)

    monkeypatch.setattr(Interpolation, "solve", second_fails)
    assert info(encode(V, F, method="refined", normal_error=0.5)).parameters.method == "refined"
    assert len(set(steps)) > 1
    steps[:] = [1.0]
    with pytest.raises(MeshError, match="no solution; try method cartesian"):
        encode(V, F, method="refined", step=0.01)


def test_nothing_is_in_doubt_where_nothing_is_solved() -> None:
    V, F = meshes.icosphere(1)
    flat = np.full_like(V, 7.0)
    found = info(encode(flat, F, method="refined", max_error_rel=1e-4))
    assert found.meta is not None
    assert found.meta.max < 1e-20
