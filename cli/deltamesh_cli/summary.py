"""What a `.dmesh` file says about itself, as an object for programs and as text for people."""

from __future__ import annotations

from typing import TYPE_CHECKING

from deltamesh_cli.output import shown
from deltamesh_formats.container.container import Container, Meta, Parameters
from deltamesh_formats.container.layout import ORDER
from deltamesh_formats.container.summary import (
    achieved,
    attributes_of,
    bits_per_vertex,
    container_text,
    counts,
    header_bytes,
    polygons,
    relative,
)

if TYPE_CHECKING:
    from deltamesh_formats.container.attribute_table import Entry

__all__ = ["achieved", "as_object", "as_text", "bits_per_vertex", "counts", "errors", "relative"]


def as_object(name: str, container: Container) -> dict[str, object]:
    """Return everything about a container for `--json`; lengths in units of the mesh.

    Raises
    ------
    FormatError
        If its names or its table of attributes are damaged.
    """
    from deltamesh_formats.container.listing import texts_object
    from deltamesh_formats.container.texts import texts_of

    n, parameters, meta = container.vertices, container.parameters, container.meta
    return {
        "file": name,
        "version": container.version,
        "bytes": container.size,
        "vertices": n,
        "faces": container.triangles,
        "polygons": polygons(container),
        "bits_per_vertex": bits_per_vertex(container.size, n),
        "parameters": _parameters(parameters),
        "header": {"bytes": header_bytes(container)},
        "precision": "float32" if parameters.single else "float64",
        "order_kept": ORDER in container.sections,
        **texts_object(texts_of(container)),
        "sections": [
            {"id": s.id, "offset": s.offset, "bytes": s.size} for s in container.sections.values()
        ],
        "attributes": [_attribute(entry) for entry in attributes_of(container)],
        "errors": None if meta is None else errors(meta),
        "encoder": None if meta is None else meta.encoder,
        "source_format": None if meta is None else meta.source or None,
        "digest": container.digest.hex(),
    }


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


def as_text(name: str, container: Container) -> str:
    """Return everything about a container as `deltamesh info` prints it.

    Raises
    ------
    FormatError
        If its names or its table of attributes are damaged.
    """
    return f"{shown(name)}: {container_text(container)}"
