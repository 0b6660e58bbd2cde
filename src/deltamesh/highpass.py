"""The high-pass method: quantized delta coordinates and anchors.

O. Sorkine, D. Cohen-Or, S. Toledo, "High-Pass Quantization for Mesh Encoding", SGP 2003;
D. Cohen-Or, O. Sorkine, "Encoding Meshes in Differential Coordinates", SCCG 2006. The encoder's
functions and the decoder's are mirrors: quantize / reconstruct, write / read.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from deltamesh import anchors as choice
from deltamesh import entropy
from deltamesh.geometry import Integers, Surface, payload_of
from deltamesh.kernels import delta as delta_kernels
from deltamesh.kernels import points, residual
from deltamesh.laplacian import adjacency_labels, adjacency_laplacian
from deltamesh.metrics import diagonal
from deltamesh.options import (
    DEAD_ZONE,
    DEFAULT_COARSE,
    DEFAULT_HIGHPASS_STEP,
    NORMAL_DEAD_ZONE,
    Options,
)
from deltamesh.quantize import delta_step, from_grid, quantize_delta, to_delta, to_grid
from deltamesh.solve import LeastSquares
from deltamesh_formats.errors import FormatError, OptionError
from deltamesh_formats.layout import Parameters, Section
from deltamesh_formats.reader import take

# The grid of the anchors is that much finer than the step of the deltas: with diffusion, the
# error of the surface between anchors is about a fifth of that step, and theirs should not show.
ANCHOR_REFINEMENT = 8
# ... and at least as fine as that fraction of the longest side, which alone counts for 0 bits.
ANCHOR_GRID_BITS = 16
MAX_GRID_BITS = 30


def quantize(
    surface: Surface,
    vertices: NDArray[np.float64],
    isolated: NDArray[np.float64],
    options: Options,
) -> tuple[Parameters, Integers]:
    """Choose steps and anchors, and round.

    Parameters
    ----------
    surface : Surface
    vertices, isolated : float64 (n, 3), (i, 3)
        Positions of the vertices of the faces in coding order, and of the others by x.
    options : Options

    Raises
    ------
    MeshError, OptionError, SolveError
    """
    n = surface.vertex_count
    L = adjacency_laplacian(*surface.graph)
    delta = L @ vertices
    step = _step(vertices, delta, options)
    values = np.zeros((n, 3), dtype=np.int64)
    refined = options.method == "refined"
    coarse, zone = (options.coarse or DEFAULT_COARSE, DEAD_ZONE) if refined else (1.0, 0.0)
    if step:
        values = quantize_delta(delta, surface.graph, coarse * step, options.diffusion, zone)
    everything = np.concatenate([vertices, isolated])
    origin, fine = everything.min(axis=0), _anchor_step(everything, step)
    grid, isolated_grid = to_grid(vertices, origin, fine), to_grid(isolated, origin, fine)
    anchored = from_grid(grid, origin, fine)
    anchors = _choose(surface, L, vertices, to_delta(values, coarse * step), anchored, options)
    parameters = Parameters(
        method=options.method,
        diffusion=options.diffusion,
        anchor_method=options.anchor_method,
        bits=options.bits,
        step=step,
        origin=(float(origin[0]), float(origin[1]), float(origin[2])),
        anchor_step=fine,
        seed=options.seed,
        anchor_count=len(anchors),
        isolated=surface.isolated_count,
        coarse=coarse,
        dead_zone=zone,
        normal_dead_zone=NORMAL_DEAD_ZONE if refined else 0.0,
    )
    return parameters, Integers(values, anchors, grid[anchors], isolated_grid)


def reconstruct(
    surface: Surface,
    parameters: Parameters,
    integers: Integers,
    solver: str,
    threads: int | None,
) -> NDArray[np.float64]:
    """Solve [L; S] x = [delta'; c] in the least-squares sense; isolated vertices come last.

    Raises
    ------
    SolveError
    """
    system = LeastSquares(adjacency_laplacian(*surface.graph), integers.anchors, solver, threads)
    vertices = system.solve(deltas(parameters, integers), anchor_positions(parameters, integers))
    return with_isolated(vertices, parameters, integers)


def deltas(parameters: Parameters, integers: Integers) -> NDArray[np.float64]:
    """Return the delta coordinates as they were quantized, before any refinement."""
    return to_delta(integers.values, parameters.coarse * parameters.step)


def anchor_positions(parameters: Parameters, integers: Integers) -> NDArray[np.float64]:
    """Return the positions of the anchors."""
    return from_grid(integers.positions, np.array(parameters.origin), parameters.anchor_step)


def with_isolated(
    vertices: NDArray[np.float64], parameters: Parameters, integers: Integers
) -> NDArray[np.float64]:
    """Return the vertices of the faces, then the isolated ones."""
    isolated = from_grid(integers.isolated, np.array(parameters.origin), parameters.anchor_step)
    return np.concatenate([vertices, isolated])


def _step(vertices: NDArray[np.float64], delta: NDArray[np.float64], options: Options) -> float:
    """Return the quantization step that the options ask for, 0 for 0 bits."""
    if options.bits is not None:
        return delta_step(delta, options.bits) if options.bits else 0.0
    return options.step or DEFAULT_HIGHPASS_STEP * diagonal(vertices) or 1.0


def _anchor_step(vertices: NDArray[np.float64], step: float) -> float:
    """Return the step of the grid of the anchors."""
    extent = float(np.ptp(vertices, axis=0).max())
    coarsest = extent / 2.0**ANCHOR_GRID_BITS or 1.0
    finest = extent / 2.0 ** (MAX_GRID_BITS - 1)
    return max(min(coarsest, step / ANCHOR_REFINEMENT if step else coarsest), finest)


def _choose(
    surface: Surface,
    L: sparse.csr_array,
    vertices: NDArray[np.float64],
    delta: NDArray[np.float64],
    anchored: NDArray[np.float64],
    options: Options,
) -> NDArray[np.int64]:
    """Return the anchors that the options ask for, ascending where their indices are stored."""
    labels = adjacency_labels(*surface.graph)
    components = int(labels.max(initial=-1)) + 1
    try:
        k = choice.count_anchors(options.anchors, surface.vertex_count, components)
    except ValueError as error:
        raise OptionError(str(error)) from None
    if options.anchor_method == "greedy":
        solver, threads = options.solver, options.threads
        return np.sort(choice.greedy(L, vertices, delta, k, anchored, solver, threads))
    return _computed(surface, labels, options.anchor_method, k, options.seed)


def _computed(
    surface: Surface, labels: NDArray[np.int64], method: str, k: int, seed: int
) -> NDArray[np.int64]:
    """Return the anchors that follow from connectivity and seed."""
    if method == "random":
        return choice.random(labels, k, seed)
    return choice.farthest(*surface.graph, labels, k)


def write(surface: Surface, parameters: Parameters, integers: Integers) -> dict[str, bytes]:
    """Return the payloads of ANCH and DELT."""
    return {
        "ANCH": _write_anchors(surface, parameters, integers),
        "DELT": _write_deltas(surface, parameters, integers.values),
    }


def read(surface: Surface, parameters: Parameters, sections: Mapping[str, Section]) -> Integers:
    """Return the integers: the mirror of `write`.

    Raises
    ------
    FormatError
    """
    with payload_of(sections["ANCH"]) as payload:
        anchors, positions, isolated = _read_anchors(surface, parameters, payload)
    with payload_of(sections["DELT"]) as payload:
        values = _read_deltas(surface, parameters, payload)
    return Integers(values, anchors, positions, isolated)


def _write_anchors(surface: Surface, parameters: Parameters, integers: Integers) -> bytes:
    both = np.concatenate([integers.positions, integers.isolated])
    bits = [int(size).bit_length() for size in both.max(axis=0, initial=0)]
    coder = entropy.encoder(len(both), points.SLOTS, points.MIXERS)
    if parameters.anchor_method == "greedy":
        points.code_gaps(coder, integers.anchors.copy(), surface.vertex_count)
    points.code_points(coder, integers.positions.copy(), np.array(bits))
    if len(integers.isolated):  # most meshes have none, and need not wait for this kernel
        points.code_sorted_points(coder, integers.isolated.copy(), np.array(bits))
    return bytes(bits) + entropy.finish(coder)


def _read_anchors(
    surface: Surface, parameters: Parameters, payload: memoryview
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    bits = np.array(take(payload, 0, 3), dtype=np.int64)
    if bits.max() > MAX_GRID_BITS:
        raise FormatError(f"a grid of more than {MAX_GRID_BITS} bits", int(np.argmax(bits)))
    coder = entropy.decoder(payload[3:], points.SLOTS, points.MIXERS)
    k, n = parameters.anchor_count, surface.vertex_count
    anchors = np.zeros(k, dtype=np.int64)
    positions = np.zeros((k, 3), dtype=np.int64)
    isolated = np.zeros((surface.isolated_count, 3), dtype=np.int64)
    labels = adjacency_labels(*surface.graph)
    if parameters.anchor_method == "greedy":
        if not points.code_gaps(coder, anchors, n):
            raise FormatError("an anchor that is no vertex", 3)
    else:
        anchors = _computed(surface, labels, str(parameters.anchor_method), k, parameters.seed)
    if len(np.unique(labels[anchors])) <= labels.max(initial=-1) or len(anchors) != k:
        raise FormatError("a component without an anchor", 3)
    points.code_points(coder, positions, bits)
    if len(isolated) and not points.code_sorted_points(coder, isolated, bits):
        raise FormatError("an isolated vertex outside the grid", 3)
    entropy.check_end(coder, 3)
    return anchors, positions, isolated


def _write_deltas(surface: Surface, parameters: Parameters, values: NDArray[np.int64]) -> bytes:
    if not parameters.step:
        return b""
    coder = entropy.encoder(len(values), residual.SLOTS, residual.MIXERS)
    delta_kernels.code_deltas(coder, *surface.graph, values.copy())
    return entropy.finish(coder)


def _read_deltas(
    surface: Surface, parameters: Parameters, payload: memoryview
) -> NDArray[np.int64]:
    values = np.zeros((surface.vertex_count, 3), dtype=np.int64)
    if not parameters.step:
        if len(payload):
            raise FormatError("deltas in a file of 0 bits", 0)
        return values
    coder = entropy.decoder(payload, residual.SLOTS, residual.MIXERS)
    delta_kernels.code_deltas(coder, *surface.graph, values)
    entropy.check_end(coder, 0)
    return values
