"""Parts, names, transforms and metadata of a mesh (section PART); SPEC.md 5.15."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from deltamesh._graph.elements import Elements
from deltamesh._kernels.coding import choices as kernels
from deltamesh._kernels.coding.coder import Coder
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh._streams.labels import decode_labels, encode_labels
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container.fields import read_varint, take, write_varint
from deltamesh_formats.container.packed import packed, unpacked
from deltamesh_formats.container.texts import Division, Texts, raw_texts, read_texts, write_texts
from deltamesh_formats.errors import FormatError, located
from deltamesh_formats.polymesh.descriptions import losses_of, unreferenced_rows
from deltamesh_formats.polymesh.mesh import Parts, PolyMesh
from deltamesh_formats.polymesh.permutations import numbered

_MATRIX_BYTES = 4 * 4 * 8
_IDENTITY = np.eye(4).view(np.uint8)


@dataclass(frozen=True)
class Annotations:
    """Parts, names, transforms, metadata and losses of a mesh.

    Attributes
    ----------
    texts : Texts
    parts : tuple of Parts
        Of the polygons in the order of the file.
    """

    texts: Texts
    parts: tuple[Parts, ...]

    def arrays(self) -> tuple[Ints, ...]:
        """Return the arrays that the digest of a file covers."""
        text = np.frombuffer(raw_texts(self.texts), dtype=np.uint8).astype(np.int64)
        return (text, *(array for parts in self.parts for array in _arrays(parts)))

    def given_to(self, mesh: PolyMesh) -> PolyMesh:
        """Return a mesh of the polygons of the file with these annotations."""
        texts = self.texts
        return replace(mesh, parts=self.parts, metadata=texts.metadata, lost=texts.lost)


def annotations_of(mesh: PolyMesh, polygons: Ints) -> Annotations | None:
    """Return the annotations of a mesh, None if there are none.

    Parameters
    ----------
    mesh : PolyMesh
    polygons : int64 (p,)
        The polygon of the mesh at each polygon of the file.
    """
    kinds = [parts.kind for parts in mesh.parts]
    found = tuple(replace(parts, of_face=parts.of_face[polygons]) for parts in mesh.parts)
    divisions = tuple(
        Division(p.kind, p.names, bool((p.of_face < 0).any()), p.transforms is not None)
        for p in found
    )
    lost = losses_of(
        mesh,
        attributes=mesh.attributes,
        parts=kinds,
        metadata=mesh.metadata.keys(),
        polygons=True,
        transforms=True,
    )
    metadata = {key: tuple(lines) for key, lines in mesh.metadata.items()}
    texts = Texts(divisions, metadata, tuple(dict.fromkeys((*lost, *unreferenced_rows(mesh)))))
    return None if texts.is_empty else Annotations(texts, found)


def encode_parts(annotations: Annotations, elements: Callable[[], Elements]) -> bytes:
    """Return the payload of PART.

    Parameters
    ----------
    annotations : Annotations
    elements : callable
        Returns the polygons of the file as elements; called only when they are needed.
    """
    payload = [write_texts(annotations.texts)]
    for parts, division in zip(annotations.parts, annotations.texts.divisions, strict=True):
        none = int(division.partly)
        labels, order = numbered(parts.of_face + none)
        streams = [b"" if len(order) < 2 else encode_labels(elements(), labels)]
        streams.append(_encode_order(order, len(parts.names) + none))
        payload += [part for stream in streams for part in (write_varint(len(stream)), stream)]
        if parts.transforms is not None:
            payload.append(_encode_transforms(parts.transforms))
    return b"".join(payload)


def decode_parts(payload: memoryview, count: int, elements: Callable[[], Elements]) -> Annotations:
    """Return the annotations of a file of `count` polygons: the mirror of `encode_parts`.

    Raises
    ------
    FormatError
        If no encoder has written the payload; the offset counts from its beginning.
    """
    texts, at = read_texts(payload)
    found = []
    for division in texts.divisions:
        stream, start, at = _stream(payload, at)
        labels = np.zeros(count, dtype=np.int64)  # as an empty stream has them
        if stream:
            with located(start):
                labels = decode_labels(stream, elements())
        stream, start, at = _stream(payload, at)
        of_face = _decode_order(stream, start, division, int(labels.max(initial=-1)) + 1)[labels]
        transforms = None
        if division.moved:
            transforms, at = _decode_transforms(payload, at, len(division.names))
        found.append(Parts(division.kind, division.names, of_face, transforms))
    if at < len(payload):
        raise FormatError("bytes after the last parts", at)
    return Annotations(texts, tuple(found))


def _stream(payload: memoryview, at: int) -> tuple[bytes, int, int]:
    """Return a stream, where it begins, and the position after it."""
    size, start = read_varint(payload, at)
    return bytes(take(payload, start, size)), start, start + size


def _arrays(parts: Parts) -> tuple[Ints, ...]:
    if parts.transforms is None:
        return (parts.of_face,)
    return parts.of_face, np.ascontiguousarray(parts.transforms, "<f8").view("<i8").ravel()


def _encode_order(order: Ints, count: int) -> bytes:
    """Code the part that each label stands for, of `count` parts."""
    coded = order.copy()
    return encode_with(
        kernels.MODEL, len(order), lambda coder: kernels.code_choices(coder, coded, count)
    )


def _decode_order(stream: bytes, start: int, division: Division, labels: int) -> Ints:
    """Return the part of each label, -1 for none: the mirror of `_encode_order`."""
    none = int(division.partly)
    count = len(division.names) + none
    if labels > count:
        raise FormatError(f"{labels} labels for {count} parts of kind {division.kind}", start)

    def run(coder: Coder) -> Ints:
        order = np.zeros(labels, dtype=np.int64)
        if not kernels.code_choices(coder, order, count):
            raise FormatError("non-canonical part number: the next part was skipped", start)
        return order

    order = decode_with(kernels.MODEL, stream, run, start)
    if none and order.min(initial=1) > 0:
        raise FormatError("no face without a part, though some are announced", start)
    return order - none


def _encode_transforms(transforms: Floats) -> bytes:
    """Pack a bit per matrix, 1 unless it is the identity, and the other matrices bytewise."""
    matrices = np.ascontiguousarray(transforms, dtype="<f8").view(np.uint8)
    moves = (matrices != _IDENTITY).any(axis=(1, 2))
    planes = matrices[moves].reshape(-1, _MATRIX_BYTES).T
    return packed(np.packbits(moves, bitorder="little").tobytes() + planes.tobytes())


def _decode_transforms(payload: memoryview, at: int, count: int) -> tuple[Floats, int]:
    size = (count + 7) // 8
    raw, end = unpacked(payload, at, size + count * _MATRIX_BYTES)
    data = np.frombuffer(raw, dtype=np.uint8)
    bits = np.unpackbits(data[:size], bitorder="little")
    moves = bits[:count].astype(bool)
    moved = int(moves.sum())
    if len(data) != size + moved * _MATRIX_BYTES or bits[count:].any():
        raise FormatError("transform count differs from the part count", at)
    matrices = np.broadcast_to(_IDENTITY, (count, *_IDENTITY.shape)).copy()
    matrices[moves] = data[size:].reshape(_MATRIX_BYTES, moved).T.reshape(-1, 4, 32)
    if (matrices[moves] == _IDENTITY).all(axis=(1, 2)).any():
        raise FormatError("non-canonical transform: identity stored explicitly", at)
    return matrices.view("<f8").astype(np.float64), end
