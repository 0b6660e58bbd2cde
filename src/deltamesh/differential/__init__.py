"""Differential coordinates of meshes, for research: what the codec is made of, on arrays.

Laplacians and deltas; the least-squares system with soft and hard anchors, and Poisson's problem;
choice of anchors, their basis functions, and positions fitted to them; rotations; spectra;
quantization; and the metrics. Each is a function of arrays, or a system that is factored once, and
is what `encode` and `decode` use, too. The paper behind them is D. Cohen-Or, O. Sorkine, "Encoding
Meshes in Differential Coordinates", SCCG 2006. `docs/research.md` is a guide; `docs/paper.md` has
the paper's statements, measured. A name is imported when it is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from deltamesh._measures.metrics import VertexErrors as VertexErrors
    from deltamesh.differential._choice import (
        farthest_anchors as farthest_anchors,
        greedy_anchors as greedy_anchors,
        random_anchors as random_anchors,
    )
    from deltamesh.differential._graphs import (
        components as components,
        deltas as deltas,
        laplacian as laplacian,
    )
    from deltamesh.differential._metrics import (
        diagonal as diagonal,
        vertex_errors as vertex_errors,
    )
    from deltamesh.differential._quantization import (
        coded_size as coded_size,
        quantized_deltas as quantized_deltas,
        quantized_positions as quantized_positions,
        step_of as step_of,
    )
    from deltamesh.differential._spectra import (
        eigenvectors as eigenvectors,
        energies as energies,
        spectral_slope as spectral_slope,
    )
    from deltamesh.differential._systems import (
        LeastSquares as LeastSquares,
        Poisson as Poisson,
        basis_functions as basis_functions,
        fitted_positions as fitted_positions,
    )
    from deltamesh.differential._turning import (
        fitted_rotations as fitted_rotations,
        nearest_rotations as nearest_rotations,
        turned_deltas as turned_deltas,
    )
else:
    from deltamesh._lazy import lazy_names

    __getattr__, __dir__, __all__ = lazy_names(
        __name__,
        {
            "deltamesh._measures.metrics": ("VertexErrors",),
            "deltamesh.differential._choice": (
                "farthest_anchors",
                "greedy_anchors",
                "random_anchors",
            ),
            "deltamesh.differential._graphs": ("components", "deltas", "laplacian"),
            "deltamesh.differential._metrics": ("diagonal", "vertex_errors"),
            "deltamesh.differential._quantization": (
                "coded_size",
                "quantized_deltas",
                "quantized_positions",
                "step_of",
            ),
            "deltamesh.differential._spectra": ("eigenvectors", "energies", "spectral_slope"),
            "deltamesh.differential._systems": (
                "LeastSquares",
                "Poisson",
                "basis_functions",
                "fitted_positions",
            ),
            "deltamesh.differential._turning": (
                "fitted_rotations",
                "nearest_rotations",
                "turned_deltas",
            ),
        },
    )
