"""Figures of docs/paper.md: the paper's, and of what it says without one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import paper_anchors
import paper_bases
import paper_edits
import paper_shapes
from paper_models import Floats, Model
from scenes import Look, Panel, Scale

from deltamesh import differential as dc
from deltamesh._mesh import TriangleMesh

_HORSE = Look((1, 0, 0.2), up=(0, 0, 1), focus=(0.5, 0.5, 0.4), height=0.88)
_HEAD = Look((1, 0, 0.2), up=(0, 0, 1), focus=(0.5, 0.8, 0.74), height=0.26)
_CAMEL = Look((0.6, 0.3, 1), focus=(0.5, 0.42, 0.5), height=0.85)
_SCREWDRIVER = Look((1, 0.4, 0.4), up=(0, 0, 1), focus=(0.5, 0.5, 0.4), height=1.1)
_BENT = Look((0, -1, 0), up=(0, 0, 1), focus=(1.5, 0.5, 0.36), height=1.25)
_TWISTED = Look((0.2, -1, 0.2), up=(0, 0, 1), focus=(0.5, 0.5, 0.39), height=1.25)
# Basis functions, of anchors on this side, and eigenvectors that are shown; how many approximate.
_FUNCTIONS, _EIGENVECTORS = (32, 152, 185), (5, 60, 150)
_MOST = 200


@dataclass(frozen=True)
class Figure:
    """A figure: what is drawn of which mesh, the pixels, and what colours mean."""

    mesh: str
    rows: Callable[[Model], list[list[Panel]]]
    size: tuple[int, int]
    scale: Scale | None = None


def _panel(
    m: Model,
    x: Floats,
    look: Look,
    text: str,
    values: Floats | None = None,
    points: Floats | None = None,
) -> Panel:
    mesh, frame = TriangleMesh(x, m.F), TriangleMesh(m.V, m.F)
    return Panel(mesh, frame, look, text, values, points)


def _few_bits(m: Model) -> list[list[Panel]]:
    size, x = paper_shapes.few_bits(m, 0.0)
    found = m.errors(x)
    distance = np.linalg.norm(x - m.V, axis=1) / m.diagonal
    text = f"7 bits, {size:,} bytes\nnormals {found.normal_deviation:.2f}°, rms {found.rms:.1e}"
    return [
        [
            _panel(m, m.V, _HORSE, f"original\n{len(m.V):,} vertices"),
            _panel(m, x, _HORSE, text),
            _panel(m, x, _HORSE, "distance,\nof the diagonal", distance),
        ]
    ]


def _hole(m: Model) -> list[list[Panel]]:
    inside, found, *_ = paper_shapes.hole(m)
    panels = [_panel(m, m.V, _CAMEL, f"original\nred: {inside.sum():,} vertices", 2.0 * inside - 1)]
    for name, (anchors, x) in found.items():
        text = f"no bits there; anchors\n{name}"
        panels.append(_panel(m, x, _CAMEL, text, points=x[anchors]))
    return [panels]


def _smooth(m: Model) -> list[list[Panel]]:
    zero, panels = np.zeros_like(m.V), [_panel(m, m.V, _CAMEL, f"original\n{len(m.V):,} vertices")]
    for part, is_fitted in ((0.01, False), (0.01, True), (0.05, False)):
        anchors = dc.greedy_anchors(m.L, m.V, round(part * len(m.V)))
        system = dc.LeastSquares(m.L, anchors)
        c = dc.fitted_positions(system, zero, m.V) if is_fitted else m.V[anchors]
        x = system.solve(zero, c)
        name = f"{len(anchors)} anchors{', fitted' if is_fitted else ''}"
        text = f"{name}\nrms {m.errors(x).rms:.1e}"
        panels.append(_panel(m, x, _CAMEL, text, points=x[anchors]))
    return [panels]


def _selection(m: Model) -> list[list[Panel]]:
    k = round(len(m.V) / paper_shapes.SPACING)
    panels = [_panel(m, m.V, _SCREWDRIVER, f"original\n{len(m.V):,} vertices")]
    for name, (_, x) in paper_shapes.selected(m, k).items():
        found = m.errors(x)
        text = f"{k:,} {name}\nrms {found.rms:.1e}, max {found.max:.1e}"
        panels.append(_panel(m, x, _SCREWDRIVER, text))
    return [panels]


def _rows(m: Model) -> list[list[Panel]]:
    _, found = paper_anchors.erased(m, 6)
    panels = [_panel(m, m.V, _HEAD, "original\n")]
    for name, x in found.items():
        text = f"6 bits, rows {name}\nnormals {m.errors(x).normal_deviation:.2f}°"
        panels.append(_panel(m, x, _HEAD, text))
    return [panels]


def _bases(m: Model) -> list[list[Panel]]:
    anchors = dc.greedy_anchors(m.L, m.V, _MOST)
    B = dc.basis_functions(dc.LeastSquares(m.L, anchors), _FUNCTIONS)
    _, U = dc.eigenvectors(m.L, max(_EIGENVECTORS) + 1)
    rows = []
    for name, numbers, columns in (
        ("f", _FUNCTIONS, B),
        ("eigenvector", _EIGENVECTORS, U[:, list(_EIGENVECTORS)]),
    ):
        row = []
        for i, column in zip(numbers, columns.T, strict=True):
            values = column / np.abs(column).max()
            row.append(_panel(m, m.V, _CAMEL, f"{name} {i}", values))
        rows.append(row)
    return rows


def _approximation(m: Model) -> list[list[Panel]]:
    found = dict(paper_bases.approximations(m))[_MOST]
    panels = [_panel(m, m.V, _CAMEL, f"original\n{len(m.V):,} vertices")]
    for name, (_, x) in found.items():
        errors = m.errors(x)
        text = f"{_MOST} {name}\nrms {errors.rms:.1e}, max {errors.max:.1e}"
        panels.append(_panel(m, x, _CAMEL, text))
    return [panels]


def _edits(m: Model) -> list[list[Panel]]:
    rows = []
    for name, look in zip(paper_edits.EDITS, (_BENT, _TWISTED), strict=True):
        handles, found, _ = paper_edits.edited(m, name)
        row = [_panel(m, m.V, look, f"to be {name}\nred: handles", points=m.V[handles])]
        for scheme, x in found.items():
            text = f"{scheme}\ndihedral {m.errors(x).dihedral:.2f}°"
            row.append(_panel(m, x, look, text))
        rows.append(row)
    return rows


_SIGNED = Scale("", -1, 1)
FIGURES: Mapping[str, Figure] = {
    "few_bits": Figure("horse", _few_bits, (960, 330), Scale("", 2e-5, 2e-3)),
    "hole": Figure("camelhead", _hole, (960, 270), _SIGNED),
    "smooth": Figure("camelhead", _smooth, (960, 270)),
    "selection": Figure("screwdriver x 4", _selection, (960, 400)),
    "rows": Figure("horse", _rows, (720, 270)),
    "bases": Figure("camelhead", _bases, (720, 480), _SIGNED),
    "approximation": Figure("camelhead", _approximation, (960, 270)),
    "edits": Figure("fine bar", _edits, (960, 520)),
}
