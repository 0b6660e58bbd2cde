"""Curves of docs/paper.md: the spectrum of the error, and approximation by bases."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import paper_bases
import paper_spectra
from paper_models import Floats, model
from scenes import save

from deltamesh import differential as dc

SPECTRUM, BASES = "torus", "camelhead"
# Groups of as many eigenvalues, whose mean energies are drawn.
_GROUPS = 60


def spectra() -> dict[str, tuple[Floats, Floats]]:
    """Return eigenvalues and relative energies of the error, by what is quantized."""
    m = model(SPECTRUM)
    values, U = m.spectrum
    groups = np.array_split(np.arange(1, len(values)), _GROUPS)
    found = {}
    for name, error in paper_spectra.errors(m).items():
        energy = dc.energies(U, error)
        slope = dc.spectral_slope(values, energy)
        means = [np.exp(np.log(one[g]).mean()) for one in (values, energy) for g in groups]
        x, y = np.array(means).reshape(2, -1)
        found[f"{name}: slope {slope:.1f}"] = x, y / y.max()
    return found


def approximations() -> dict[str, Floats]:
    """Return the RMS errors of the bases, by name."""
    m, found = model(BASES), {}
    for _, each in paper_bases.approximations(m):
        for name, (_, x) in each.items():
            found.setdefault(name, []).append(m.errors(x).rms)
    return {name: np.array(one) for name, one in found.items()}


def draw(path: Path) -> None:
    """Draw both, side by side."""
    import matplotlib.figure
    from PIL import Image

    figure = matplotlib.figure.Figure(figsize=(8.4, 3.4), dpi=100, layout="constrained")
    left, right = figure.subplots(1, 2)
    for name, (x, y) in spectra().items():
        left.loglog(x, y, ".-", label=name, linewidth=0.8, markersize=4)
    left.set(title=f"error, {SPECTRUM}", xlabel="eigenvalue of L", ylabel="energy")
    for name, rms in approximations().items():
        right.loglog(paper_bases.COUNTS, rms, "o-", label=name, linewidth=1, markersize=4)
    right.set(title=f"approximation, {BASES}", xlabel="functions", ylabel="RMS / diagonal")
    right.set_xticks(paper_bases.COUNTS, [str(one) for one in paper_bases.COUNTS])
    right.minorticks_off()
    for axes in (left, right):
        axes.legend(fontsize=8)
        axes.grid(alpha=0.3)
    with io.BytesIO() as file:
        figure.savefig(file)
        save(Image.open(file).convert("RGB"), path)
