"""Which takes fewer bytes for smooth attributes: differential coordinates or parallelograms.

Texture coordinates, and scalars that vary slowly, could be further right-hand sides of the
factorization that positions are solved with: quantized, L x and a few anchors. Or grid points that
parallelograms predict, as section ATTR has them. This codes an attribute in both ways, at many
steps, and prints the bytes at the same error: that of the grid of 8, 10, 12 bits. Usage:

    python benchmarks/smooth.py spot.obj pizza.obj horse.ply

Of a file with texture coordinates these are measured, of others the height of each vertex and the
length of its delta coordinates, which stands for curvature.
"""

from __future__ import annotations

import sys

import numpy as np
from numpy.typing import NDArray

from deltamesh._geometry import cartesian, highpass
from deltamesh._geometry.quantize import grid_step
from deltamesh._geometry.solve import factorization
from deltamesh._kernels.mesh import laplacian
from deltamesh._options import Settings
from deltamesh._shape import connectivity
from deltamesh._shape.draft import first_draft
from deltamesh._shape.surface import Surface, surface_of
from deltamesh_formats.meshfiles.files import read_mesh
from deltamesh_formats.polymesh.mesh import PolyMesh, from_triangles

BITS = (8, 10, 12)
STEPS = 2.0 ** np.arange(-14, 3.5, 0.5)  # of the deltas, in steps of the grid of 8 bits


def smooth_attributes(
    mesh: PolyMesh,
) -> dict[str, tuple[NDArray[np.int64], NDArray[np.float64]]]:
    """Return triangles, and values (n, 3) at what these are over, of each attribute by name."""
    cut = mesh.triangulation()
    uv = mesh.attribute("uv", "corner")
    if uv is not None:
        rows = uv.rows()[cut.corners]
        rows = rows[(rows >= 0).all(axis=1)]
        used, faces = np.unique(rows, return_inverse=True)
        return {"uv": (faces.reshape(-1, 3), _wide(uv.values[used]))}
    used, faces = np.unique(cut.faces, return_inverse=True)
    faces = faces.reshape(-1, 3)
    V = mesh.vertices[used]
    surface = surface_of(faces, len(V), 0)
    bent = np.linalg.norm(laplacian.apply(*surface.graph, V), axis=1)
    bent = np.log2(bent + 1e-3 * np.median(bent))
    return {"height": (faces, _wide(V[:, 2:])), "curvature": (faces, _wide(bent[:, None]))}


def _wide(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.pad(values.astype(np.float64), ((0, 0), (0, 3 - values.shape[1])))


def in_order(
    faces: NDArray[np.int64], values: NDArray[np.float64]
) -> tuple[Surface, NDArray[np.float64]]:
    """Return both in the order of the connectivity coder."""
    # Positions of no meaning, all different: nothing is welded.
    places = np.stack([np.arange(len(values)) * 1.0] * 3, axis=1)
    triangles = from_triangles(places, faces).triangulation()
    draft = first_draft(places, triangles, drop_isolated=False, exact=False)
    _, draft = connectivity.encode(draft)
    return draft.structure.surface, values[draft.triangle_provenance.points]


def coded(
    surface: Surface, values: NDArray[np.float64], settings: Settings
) -> tuple[int, float, float]:
    """Return the bytes, the largest error of a number and the RMS."""
    method = {"cartesian": cartesian, "highpass": highpass}[settings.method]
    factor = factorization(surface.graph)
    parameters, integers, found = method.quantize(surface, values, values[:0], settings, factor)
    size = sum(map(len, method.encode(surface, parameters, integers).values()))
    errors = found - values
    return size, float(np.abs(errors).max()), float(np.sqrt((errors**2).sum(axis=1).mean()))


def at_equal(curve: list[tuple[int, float, float]], which: int, error: float) -> float:
    """Return the bytes where a curve has an error, between two of its points."""
    points = sorted((point[which], point[0]) for point in curve)
    logs = np.log([e for e, _ in points])
    return float(np.exp(np.interp(np.log(error), logs, np.log([size for _, size in points]))))


def main(names: list[str]) -> None:
    """Print a line for each attribute and each number of bits."""
    print("file attribute rows bits | parallelograms | delta at equal max | at equal RMS")
    for name in names:
        for what, (faces, values) in smooth_attributes(read_mesh(name)).items():
            surface, values = in_order(faces, values)
            base = grid_step(values, BITS[0])
            curve = [
                coded(surface, values, Settings("highpass", step=float(base * s))) for s in STEPS
            ]
            for bits in BITS:
                size, largest, rms = coded(surface, values, Settings("cartesian", bits=bits))
                delta = at_equal(curve, 1, largest), at_equal(curve, 2, rms)
                print(
                    f"{name.rsplit('/', 1)[-1]} {what} {len(values)} {bits}"
                    f" | {size} | {delta[0]:.0f} | {delta[1]:.0f}",
                    flush=True,
                )


if __name__ == "__main__":
    main(sys.argv[1:])
