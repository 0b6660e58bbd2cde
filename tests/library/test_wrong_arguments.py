"""Wrong arguments of every public function: a clear error that names each."""

from __future__ import annotations

import inspect
import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

import deltamesh
from deltamesh import DeltameshError, PolyMesh, differential
from deltamesh._options import EncodeOptions
from deltamesh._page.filling import PAGE

# Of a wrong type, whatever the argument means.
TEXT, NOTHING = "a", object()
TYPES: tuple[Any, ...] = (NOTHING, [1, 2], {1: 2}, np.zeros(0), b"x")
NUMBERS: tuple[Any, ...] = (*TYPES, TEXT, True, float("nan"))
WHOLE: tuple[Any, ...] = (*NUMBERS, 2.5, float("inf"), -1)
COUNT = (*WHOLE, 0)
POSITIVE = (*NUMBERS, float("inf"), 0, -1)
LIMIT = (*NUMBERS, -1)
WORDS = (*TYPES, TEXT, 3)
TEXTS = (NOTHING, [1, 2], np.zeros(0), 3)
FLAGS = (*TYPES, TEXT, 3, None)
ROWS: tuple[Any, ...] = (NOTHING, TEXT, 3, [[1], [1, 2]], np.full((4, 3), np.nan), [[1j] * 3] * 4)
MAPPINGS = (NOTHING, [1, 2], TEXT, 3)
PATHS = (NOTHING, [1, 2], 2.5)
CALLABLES = (*TYPES, TEXT, 3)

GRID = np.mgrid[0:4, 0:4].reshape(2, 16).T
CORNER = np.array([4 * i + j for i in range(3) for j in range(3)])[:, None]
FACES = np.concatenate([CORNER + np.array(steps) for steps in ([0, 4, 5], [0, 5, 1])])
HEIGHTS = np.sin(GRID[:, :1]) + np.cos(2 * GRID[:, 1:])
V = np.concatenate([GRID, HEIGHTS], axis=1)
N = len(V)
MESH = deltamesh.from_arrays(V, FACES)
DATA = deltamesh.encode(MESH, method="refined", bits=8)
L = differential.laplacian(FACES, N)
SYSTEM, POISSON = differential.LeastSquares(L, [0, 15]), differential.Poisson(L, [0, 15])
VALUES, VECTORS = differential.eigenvectors(L)
DECODING = {
    "solver": WORDS,
    "threads": (*COUNT, 1 << 20),
    "max_vertices": LIMIT,
    "memory": LIMIT,
    "progress": CALLABLES,
}
LAPLACIAN = (NOTHING, TEXT, 3, np.eye(3), [[1, 2]])


@dataclass(frozen=True)
class Case:
    """A function, arguments that are right, and of each argument some that are wrong.

    Messages have the name of the argument, or a word of `words`.
    """

    run: Callable[..., object]
    right: Mapping[str, Any]
    wrong: Mapping[str, tuple[Any, ...]]
    words: Mapping[str, str] = field(default_factory=dict)


ENCODING: Mapping[str, tuple[Any, ...]] = {
    **dict.fromkeys(("method", "solver"), WORDS),
    **dict.fromkeys(("anchor_method", "solution"), WORDS),
    **dict.fromkeys(("bits", "bits_float"), (*WHOLE, 99)),
    **dict.fromkeys(("quality", "effort", "bits_uv", "bits_normal", "key_every"), (*COUNT, 999)),
    **dict.fromkeys(
        (
            "step",
            "normal_error",
            "dihedral_error",
            "rms_error",
            "rms_error_rel",
            "max_error",
            "max_error_rel",
            "max_uv_error",
            "fps",
        ),
        POSITIVE,
    ),
    **dict.fromkeys(
        ("only", "diffusion", "drop_isolated", "keep_order", "lossless_attributes"), FLAGS
    ),
    "anchors": (*NUMBERS, 0, -1, 1.5),
    "seed": (*WHOLE, 1 << 64),
    "coarse": (*NUMBERS, 0.5, 65),
    "threads": DECODING["threads"],
    "drop": (NOTHING, [1, 2], 3),
    "max_attribute_error": (*MAPPINGS, {"uv": 0}, {"uv": TEXT}, {3: 1.0}),
    "importance": (NOTHING, 3, [1, 2], [TEXT] * N),
    "source_format": TEXTS,
    "progress": CALLABLES,
}
MOVES = [([0], [0.0, 0.0, 1.0])]
CASES: Mapping[str, Case] = {
    "encode": Case(
        deltamesh.encode,
        {"mesh": MESH},
        {**ENCODING, "mesh": (NOTHING, TEXT, 3), "faces": (V,)},
        {"mesh": "without faces|vertices"},
    ),
    "decode": Case(
        deltamesh.decode,
        {"data": DATA},
        {
            **DECODING,
            "data": (NOTHING, TEXT, 3),
            "frame": (*WHOLE, 1),
            "pose": (NOTHING, TEXT, 3),
            "partial": FLAGS,
        },
        {"data": "bytes are needed"},
    ),
    "load": Case(
        lambda source=None, **keywords: deltamesh.load(source or io.BytesIO(DATA), **keywords),
        {},
        {
            **DECODING,
            "source": PATHS,
            "frame": (*WHOLE, 1),
            "pose": (NOTHING, TEXT, 3),
            "partial": FLAGS,
        },
        {"source": "a path or a binary file is needed"},
    ),
    "info": Case(
        deltamesh.info,
        {"source": DATA},
        {"source": PATHS, "partial": FLAGS},
        {"source": "a path, a binary file or bytes are needed"},
    ),
    "verify": Case(
        deltamesh.verify,
        {"source": DATA},
        {**DECODING, "source": PATHS},
        {"source": "a path, a binary file or bytes are needed"},
    ),
    "frames": Case(
        lambda **keywords: list(deltamesh.frames(**keywords)),
        {"source": DATA},
        {**DECODING, "source": PATHS},
        {"source": "a path, a binary file or bytes are needed"},
    ),
    "stages": Case(
        lambda stream=None, **limits: list(deltamesh.stages(stream or io.BytesIO(DATA), **limits)),
        {},
        {
            **{name: wrong for name, wrong in DECODING.items() if name != "progress"},
            "stream": (*PATHS, TEXT),
        },
        {"stream": "a binary file is needed"},
    ),
    "save": Case(
        lambda target=None, mesh=MESH: deltamesh.save(target or io.BytesIO(), mesh),
        {},
        {"target": PATHS, "mesh": (NOTHING, TEXT, 3)},
        {"target": "a path or a binary file is needed", "mesh": "without faces"},
    ),
    "edit": Case(
        deltamesh.edit,
        {"source": DATA, "moves": MOVES, "fix": [[15]], "name": "up"},
        {
            **DECODING,
            "source": PATHS,
            "moves": (NOTHING, TEXT, 3, [3], [TEXT], [(0, 1, 2)], []),
            "fix": (NOTHING, TEXT, 3, [2.5]),
            "name": (*TEXTS, ""),
            "step": POSITIVE,
        },
        {
            "source": "a path, a binary file or bytes are needed",
            "moves": "move",
            "fix": "fix|vertices are indices",
        },
    ),
    "remove_poses": Case(
        deltamesh.remove_poses,
        {"source": DATA, "names": ()},
        {
            **{name: DECODING[name] for name in ("max_vertices", "memory", "progress")},
            "source": PATHS,
            "names": (NOTHING, TEXT, 3, [3]),
        },
        {"source": "a path, a binary file or bytes are needed", "names": "names|no pose"},
    ),
    "view": Case(
        deltamesh.view,
        {"mesh": MESH},
        {"mesh": (NOTHING, TEXT, 3), "original": (NOTHING, TEXT, 3), "title": TEXTS},
        {"mesh": "bytes are needed", "original": "bytes are needed"},
    ),
    "from_arrays": Case(
        deltamesh.from_arrays,
        {"vertices": V, "faces": FACES},
        {
            "vertices": (NOTHING, TEXT, 3),
            "faces": (NOTHING, TEXT, 3),
            "vertex": MAPPINGS,
            "corner": MAPPINGS,
            "face": MAPPINGS,
        },
        {"faces": "face"},
    ),
    "read_mesh": Case(
        deltamesh.read_mesh,
        {"source": io.BytesIO(), "file_format": "ply"},
        {"source": PATHS, "file_format": TEXTS, "folder": (NOTHING, [1, 2], 3)},
        {"source": "a path or a binary file is needed"},
    ),
    "write_mesh": Case(
        lambda target=None, **keywords: deltamesh.write_mesh(target or io.BytesIO(), **keywords),
        {"mesh": MESH, "file_format": "ply"},
        {
            "target": PATHS,
            "mesh": (NOTHING, TEXT, 3),
            "file_format": TEXTS,
            "digits": (*WHOLE, 21),
        },
        {"target": "a path or a binary file is needed"},
    ),
    "laplacian": Case(
        differential.laplacian,
        {"faces": FACES, "count": N},
        {"faces": (NOTHING, TEXT, 3, [[0.5, 1, 2]]), "count": (*WHOLE, 0)},
        {"faces": "face", "count": "count|a face names a vertex"},
    ),
    "deltas": Case(
        differential.deltas, {"L": L, "vertices": V}, {"L": LAPLACIAN, "vertices": ROWS}
    ),
    "components": Case(differential.components, {"L": L}, {"L": LAPLACIAN}),
    "farthest_anchors": Case(
        differential.farthest_anchors, {"L": L, "k": 3}, {"L": LAPLACIAN, "k": WHOLE}
    ),
    "random_anchors": Case(
        differential.random_anchors,
        {"L": L, "k": 3},
        {"L": LAPLACIAN, "k": WHOLE, "seed": (*WHOLE, 1 << 64)},
    ),
    "greedy_anchors": Case(
        differential.greedy_anchors,
        {"L": L, "vertices": V, "k": 3},
        {"L": LAPLACIAN, "vertices": ROWS, "k": WHOLE, "delta": ROWS},
    ),
    "step_of": Case(
        differential.step_of,
        {"values": V, "bits": 3},
        {"values": (NOTHING, TEXT, 3), "bits": (*COUNT, 31)},
    ),
    "quantized_deltas": Case(
        differential.quantized_deltas,
        {"L": L, "delta": V, "step": 0.1},
        {
            "L": LAPLACIAN,
            "delta": ROWS,
            "step": (NOTHING, TEXT, 0, -1, float("nan"), float("inf"), [1, 2]),
            "diffusion": (*NUMBERS, -1, 2),
        },
    ),
    "coded_size": Case(
        differential.coded_size,
        {"L": L, "values": np.zeros((N, 3), dtype=np.int64)},
        {"L": LAPLACIAN, "values": (*ROWS, V)},
    ),
    "quantized_positions": Case(
        differential.quantized_positions,
        {"vertices": V, "bits": 3},
        {"vertices": (NOTHING, TEXT, 3), "bits": (*COUNT, 31)},
    ),
    "eigenvectors": Case(
        differential.eigenvectors, {"L": L}, {"L": LAPLACIAN, "k": (*COUNT, N + 1)}
    ),
    "energies": Case(
        differential.energies,
        {"vectors": VECTORS, "x": V},
        {"vectors": ROWS, "x": ROWS},
        {"vectors": "eigenvectors|rows", "x": "rows"},
    ),
    "spectral_slope": Case(
        differential.spectral_slope,
        {"values": VALUES, "energy": VALUES + 1},
        {"values": (NOTHING, TEXT, 3, [1, 2]), "energy": (NOTHING, TEXT, 3, -VALUES)},
        {"values": "value", "energy": "energ"},
    ),
    "LeastSquares": Case(
        differential.LeastSquares,
        {"L": L, "anchors": [0]},
        {
            "L": LAPLACIAN,
            "anchors": (NOTHING, TEXT, [[3]], [2.5], [N], [0, 0]),
            "weights": (NOTHING, TEXT, 0, -1, float("nan"), [1, 2]),
            "solver": WORDS,
            "memory": LIMIT,
        },
    ),
    "LeastSquares.solve": Case(
        SYSTEM.solve,
        {"delta": V, "positions": V[:2]},
        {"delta": ROWS, "positions": ROWS},
    ),
    "LeastSquares.normal": Case(SYSTEM.normal, {"b": V}, {"b": ROWS}, {"b": "right-hand sides"}),
    "Poisson": Case(
        differential.Poisson,
        {"L": L, "fixed": [0]},
        {"L": LAPLACIAN, "fixed": (NOTHING, TEXT, [[3]], [2.5], [N], [0, 0])},
    ),
    "Poisson.solve": Case(
        POISSON.solve,
        {"b": V, "positions": V[:2]},
        {"b": ROWS, "positions": ROWS, "tolerance": POSITIVE},
        {"b": "right-hand sides"},
    ),
    "basis_functions": Case(
        differential.basis_functions,
        {"system": SYSTEM},
        {"system": (NOTHING, TEXT, 3), "which": (NOTHING, TEXT, 3, [2], [-1], [0.5])},
    ),
    "fitted_positions": Case(
        differential.fitted_positions,
        {"system": SYSTEM, "delta": V, "vertices": V},
        {
            "system": (NOTHING, TEXT, 3),
            "delta": ROWS,
            "vertices": ROWS,
            "tolerance": LIMIT,
            "most": WHOLE,
        },
    ),
    "fitted_rotations": Case(
        differential.fitted_rotations,
        {"L": L, "before": V, "after": V},
        {"L": LAPLACIAN, "before": ROWS, "after": ROWS, "rings": WHOLE},
    ),
    "nearest_rotations": Case(
        differential.nearest_rotations, {"matrices": np.eye(3)[None]}, {"matrices": ROWS}
    ),
    "turned_deltas": Case(
        differential.turned_deltas,
        {"L": L, "vertices": V, "matrices": np.tile(np.eye(3), (N, 1, 1))},
        {"L": LAPLACIAN, "vertices": ROWS, "matrices": (*ROWS, np.eye(3)[None])},
    ),
    "diagonal": Case(differential.diagonal, {"V": V}, {"V": ROWS}, {"V": "vertices"}),
    "vertex_errors": Case(
        differential.vertex_errors,
        {"V": V, "W": V, "F": FACES},
        {"V": ROWS, "W": ROWS, "F": (NOTHING, TEXT, 3, FACES + N, FACES + 0.5)},
        {"V": "vertices", "W": "vertices", "F": "face"},
    ),
}
# Every value of each argument.
WRONG = [
    pytest.param(name, argument, value, id=f"{name}-{argument}-{i}")
    for name, case in CASES.items()
    for argument, values in case.wrong.items()
    for i, value in enumerate(values)
]


@pytest.mark.parametrize("name", CASES)
def test_what_is_right_passes(name: str) -> None:
    if name == "view" and not PAGE.exists():
        pytest.skip("a page needs ziglang")
    if name != "read_mesh":  # there is no mesh in an empty file
        CASES[name].run(**CASES[name].right)


@pytest.mark.parametrize(("name", "argument", "value"), WRONG)
def test_a_wrong_argument_is_refused_by_its_name(name: str, argument: str, value: object) -> None:
    case = CASES[name]
    with pytest.raises((DeltameshError, TypeError), match=case.words.get(argument, argument)) as e:
        case.run(**{**case.right, argument: value})
    # A TypeError is raised for files and bytes alone, on purpose.
    assert isinstance(e.value, DeltameshError) or argument in case.words


def test_every_argument_of_every_public_function_is_here() -> None:
    for module in (deltamesh, differential):
        for name in module.__all__:
            function = getattr(module, name)
            if inspect.isfunction(function) or name in ("LeastSquares", "Poisson"):
                parameters = inspect.signature(function).parameters.values()
                names = {p.name for p in parameters if p.kind is not p.VAR_KEYWORD}
                assert names == {*CASES[name].wrong}, name
    assert {*EncodeOptions.__annotations__} == {*ENCODING}


def test_numbers_of_numpy_are_numbers() -> None:
    options = {"bits": np.int64(8), "anchors": np.float32(0.1), "keep_order": np.bool_(True)}
    mesh = deltamesh.decode(
        deltamesh.encode(MESH, **options), max_vertices=np.int32(100), memory=np.float64(1e9)
    )
    assert isinstance(mesh, PolyMesh)
    assert differential.step_of(V, np.uint8(3)) == differential.step_of(V, 3)
