"""Builder of containers: what an encoder has, laid out as a file."""

from __future__ import annotations

from collections.abc import Mapping

from deltamesh_formats.container import layout, method_layouts
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.fields import write_fields
from deltamesh_formats.container.header import write_header
from deltamesh_formats.container.meta import Meta, meta_faults, read_meta, write_meta
from deltamesh_formats.container.parameters import (
    Parameters,
    parameter_faults,
    read_parameters,
    write_parameters,
)
from deltamesh_formats.container.sections import laid_out
from deltamesh_formats.errors import MeshError


def build_container(
    vertices: int,
    triangles: int,
    parameters: Parameters,
    payloads: Mapping[str, bytes],
    meta: Meta | None,
    digest: bytes,
) -> Container:
    """Return the container that `reader.read_container` makes of the bytes of the file.

    Parameters
    ----------
    vertices, triangles : int
        Counts of the decoded mesh.
    parameters : Parameters
        The result has those of the file, where some numbers are rounded to binary32 or hundredths.
    payloads : mapping of section id to bytes
        In any order: `CONN`, the sections of the method, and those further ones of
        `method_layouts.required` that the mesh needs. Ids unknown to this version must be
        optional ones; they come last, in their order.
    meta : Meta or None
        Rounded in the same way.
    digest : bytes, 8
        Of the decoded integers.

    Raises
    ------
    MeshError
        When a value is outside what the format holds.
    ValueError
        For payloads that do not belong to the method, too many of them, or a digest of another
        size.
    """
    _check_payloads(parameters.method, payloads)
    if len(digest) != layout.DIGEST_SIZE:
        raise ValueError(f"a digest of {len(digest)} bytes, not {layout.DIGEST_SIZE}")
    start = len(write_header(layout.VERSION, vertices, triangles))
    own = {layout.PARAMETERS: _parameters(parameters, vertices)}
    if meta is not None:
        own[layout.META] = _meta(meta)
    own[layout.CHECK] = write_fields(layout.CHECK_FIELDS, {"digest": digest})
    first = method_layouts.required(parameters.method, payloads)
    ids = (*first, layout.META, *(name for name in payloads if name not in first), layout.CHECK)
    present = {**payloads, **own}
    sections = laid_out({name: present[name] for name in ids if name in present}, start)
    return Container(
        layout.VERSION,
        vertices,
        triangles,
        read_parameters(own[layout.PARAMETERS], vertices),
        None if meta is None else read_meta(own[layout.META]),
        sections,
        digest,
    )


def _check_payloads(method: str, payloads: Mapping[str, bytes]) -> None:
    required = method_layouts.required(method, payloads)[1:]
    others = [name for name in payloads if name not in required]
    if not set(required) <= set(payloads):
        raise ValueError(f"the payloads are {list(payloads)}, not {required}")
    taken = method_layouts.KNOWN - {layout.REGIONS}
    if any(name in taken or not _is_optional_id(name) for name in others):
        raise ValueError(f"not ids of optional sections: {others}")
    if len(others) + len(required) + 3 > layout.MAX_SECTIONS:
        raise ValueError(f"more than {layout.MAX_SECTIONS} sections")


def _is_optional_id(name: str) -> bool:
    is_id = len(name) == layout.ID_SIZE and name.isascii() and name.isalpha()
    return is_id and name[0].islower()


def _parameters(parameters: Parameters, vertices: int) -> bytes:
    for _, message in parameter_faults(parameters, vertices):
        raise MeshError(f"cannot be written: {message}")
    return write_parameters(parameters)


def _meta(meta: Meta) -> bytes:
    for _, message in meta_faults(meta):
        raise MeshError(f"cannot be written: {message}")
    return write_meta(meta)
