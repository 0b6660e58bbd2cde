"""Other codecs to measure against: Draco, meshoptimizer with zstd, and zstd alone.

Each takes a welded mesh without isolated vertices, as Draco can keep neither, and gives back its
bytes and what its decoder makes of them. Their packages, the extra `bench`, are imported where they
are used.
"""

from __future__ import annotations

import importlib.util
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from deltamesh._mesh import TriangleMesh
from deltamesh._vectors import sides
from deltamesh.bench._peer_names import DRACO, MESHOPT, ZSTD
from deltamesh_formats.arguments import require_one_of, require_type
from deltamesh_formats.array_types import Floats
from deltamesh_formats.errors import MeshError, OptionError
from deltamesh_formats.zstd_frames import decompressor, frame

# Options with which each is at its smallest.
DRACO_LEVEL: Final = 10
ZSTD_LEVEL: Final = 19
# meshoptimizer's vertex codec wants rows of a multiple of 4 bytes; ours are 4 uint16.
MESHOPT_MAX_BITS: Final = 16
# The level of meshoptimizer's own default, and the version of its vertex codec that packs best.
MESHOPT_LEVEL: Final = 2
MESHOPT_VERSION: Final = 1
DRACO_MAX_BITS: Final = 30


@dataclass(frozen=True)
class Coded:
    """What a codec made of a mesh.

    Attributes
    ----------
    size : int
        Bytes of the whole file.
    reference, decoded : TriangleMesh
        What went in and what comes out, with the same faces in the same order.
    encode_seconds, decode_seconds : float
    sections : mapping of str to int
        Bytes of each part, where a codec tells.
    data : bytes
        The file, where it is a `.dmesh`.
    step : float
        Of the grid on which other codecs have put all vertices; 0 where there is none.
    """

    size: int
    reference: TriangleMesh
    decoded: TriangleMesh
    encode_seconds: float
    decode_seconds: float
    sections: Mapping[str, int] = field(default_factory=dict)
    data: bytes = b""
    step: float = 0.0


def draco(mesh: TriangleMesh, bits: int) -> Coded:
    """Code with Draco (github.com/google/draco) on a grid of 2^bits points on the longest side.

    Draco keeps no order. The decoded positions are those of its own formula, in its own precision
    (`draco_positions`), which its decoder gives in another order.

    Raises
    ------
    MeshError
        If Draco refuses the mesh.
    """
    import DracoPy

    start = time.perf_counter()
    data = draco_file(mesh, bits)
    middle = time.perf_counter()
    DracoPy.decode(data)
    end = time.perf_counter()
    decoded = TriangleMesh(draco_positions(mesh.vertices, bits), mesh.faces)
    step = float(sides(mesh.vertices).max()) / (2**bits - 1)
    return Coded(len(data), mesh, decoded, middle - start, end - middle, step=step)


def draco_file(mesh: TriangleMesh, bits: int, keep_order: bool = False) -> bytes:
    """Return what Draco makes of a mesh; of 0 bits, without quantization.

    Raises
    ------
    MeshError
        If Draco refuses the mesh.
    """
    import DracoPy

    # Its coordinates are float32, those of nearly all mesh files; it asks for uint32 faces.
    points, triangles = mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32)
    try:
        data: bytes = DracoPy.encode(
            points,
            triangles,
            quantization_bits=bits,
            compression_level=DRACO_LEVEL,
            preserve_order=keep_order,
        )
    except (DracoPy.EncodingFailedException, ValueError) as error:
        raise MeshError(f"Draco refuses it: {error}") from error
    return data


def draco_positions(vertices: Floats, bits: int) -> Floats:
    """Return where Draco puts vertices: its `AttributeQuantizationTransform`, in float32.

    floor((x - min) * (2^bits - 1) / range + 0.5) steps of range / (2^bits - 1), the range that of
    the longest side.

    Parameters
    ----------
    vertices : float64 (n, 3)
    bits : int

    Returns
    -------
    float64 (n, 3)
    """
    points = vertices.astype(np.float32)
    low = points.min(axis=0)
    extent = (points.max(axis=0) - low).max() or np.float32(1)
    most = np.float32(2**bits - 1)
    steps = np.floor((points - low) * (most / extent) + np.float32(0.5))
    return np.asarray(steps * (extent / most) + low, dtype=np.float64)


def meshopt(mesh: TriangleMesh, bits: int) -> Coded:
    """Code with meshoptimizer (github.com/zeux/meshoptimizer), then zstd over both streams.

    As gltfpack does: triangles in an order for strips, vertices in the order of their first use,
    positions as uint16 on one grid, here of 2^bits points on the longest side.
    """
    import meshopt as meshoptimizer

    n, corners = len(mesh.vertices), 3 * len(mesh.faces)
    start = time.perf_counter()
    indices, remap, _ = meshoptimizer.reorder_mesh(mesh.faces.astype(np.uint32).ravel(), True, True)
    low = mesh.vertices.min(axis=0)
    step = float((mesh.vertices.max(axis=0) - low).max()) / (2**bits - 1) or 1.0
    rows = np.zeros((n, 4), dtype=np.uint16)
    rows[remap, :3] = np.rint((mesh.vertices - low) / step)
    streams = (
        meshoptimizer.encode_vertex_buffer_level(rows, MESHOPT_LEVEL, MESHOPT_VERSION),
        meshoptimizer.encode_index_buffer(indices),
    )
    data, encoding = frame(b"".join(streams), ZSTD_LEVEL), time.perf_counter() - start

    start = time.perf_counter()
    plain, cut = unframed(data), len(streams[0])
    grid = meshoptimizer.decode_vertex_buffer(plain[:cut], n, rows.itemsize * 4).view(np.uint16)
    faces = meshoptimizer.decode_index_buffer(plain[cut:], corners, 4)
    decoding = time.perf_counter() - start
    F = faces.reshape(-1, 3).astype(np.int64)
    decoded = TriangleMesh(low + step * grid[:, :3].astype(np.float64), F)
    reference = TriangleMesh(mesh.vertices[np.argsort(remap)], F)
    return Coded(len(data), reference, decoded, encoding, decoding, step=step)


def zstd(mesh: TriangleMesh) -> Coded:
    """Code float32 positions and int32 faces, as they are, with zstd (RFC 8878)."""
    start = time.perf_counter()
    arrays = mesh.vertices.astype("<f4"), mesh.faces.astype("<i4")
    data = frame(b"".join(array.tobytes() for array in arrays), ZSTD_LEVEL)
    middle = time.perf_counter()
    plain = unframed(data)
    end = time.perf_counter()
    decoded = np.frombuffer(plain, "<f4", arrays[0].size).reshape(-1, 3).astype(np.float64)
    return Coded(len(data), mesh, TriangleMesh(decoded, mesh.faces), middle - start, end - middle)


def unframed(data: bytes) -> bytes:
    """Return what a frame of this module holds, in however large a window."""
    return decompressor().decompress(data)


@dataclass(frozen=True)
class Peer:
    """A codec of somebody else.

    Attributes
    ----------
    code : callable
        Takes a mesh and, where `max_bits` is not 0, bits a coordinate.
    packages : tuple of str
        What has to be installed.
    max_bits : int
    """

    code: Callable[..., Coded]
    packages: tuple[str, ...]
    max_bits: int


PEERS: Final[Mapping[str, Peer]] = {
    DRACO: Peer(draco, ("DracoPy",), DRACO_MAX_BITS),
    MESHOPT: Peer(meshopt, ("meshopt",), MESHOPT_MAX_BITS),
    ZSTD: Peer(zstd, (), 0),
}


def missing(label: str) -> tuple[str, ...]:
    """Return the packages that the codec of a label needs and that are not installed.

    Raises
    ------
    OptionError
        If the label is no str.
    """
    require_type("label", label, str)
    peer = PEERS.get(label.partition(" ")[0])
    packages = () if peer is None else peer.packages
    return tuple(one for one in packages if importlib.util.find_spec(one) is None)


def labels(name: str, bits: Iterable[int]) -> list[str]:
    """Return the labels of a peer at each number of bits, just one where bits mean nothing.

    Raises
    ------
    OptionError
        If there is no such peer.
    """
    require_one_of("name", name, (*PEERS,))
    return [f"{name} bits={one}" for one in bits] if PEERS[name].max_bits else [name]


def settings_of(name: str, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments of a peer, checked: its bits, if it has any.

    Raises
    ------
    OptionError
    """
    peer = PEERS[name]
    expected = {"bits"} if peer.max_bits else set()
    if set(settings) != expected:
        raise OptionError(f"{name} takes {'bits and nothing else' if expected else 'no options'}")
    bits = settings.get("bits", 1)
    if not (type(bits) is int and 1 <= bits <= max(peer.max_bits, 1)):
        raise OptionError(f"bits of {name} must lie in 1..{peer.max_bits}, not {bits!r}")
    return dict(settings)
