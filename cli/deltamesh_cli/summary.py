"""What a `.dmesh` file says about itself, as an object for programs and as text for people."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from deltamesh_cli.output import number, shown, table
from deltamesh_formats.layout import ATTRIBUTES, ORDER, Container, Meta, Parameters

if TYPE_CHECKING:
    from deltamesh_formats.attribute_table import Entry

METHODS = {
    "highpass": "high-pass",
    "refined": "refined high-pass",
    "cartesian": "Cartesian",
    "lossless": "lossless",
}


def bits_per_vertex(size: int, vertices: int) -> float:
    """Return bits per vertex of `size` bytes."""
    return 8 * size / max(vertices, 1)


def relative(length: float, diagonal: float) -> float:
    """Return a length as a fraction of the bounding box diagonal; a point has none."""
    return length / diagonal if diagonal else 0.0


def _header_bytes(container: Container) -> int:
    return container.size - sum(section.size for section in container.sections.values())


def as_object(name: str, container: Container) -> dict[str, object]:
    """Return everything about a container for `--json`; lengths in units of the mesh.

    Raises
    ------
    FormatError
        If its names or its table of attributes are damaged.
    """
    from deltamesh_formats.listing import texts_object
    from deltamesh_formats.texts import texts_of

    n, parameters, meta = container.vertices, container.parameters, container.meta
    return {
        "file": name,
        "version": container.version,
        "bytes": container.size,
        "vertices": n,
        "faces": container.faces,
        "bits_per_vertex": bits_per_vertex(container.size, n),
        "parameters": _parameters(parameters),
        "header": {"bytes": _header_bytes(container)},
        "precision": "float32" if parameters.single else "float64",
        "order_kept": ORDER in container.sections,
        **texts_object(texts_of(container)),
        "sections": [
            {"id": s.id, "offset": s.offset, "bytes": s.size} for s in container.sections.values()
        ],
        "attributes": [_attribute(entry) for entry in _attributes(container)],
        "errors": None if meta is None else errors(meta),
        "encoder": None if meta is None else meta.encoder,
        "source_format": None if meta is None else meta.source or None,
        "digest": container.digest.hex(),
    }


def _attributes(container: Container) -> Sequence[Entry]:
    if ATTRIBUTES not in container.sections:
        return ()
    from deltamesh_formats.attribute_table import entries_of  # which needs numpy

    return entries_of(container)


def _attribute(entry: Entry) -> dict[str, object]:
    return {
        "name": entry.name,
        "domain": entry.domain,
        "role": entry.role,
        "type": str(entry.dtype),
        "width": entry.width,
        "normalized": entry.normalized,
        "partly": entry.partly,
        "coding": entry.coding,
        "bits": entry.bits if entry.coding in ("grid", "octahedral") else None,
        "palette": entry.palette,
        "largest_error": entry.error,
        "bytes": entry.size,
    }


def _parameters(parameters: Parameters) -> dict[str, object]:
    return {
        "method": parameters.method,
        "bits": parameters.bits,
        "step": parameters.step,
        "coarse": parameters.coarse,
        "dead_zone": parameters.dead_zone,
        "normal_dead_zone": parameters.normal_dead_zone,
        "diffusion": parameters.diffusion,
        "anchors": parameters.anchor_count,
        "anchor_method": parameters.anchor_method,
        "anchor_step": parameters.anchor_step,
        "seed": parameters.seed,
        "origin": list(parameters.origin),
        "isolated_vertices": parameters.isolated,
    }


def errors(meta: Meta) -> dict[str, object]:
    """Return the errors that the encoder measured, for `--json`."""
    return {
        "rms": meta.rms,
        "rms_relative": relative(meta.rms, meta.diagonal),
        "max": meta.max,
        "max_relative": relative(meta.max, meta.diagonal),
        "normal_deviation_degrees": meta.normal,
        "dihedral_degrees": meta.dihedral,
        "diagonal": meta.diagonal,
    }


def counts(container: Container) -> str:
    """Return vertices, faces and bits per vertex, in words."""
    rate = bits_per_vertex(container.size, container.vertices)
    return f"{container.vertices} vertices, {container.faces} faces, {rate:.2f} bits per vertex"


def achieved(meta: Meta) -> str:
    """Return the errors that the encoder measured, in words."""
    return (
        f"RMS {number(relative(meta.rms, meta.diagonal))} and"
        f" max {number(relative(meta.max, meta.diagonal))} of the diagonal,"
        f" normals {number(meta.normal)} and dihedral angles {number(meta.dihedral)} degrees"
    )


def as_text(name: str, container: Container) -> str:
    """Return everything about a container as `deltamesh info` prints it.

    Raises
    ------
    FormatError
        If its names or its table of attributes are damaged.
    """
    lines = [*_lines(name, container)]
    if attributes := _attributes(container):
        lines += ["", table(_attribute_rows(attributes))]
    return "\n".join(lines)


def _lines(name: str, container: Container) -> Iterator[str]:
    from deltamesh_formats.listing import text_lines
    from deltamesh_formats.texts import texts_of

    meta = container.meta
    yield f"{shown(name)}: {container.size} bytes, {counts(container)}"
    yield from (f"  {line}" for line in _described(container.parameters))
    if ORDER in container.sections:
        yield "  order of vertices and faces: that of the source"
    yield from (f"  {line}" for line in text_lines(texts_of(container)))
    if meta is not None:
        source = f", from {meta.source}" if meta.source else ""
        yield f"  errors: {achieved(meta)}"
        yield f"  written by {meta.encoder}{source}; format version {container.version}"
    yield ""
    yield table(_section_rows(container))


def _described(parameters: Parameters) -> Iterator[str]:
    words = [] if parameters.bits is None else [f"{parameters.bits} bits"]
    if parameters.step:
        words.append(f"step {number(parameters.step)}")
        if parameters.method == "refined":
            words.append(f"deltas {number(parameters.coarse)} times as coarse")
        if parameters.method != "cartesian":
            words.append("error diffusion" if parameters.diffusion else "plain rounding")
    yield ": ".join(filter(None, (METHODS[parameters.method], ", ".join(words))))
    if parameters.anchor_method is not None:
        seed = f", seed {parameters.seed}" if parameters.anchor_method == "random" else ""
        yield f"anchors: {parameters.anchor_count}, {parameters.anchor_method}{seed}"
    if parameters.isolated:
        yield f"isolated vertices: {parameters.isolated}"


def _attribute_rows(attributes: Sequence[Entry]) -> Iterator[tuple[str, ...]]:
    yield "attribute", "of", "numbers", "coding", "bits", "largest error", "bytes"
    for entry in attributes:
        numbers = f"{entry.width} {entry.dtype}"
        if entry.coding == "octahedral":
            lost = f"{number(entry.error)} degrees"
        else:
            lost = number(entry.error) if entry.error else "none"
        coding = entry.coding if entry.palette is None else f"{entry.coding}, palette"
        bits = str(entry.bits) if entry.coding in ("grid", "octahedral") else ""
        yield shown(entry.name), entry.domain, numbers, coding, bits, lost, str(entry.size)


def _section_rows(container: Container) -> Iterator[tuple[str, str, str]]:
    sizes = [("header", _header_bytes(container))]
    sizes += [(section.id, section.size) for section in container.sections.values()]
    yield "section", "bytes", "bits/vertex"
    for name, size in [*sizes, ("total", container.size)]:
        yield name, str(size), f"{bits_per_vertex(size, container.vertices):.3f}"
