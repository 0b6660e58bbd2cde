"""Spectrum of the error, and smoothness of eigenvectors: section 2.3 of the paper."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from paper_models import Floats, Model
from paper_tables import Row, Table, share

from deltamesh import differential as dc

# Steps of the deltas in the diagonal.
STEPS = 500
# Eigenvectors of which edges are counted, and the last.
MODES = (1, 10, 100)


def errors(m: Model) -> dict[str, Floats]:
    """Return what each quantization does to positions, less its mean, float64 (n, 3)."""
    step, system = m.diagonal / STEPS, dc.LeastSquares(m.L, [0])
    found = {
        name: system.solve(m.quantized(step, diffusion), m.V[[0]])
        for name, diffusion in (("deltas, plain", 0.0), ("deltas, diffused", 1.0))
    }
    found["Cartesian, 10 bits"] = dc.quantized_positions(m.V, 10)
    return {name: x - m.V - (x - m.V).mean(axis=0) for name, x in found.items()}


def _spectrum(m: Model) -> Iterator[Row]:
    values, U = m.spectrum
    for name, error in errors(m).items():
        energy = dc.energies(U, error)
        low = [energy[1 : len(m.V) // part].sum() / energy[1:].sum() for part in (100, 10)]
        yield name, *map(share, low), f"{dc.spectral_slope(values, energy):.2f}"


def _modes(m: Model) -> Iterator[Row]:
    _, U = m.spectrum
    tail, head = U[m.edges[:, 0]], U[m.edges[:, 1]]
    changes = (np.sign(tail) != np.sign(head)).mean(axis=0)
    yield tuple(f"{100 * changes[i]:.0f} %" for i in (*MODES, -1))


TABLES = (
    Table(
        "spectrum",
        ("mesh", "quantized", "in the lowest 1 %", "in the lowest 10 %", "slope"),
        _spectrum,
        ("ball",),
        ("torus",),
    ),
    Table(
        "modes",
        ("mesh", *(f"eigenvector {i}" for i in MODES), "the last"),
        _modes,
        ("ball",),
        ("torus",),
    ),
)
