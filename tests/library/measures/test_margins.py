"""Margins: the largest that adds a small share to each error, and keeps the bounds."""

from __future__ import annotations

import math

import meshes
import numpy as np
import pytest

from deltamesh._measures.margins import MOST_HALVINGS, SHARE, margin_of
from deltamesh._measures.measure import Measure
from deltamesh._measures.metrics import diagonal
from deltamesh._measures.parts import parts_of
from deltamesh_formats.meshfiles.number_text import rounded

V, F = meshes.torus(12, 8)
SCALE = diagonal(V)
MEASURE = Measure(V, F, parts_of(F, np.zeros(len(V), dtype=np.int64)))


def moved(by: float) -> np.ndarray:
    return V + by * np.random.default_rng(3).normal(size=V.shape)


@pytest.mark.parametrize("by", [1e-1, 1e-3, 1e-6])
def test_a_margin_adds_a_share_at_most(by: float) -> None:
    W = moved(by)
    before = MEASURE(W)
    halvings = margin_of(MEASURE, before, W, SCALE, lambda _: True)
    margin = SCALE * 2.0**-halvings
    share = SHARE * before.errors.rms / math.sqrt(3)
    assert share / 64 < margin <= share
    after = MEASURE(rounded(W, margin)).errors
    assert after.rms <= (1 + SHARE) * before.errors.rms
    assert after.max <= (1 + SHARE) * before.errors.max
    assert after.normal_deviation <= 1.01 * before.errors.normal_deviation + 0.002
    assert after.dihedral <= 1.01 * before.errors.dihedral + 0.002


def test_a_margin_keeps_bounds_that_are_near() -> None:
    W = moved(1e-3)
    before = MEASURE(W)
    free = margin_of(MEASURE, before, W, SCALE, lambda _: True)
    bound = before.errors.max * (1 + 1e-5)
    near = margin_of(MEASURE, before, W, SCALE, lambda most: most.errors.max <= bound)
    assert free < near <= MOST_HALVINGS
    assert before.errors.max + math.sqrt(3) * SCALE * 2.0**-near <= bound
    assert margin_of(MEASURE, before, W, SCALE, lambda _: False) == 0


def test_the_least_margin_is_that_of_decoders() -> None:
    found = margin_of(MEASURE, MEASURE(V), V, SCALE, lambda _: True)
    assert found == MOST_HALVINGS
    assert margin_of(MEASURE, MEASURE(V), V, 0.0, lambda _: True) == 0


def test_faces_that_are_lines_do_not_cost_all_digits() -> None:
    """Their normals turn however little they are moved."""
    W = V.copy()
    W[F[0]] = W[F[0]].mean(axis=0) + np.outer([0.0, 1.0, 2.0], [0.0123, 0.0345, 0.0567])
    halvings = margin_of(MEASURE, MEASURE(W), W, SCALE, lambda _: True)
    assert 0 < halvings < MOST_HALVINGS
