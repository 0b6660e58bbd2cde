"""Seeds of the fuzzer: golden files, refused files, and files of meshes of a few faces.

`python tests/fuzz/seeds.py FOLDER` writes them. The small ones have every section and every coding
of attributes, and are decoded in a fraction of the time that golden files take.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "reference_decoder"))
sys.path.insert(0, str(Path(__file__).parents[1] / "support"))

import attributed
import golden_polymeshes
import meshes
import numpy as np
import polygon_meshes
import stepped
from animated import moving
from places import GOLDEN, REFUSED

from deltamesh import encode
from deltamesh._methods import METHODS
from deltamesh._options import Options
from deltamesh_formats.polymesh.mesh import PolyMesh, from_triangles


def small_meshes() -> dict[str, PolyMesh]:
    """Meshes of a few faces, by name."""
    complexes = {**meshes.complexes(), "moebius": meshes.moebius(4), "grid": meshes.grid(3, 3)}
    complexes["torus"], complexes["tetrahedron"] = meshes.torus(3, 3), meshes.tetrahedron()
    return {
        **{name: from_triangles(*mesh) for name, mesh in complexes.items()},
        "with_isolated": attributed.with_isolated(),
        "with_copies": attributed.with_copies(),
        "quads": polygon_meshes.quads(3, 3),
        "prism": polygon_meshes.prism(5),
        "quad_moebius": polygon_meshes.moebius(4),
        "repeated_vertices": polygon_meshes.repeated_vertices(),
        "mixed": polygon_meshes.mixed(),
    }


def files() -> Iterator[tuple[str, bytes]]:
    """Yield names and bytes of small files."""
    by_method = {
        "cartesian": {"bits": 6},
        "highpass": {"bits": 5},
        "refined": {"bits": 5, "anchor_method": "greedy", "anchors": 3},
        "lossless": {},
    }
    assert by_method.keys() == METHODS.keys()
    for name, mesh in small_meshes().items():
        for method, options in by_method.items():
            yield f"{name}-{method}", encode(mesh, method=method, **options)
        ordered = golden_polymeshes.shuffled(mesh)
        yield f"{name}-order", encode(ordered, method="cartesian", bits=2, keep_order=True)
    yield from attributed_files()
    yield from sequences()
    scene = from_triangles(*meshes.union(meshes.tetrahedron(), meshes.tetrahedron()))
    scene = replace(scene, vertices=scene.vertices * np.repeat([1.0, 0.01], 4)[:, None])
    for method in ("cartesian", "highpass", "refined"):
        options = Options(method=method, step=0.01)
        yield f"steps-{method}", stepped.restepped(scene, options, stepped.by_size).data


def sequences() -> Iterator[tuple[str, bytes]]:
    """Yield files of a few frames."""
    at_rate = {"bits": 5, "key_every": 2}
    within = {"max_error_rel": 0.002, "normal_error": 20.0}
    for name, mesh, options in (
        ("torus", meshes.torus(3, 3), at_rate),
        ("isolated", meshes.with_isolated(), at_rate),
        ("corrected", meshes.torus(6, 5), within),
    ):
        given = moving(mesh, 3)
        yield f"frames-{name}-cartesian", encode(given, method="cartesian", **options)
        for method in ("highpass", "refined"):
            data = encode(given, method=method, anchors=3, solution="interpolated", **options)
            yield f"frames-{name}-{method}", data


def attributed_files() -> Iterator[tuple[str, bytes]]:
    """Yield files with one attribute, or with parts."""
    mesh = from_triangles(*meshes.grid(3, 3))
    kinds = {
        "colours": attributed.colours,
        "integers": attributed.integers,
        "exact": attributed.exact,
        "textured": attributed.textured,
        "shaded": lambda mesh: attributed.shaded(mesh, 0),
        "free": lambda mesh: attributed.shaded(mesh, None),
    }
    for name, make in kinds.items():
        for i, attribute in enumerate(make(mesh)):
            given = replace(mesh, attributes=(attribute,))
            yield f"{name}-{i}", encode(given, method="cartesian", bits=2)
    for name in ("with_copies", "three_pages", "quads", "with_isolated"):
        given = attributed.with_all(small_meshes()[name])
        yield f"attributes-{name}", encode(given, method="cartesian", bits=2)
    parts = golden_polymeshes.with_parts(polygon_meshes.quads(4, 3))
    for part in parts.parts:
        given = replace(parts, parts=(part,), metadata={}, lost=())
        yield f"parts-{part.kind}", encode(given, method="cartesian", bits=2)


def write_seeds(folder: Path) -> int:
    """Write all seeds to a folder; return how many there are."""
    folder.mkdir(parents=True, exist_ok=True)
    for path in (*GOLDEN.glob("*.dmesh"), *REFUSED.glob("*.dmesh")):
        shutil.copyfile(path, folder / f"{path.parent.name}-{path.name}")
    for name, data in files():
        (folder / f"{name}.dmesh").write_bytes(data)
    return len(list(folder.iterdir()))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Write the seeds of the fuzzer.")
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    print(write_seeds(parser.parse_args().folder), "seeds")
