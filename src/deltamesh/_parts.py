"""Parts, names, transforms and metadata of a mesh (section PART); SPEC.md 5.15."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.elements import Elements
from deltamesh._graph.permutations import numbered
from deltamesh._kernels.coding import choices as kernels
from deltamesh._streams import entropy
from deltamesh._streams.labels import decode_labels, encode_labels
from deltamesh_formats.container.packed import packed, unpacked
from deltamesh_formats.container.reader import read_varint, take
from deltamesh_formats.container.texts import Division, Texts, raw_texts, read_texts, write_texts
from deltamesh_formats.container.writer import write_varint
from deltamesh_formats.errors import FormatError, located
from deltamesh_formats.polymesh.descriptions import unkept, unused
from deltamesh_formats.polymesh.mesh import Parts, PolyMesh

_Ints = NDArray[np.int64]
_Transforms = NDArray[np.float64]

_MATRIX_BYTES = 4 * 4 * 8
_IDENTITY = np.eye(4).view(np.uint8)


@dataclass(frozen=True)
class Told:
    """What a file tells of a mesh beside its shape and its attributes.

    Attributes
    ----------
    texts : Texts
    parts : tuple of Parts
        Of the faces in the order of the file.
    """

    texts: Texts
    parts: tuple[Parts, ...]

    def arrays(self) -> tuple[_Ints, ...]:
        """Return what the digest of a file covers of it."""
        text = np.frombuffer(raw_texts(self.texts), dtype=np.uint8).astype(np.int64)
        return (text, *(array for parts in self.parts for array in _arrays(parts)))

    def given_to(self, mesh: PolyMesh) -> PolyMesh:
        """Return a mesh, of the faces of the file, with all of this."""
        texts = self.texts
        return replace(mesh, parts=self.parts, metadata=texts.metadata, lost=texts.lost)


def told_of(mesh: PolyMesh, faces: _Ints) -> Told | None:
    """Return what a file has to tell of a mesh, None if nothing.

    Parameters
    ----------
    mesh : PolyMesh
    faces : int64 (p,)
        Its polygon at each polygon of the file.
    """
    kinds = [parts.kind for parts in mesh.parts]
    found = tuple(replace(parts, of_face=parts.of_face[faces]) for parts in mesh.parts)
    divisions = tuple(
        Division(p.kind, p.names, bool((p.of_face < 0).any()), p.transforms is not None)
        for p in found
    )
    lost = unkept(
        mesh,
        attributes=mesh.attributes,
        parts=kinds,
        metadata=mesh.metadata.keys(),
        polygons=True,
        transforms=True,
    )
    metadata = {key: tuple(lines) for key, lines in mesh.metadata.items()}
    texts = Texts(divisions, metadata, tuple(dict.fromkeys((*lost, *unused(mesh)))))
    return None if texts.is_empty else Told(texts, found)


def encode_parts(told: Told, elements: Callable[[], Elements]) -> bytes:
    """Return the payload of PART.

    Parameters
    ----------
    told : Told
    elements : callable
        Gives the faces of the file as elements, when they are needed.
    """
    payload = [write_texts(told.texts)]
    for parts, division in zip(told.parts, told.texts.divisions, strict=True):
        none = int(division.partly)
        labels, order = numbered(parts.of_face + none)
        streams = [b"" if len(order) < 2 else encode_labels(elements(), labels)]
        streams.append(_encode_order(order, len(parts.names) + none))
        payload += [part for stream in streams for part in (write_varint(len(stream)), stream)]
        if parts.transforms is not None:
            payload.append(_encode_transforms(parts.transforms))
    return b"".join(payload)


def decode_parts(payload: memoryview, count: int, elements: Callable[[], Elements]) -> Told:
    """Return what a file of `count` faces tells: the mirror of `encode_parts`.

    Raises
    ------
    FormatError
        If no encoder has written the payload; the offset counts from its beginning.
    """
    texts, at = read_texts(payload)
    found = []
    for division in texts.divisions:
        stream, start, at = _stream(payload, at)
        labels = np.zeros(count, dtype=np.int64)  # what an empty stream stands for
        if stream:
            with located(start):
                labels = decode_labels(stream, elements())
        stream, start, at = _stream(payload, at)
        of_face = _order(stream, start, division, int(labels.max(initial=-1)) + 1)[labels]
        transforms = None
        if division.moved:
            transforms, at = _decode_transforms(payload, at, len(division.names))
        found.append(Parts(division.kind, division.names, of_face, transforms))
    if at < len(payload):
        raise FormatError("bytes after the last parts", at)
    return Told(texts, tuple(found))


def _stream(payload: memoryview, at: int) -> tuple[bytes, int, int]:
    """Return a stream, where it begins, and the position after it."""
    size, start = read_varint(payload, at)
    return bytes(take(payload, start, size)), start, start + size


def _arrays(parts: Parts) -> tuple[_Ints, ...]:
    if parts.transforms is None:
        return (parts.of_face,)
    return parts.of_face, np.ascontiguousarray(parts.transforms, "<f8").view("<i8").ravel()


def _encode_order(order: _Ints, count: int) -> bytes:
    """Code which of so many parts each label stands for."""
    coder = entropy.encoder(len(order), kernels.SLOTS, kernels.MIXERS)
    kernels.code_choices(coder, order.copy(), count)
    return entropy.finish(coder)


def _order(stream: bytes, start: int, division: Division, labels: int) -> _Ints:
    """Return the part of each label, -1 for none: the mirror of `_encode_order`."""
    none = int(division.partly)
    count = len(division.names) + none
    if labels > count:
        raise FormatError(f"{labels} labels for {count} parts of kind {division.kind}", start)
    order = np.zeros(labels, dtype=np.int64)
    coder = entropy.decoder(stream, kernels.SLOTS, kernels.MIXERS)
    if not kernels.code_choices(coder, order, count):
        raise FormatError("a part that was passed over as the next one", start)
    entropy.check_end(coder, start)
    if none and order.min(initial=1) > 0:
        raise FormatError("faces without a part are announced, but there are none", start)
    return order - none


def _encode_transforms(transforms: _Transforms) -> bytes:
    """Pack a bit a matrix, whether it is not the identity; then the bytes of those, by place."""
    matrices = np.ascontiguousarray(transforms, dtype="<f8").view(np.uint8)
    moves = (matrices != _IDENTITY).any(axis=(1, 2))
    planes = matrices[moves].reshape(-1, _MATRIX_BYTES).T
    return packed(np.packbits(moves, bitorder="little").tobytes() + planes.tobytes())


def _decode_transforms(payload: memoryview, at: int, count: int) -> tuple[_Transforms, int]:
    size = (count + 7) // 8
    raw, end = unpacked(payload, at, size + count * _MATRIX_BYTES)
    data = np.frombuffer(raw, dtype=np.uint8)
    bits = np.unpackbits(data[:size], bitorder="little")
    moves = bits[:count].astype(bool)
    moved = int(moves.sum())
    if len(data) != size + moved * _MATRIX_BYTES or bits[count:].any():
        raise FormatError("transforms of another number than the parts", at)
    matrices = np.broadcast_to(_IDENTITY, (count, *_IDENTITY.shape)).copy()
    matrices[moves] = data[size:].reshape(_MATRIX_BYTES, moved).T.reshape(-1, 4, 32)
    if (matrices[moves] == _IDENTITY).all(axis=(1, 2)).any():
        raise FormatError("an identity among the transforms that are none", at)
    return matrices.view("<f8").astype(np.float64), end
