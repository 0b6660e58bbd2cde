"""Description of a `.dmesh` file: an object for programs, text for people."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from deltamesh_cli.output import display_name
from deltamesh_formats.container.container import Container, Meta, Parameters
from deltamesh_formats.container.figures import (
    attributes_of,
    bits_per_vertex,
    header_bytes,
    polygons,
    relative,
    worst_frame,
)
from deltamesh_formats.container.layout import ATTRIBUTES, ORDER, PARTS
from deltamesh_formats.container.regions import regions_of
from deltamesh_formats.container.stages import awaited, stage_of, stages_of
from deltamesh_formats.container.summary import container_text

# The share of a file above which a kind of content is worth a line.
_COSTLY: Final = 0.2

if TYPE_CHECKING:
    from deltamesh_formats.container.attribute_entry import Entry


def container_object(name: str, container: Container) -> dict[str, object]:
    """Return the description of a file for `--json`, with lengths in the unit of the mesh.

    Raises
    ------
    FormatError
        If its text or its attribute table is damaged.
    """
    from deltamesh_formats.container.listing import poses_object, texts_object
    from deltamesh_formats.container.pose_table import entries_of as poses_of
    from deltamesh_formats.container.texts import texts_of

    n, parameters, meta = container.vertices, container.parameters, container.meta
    reached = stages_of(container)
    return {
        "file": name,
        "version": container.version,
        "bytes": container.size,
        "vertices": n,
        "faces": container.triangles,
        "polygons": polygons(container),
        "bits_per_vertex": bits_per_vertex(container.size, n),
        "parameters": _parameters_object(parameters),
        "header": {"bytes": header_bytes(container)},
        "precision": "float32" if parameters.single else "float64",
        "order_kept": ORDER in container.sections,
        **texts_object(texts_of(container)),
        "sections": [
            {"id": s.id, "offset": s.offset, "bytes": s.size} for s in container.sections.values()
        ],
        "attributes": [_attribute_object(entry) for entry in attributes_of(container)],
        "poses": poses_object(poses_of(container)),
        "errors": None if meta is None else errors_object(meta),
        "sequence": _sequence_object(container),
        "importance": _regions_object(container),
        "encoder": None if meta is None else meta.encoder,
        "source_format": None if meta is None else meta.source or None,
        "digest": container.digest.hex() or None,
        "stages": [{"stage": stage, "bytes": size} for stage, size in reached.items()],
        **stage_object(container),
    }


def stage_object(container: Container) -> dict[str, object]:
    """Return how far a file reaches that may be cut, for `--json`."""
    return {
        "stage": stage_of(container) or None,
        "cut": container.cut or None,
        "absent": list(awaited(container)),
    }


def _sequence_object(container: Container) -> dict[str, object] | None:
    """Return the frames of a sequence for `--json`; lengths are relative to their own diagonals."""
    frames = container.frames
    if not frames:
        return None
    return {
        "count": len(frames) + 1,
        "fps": container.fps,
        "key_frames": [0, *(frame.index for frame in frames if frame.is_key)],
        "worst_frame": worst_frame(frames).index,
        "frames": [
            {
                "frame": frame.index,
                "bytes": frame.size,
                "step": frame.step,
                "coarse": frame.coarse,
                "maps": frame.maps,
                "rms_relative": frame.rms,
                "max_relative": frame.max,
                "normal_deviation_degrees": frame.normal,
                "dihedral_degrees": frame.dihedral,
            }
            for frame in frames
        ],
    }


def _regions_object(container: Container) -> dict[str, object] | None:
    """Return the errors of what is important and of the rest, None where all is."""
    regions = regions_of(container)
    if regions is None:
        return None
    found = vars(regions)
    counts = {f"vertices_{name}": found[name] for name in ("full", "reduced", "none")}
    kinds = {"rms": "rms", "max": "max"}
    kinds |= {"normal": "normal_deviation_degrees", "dihedral": "dihedral_degrees"}
    errors = {
        name: {kind: found[f"{field}_{name}"] for field, kind in kinds.items()}
        for name in ("full", "reduced")
    }
    return {**counts, **errors}


def _attribute_object(entry: Entry) -> dict[str, object]:
    return {
        "name": entry.name,
        "domain": entry.domain,
        "role": entry.role,
        "type": str(entry.dtype),
        "width": entry.width,
        "normalized": entry.normalized,
        "partly": entry.partly,
        "coding": entry.coding,
        "bits": (entry.bits or None) if entry.coding in ("grid", "octahedral") else None,
        "palette": entry.palette,
        "largest_error": entry.error,
        "bytes": entry.size,
    }


def _parameters_object(parameters: Parameters) -> dict[str, object]:
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
        "solution": parameters.solution,
        "seed": parameters.seed,
        "origin": list(parameters.origin),
        "isolated_vertices": parameters.isolated,
    }


def errors_object(meta: Meta) -> dict[str, object]:
    """Return the errors that the encoder measured, for `--json`."""
    return {
        "rms": meta.rms,
        "rms_relative": relative(meta.rms, meta.diagonal),
        "max": meta.max,
        "max_relative": relative(meta.max, meta.diagonal),
        "normal_deviation_degrees": meta.normal,
        "dihedral_degrees": meta.dihedral,
        "diagonal": meta.diagonal,
        "triangles_lost": meta.lost,
        "triangles_turned": meta.turned,
        "parts": meta.parts,
        "worst_part": part_object(meta.part, meta.part_normal, meta.part_rms)
        if meta.parts > 1
        else None,
    }


def part_object(name: str, normal_deviation: float, relative_rms: float) -> dict[str, object]:
    """Return the errors of a part for `--json`."""
    return {
        "name": name,
        "normal_deviation_degrees": normal_deviation,
        "rms_relative": relative_rms,
    }


def costly_lines(container: Container) -> Iterator[str]:
    """Yield a line for each kind of content beside the shape that takes much of a file.

    Raises
    ------
    FormatError
        If the attribute table is damaged.
    """
    hints = {PARTS: "--drop all leaves them out", ORDER: "less without --keep-order"}
    words = {PARTS: "names, parts and metadata", ORDER: "order of vertices and faces"}
    entries = sorted(attributes_of(container), key=lambda entry: -entry.size)
    for section in (ATTRIBUTES, PARTS, ORDER):
        size = container.sections[section].size if section in container.sections else 0
        if size <= _COSTLY * container.size:
            continue
        what, hint = words.get(section, ""), hints.get(section, "")
        if section == ATTRIBUTES:
            shown = [entry for entry in entries if entry.size > size / 20]
            listed = ", ".join(f"{display_name(entry.name)} {entry.size}" for entry in shown)
            what, hint = "attributes", f"{listed}; {_attribute_hint(shown)}"
        yield f"{what}: {size} bytes of {container.size}: {hint}"


def _attribute_hint(entries: list[Entry]) -> str:
    """Return the options that make these attributes smaller."""
    names = dict.fromkeys(entry.name for entry in entries)
    hint = f"--drop {shlex.quote(','.join(names))}"
    exact = [entry.name for entry in entries if entry.coding == "exact"]
    if exact:
        hint += f", or --max-attribute-error {shlex.quote(f'{exact[0]}=E')}"
    elif any(entry.role == "uv" and entry.coding == "grid" for entry in entries):
        hint += ", or --max-uv-error E"
    return display_name(hint)


def described_container(name: str, container: Container) -> str:
    """Return the description of a file as `deltamesh info` prints it.

    Raises
    ------
    FormatError
        If its text or its attribute table is damaged.
    """
    return f"{display_name(name)}: {container_text(container)}"
