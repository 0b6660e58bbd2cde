"""Picture of docs/anchors.md: a surface around its anchors, without the fit and with it."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import corpus
import numpy as np
from anchored import STEPS, coded
from scenes import Look, Panel, draw, save

from deltamesh._measures.metrics import diagonal
from deltamesh._mesh import TriangleMesh
from deltamesh._options import Options

# The mesh that has the largest spikes without the fit.
WORST: Final = "sphere"


def draw_worst(path: Path) -> None:
    """Draw the worst mesh around the anchor that errs most, and the original beside it."""
    mesh = corpus.bare(WORST)
    one = coded(mesh, Options(method="refined", step=diagonal(mesh.vertices) / STEPS))
    F, anchors = one.surface.faces, one.integers.anchors
    original = TriangleMesh(one.V, F)
    look = onto(original, anchors[np.argmax(one.errors(one.decoded)[anchors])])
    row = [Panel(original, original, look, "original", points=one.V[anchors])]
    for text, file in {"without a fit": one.copied, "fitted": one}.items():
        row.append(Panel(TriangleMesh(file.decoded, F), original, look, text))
    save(draw([row], (1080, 340), None), path)


def onto(mesh: TriangleMesh, vertex: int) -> Look:
    """Return a look at the half of a mesh around a vertex, from beside it."""
    V = mesh.vertices
    out = V[vertex] - V.mean(axis=0)
    beside = np.cross(out, np.roll(out, 1))
    beside *= np.linalg.norm(out) / np.linalg.norm(beside)
    focus = (V.mean(axis=0) + 0.7 * out - V.min(axis=0)) / np.ptp(V, axis=0)
    towards, up, at = (tuple(map(float, x)) for x in (0.8 * out + beside, out, focus))
    return Look(towards, up, at, height=0.5)
