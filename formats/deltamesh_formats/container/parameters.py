"""Coding of the geometry, the section `PARM`: values, rules of these, and bytes; SPEC.md 4.1."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from deltamesh_formats.container import layout
from deltamesh_formats.container.fields import Buffer, Field, read_fields, read_table, write_fields
from deltamesh_formats.container.layout import (
    INTERPOLATED,
    LEAST_SQUARES,
    MAX_BITS,
    RANDOM,
    ZONE_UNIT,
)
from deltamesh_formats.container.method_layouts import METHODS
from deltamesh_formats.errors import FormatError

_METHODS = {method.id: name for name, method in METHODS.items()}
_ANCHOR_METHODS = {code: name for name, code in layout.ANCHOR_METHODS.items()}


@dataclass(frozen=True)
class Parameters:
    """Coding of the geometry; the payload of `PARM`.

    Attributes
    ----------
    method : str
        A key of `METHODS`.
    diffusion : bool
        Whether the encoder diffused the quantization error; the decoder has no use for it.
    anchor_method : str or None
        A key of `ANCHOR_METHODS`; None exactly for the methods without anchors.
    bits : int or None
        What was asked for, bits per coordinate; None when it was a step.
    step : float
        Quantization step, in the unit of the mesh; 0 exactly for an exact method, and for a bare
        one at 0 bits.
    origin : (float, float, float)
        Origin of the grid of the anchors, or of the Cartesian coordinates.
    anchor_step : float
        Step of that grid for the anchors; 0 without any.
    seed : int
        Seed of the random choice of anchors; 0 for other anchors.
    anchor_count : int
        Number of anchors; 0 for the methods without.
    isolated : int
        Number of points without a face.
    coarse : float
        The step of the deltas over `step`; 1 unless the method has coarse deltas.
    dead_zone, normal_dead_zone : float
        How far beyond half a step the encoder still rounded deltas, and refinements, to 0, in
        steps; multiples of 0.01. The decoder has no use for them.
    single : bool
        Whether the source holds positions in float32.
    interpolated : bool
        Whether the positions go through the anchors; else deltas and anchors are weighed against
        each other, in the least-squares sense.
    """

    method: str
    diffusion: bool = False
    anchor_method: str | None = None
    bits: int | None = None
    step: float = 0.0
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    anchor_step: float = 0.0
    seed: int = 0
    anchor_count: int = 0
    isolated: int = 0
    coarse: float = 1.0
    dead_zone: float = 0.0
    normal_dead_zone: float = 0.0
    single: bool = False
    interpolated: bool = False

    @property
    def solution(self) -> str | None:
        """Name of what positions make of deltas and anchors; None without anchors."""
        if self.anchor_method is None:
            return None
        return INTERPOLATED if self.interpolated else LEAST_SQUARES


def parameter_faults(parameters: Parameters, vertices: int) -> Iterator[tuple[str, str]]:
    """Yield (field, what is wrong with it) by the rules of SPEC.md 4.1, for reader and writer."""
    p = parameters
    method = METHODS[p.method]
    stepless = method.exact or (method.bare and p.bits == 0)
    if method.anchored == (p.anchor_method is None):
        yield "anchor_method", f"method {p.method} with anchor method {p.anchor_method or 'none'}"
    if p.bits is not None and not 0 <= p.bits <= MAX_BITS:
        yield "bits", f"{p.bits} bits, outside 0..{MAX_BITS}"
    if p.bits is not None and method.exact:
        yield "bits", f"{p.bits} bits in a {method.title} file"
    if not (math.isfinite(p.step) and p.step >= 0 and (p.step == 0) == stepless):
        yield "step", f"a quantization step of {p.step}"
    for axis, value in zip("xyz", p.origin, strict=True):
        if not math.isfinite(value) or (method.exact and value):
            yield f"origin_{axis}", f"an origin of {value}"
    if not (math.isfinite(p.anchor_step) and p.anchor_step >= 0):
        yield "anchor_step", f"an anchor step of {p.anchor_step}"
    for name, count in (("anchor_count", p.anchor_count), ("isolated", p.isolated)):
        if not 0 <= count <= vertices:
            yield name, f"{count} {name.split('_')[0]} vertices among {vertices}"
    if not (1 <= p.coarse < math.inf and (method.coarse or p.coarse == 1)):
        yield "coarse", f"method {p.method} with deltas {p.coarse} times as coarse"
    for name in ("dead_zone", "normal_dead_zone"):
        if not 0 <= getattr(p, name) * ZONE_UNIT < 256:
            yield name, f"a dead zone of {getattr(p, name)}"
    if p.seed and p.anchor_method != RANDOM:
        yield "anchor_method", f"a seed of {p.seed} for anchors that are not random"
    if p.interpolated and (not method.anchored or stepless):
        yield "flags", "interpolated anchors in a file without deltas"
    if not method.anchored and (p.anchor_step or p.anchor_count):
        yield "anchor_count", f"anchors in a {method.title} file"


def read_parameters(payload: Buffer, vertices: int) -> Parameters:
    """Return what the payload of `PARM` holds, in a file of so many vertices.

    Raises
    ------
    FormatError
    """
    fields: tuple[Field, ...] = layout.PARAMETER_FIELDS
    first = read_fields(payload, 0, fields)[0]
    if first["anchor_method"] == layout.ANCHOR_METHODS[RANDOM]:
        fields += layout.SEED_FIELDS
    values, offsets = read_table(payload, fields)
    for field, names in (("method", _METHODS), ("anchor_method", _ANCHOR_METHODS)):
        if values[field] not in names:
            message = f"{field.replace('_', ' ')} {values[field]} is unknown"
            raise FormatError(f"{message}: it needs a newer deltamesh", offsets[field])
    bits = values["bits"]
    parameters = Parameters(
        method=_METHODS[values["method"]],
        diffusion=bool(values["flags"] & layout.FLAG_DIFFUSION),
        anchor_method=_ANCHOR_METHODS[values["anchor_method"]],
        bits=None if bits == layout.BITS_FROM_STEP else bits,
        step=values["step"],
        origin=(values["origin_x"], values["origin_y"], values["origin_z"]),
        anchor_step=values["anchor_step"],
        seed=values.get("seed", 0),
        anchor_count=values["anchor_count"],
        isolated=values["isolated"],
        coarse=values["coarse"],
        dead_zone=values["dead_zone"] / ZONE_UNIT,
        normal_dead_zone=values["normal_dead_zone"] / ZONE_UNIT,
        single=bool(values["flags"] & layout.FLAG_SINGLE),
        interpolated=bool(values["flags"] & layout.FLAG_INTERPOLATED),
    )
    for field, message in parameter_faults(parameters, vertices):
        raise FormatError(message, offsets[field])
    return parameters


def write_parameters(parameters: Parameters) -> bytes:
    """Return the payload of `PARM`.

    Raises
    ------
    MeshError
        For a value that its field does not hold.
    """
    p = parameters
    flags = p.diffusion * layout.FLAG_DIFFUSION | p.single * layout.FLAG_SINGLE
    values = {
        "method": METHODS[p.method].id,
        "flags": flags | p.interpolated * layout.FLAG_INTERPOLATED,
        "anchor_method": layout.ANCHOR_METHODS[p.anchor_method],
        "bits": layout.BITS_FROM_STEP if p.bits is None else p.bits,
        "step": p.step,
        "origin_x": p.origin[0],
        "origin_y": p.origin[1],
        "origin_z": p.origin[2],
        "anchor_step": p.anchor_step,
        "seed": p.seed,
        "anchor_count": p.anchor_count,
        "isolated": p.isolated,
        "coarse": p.coarse,
        "dead_zone": round(p.dead_zone * ZONE_UNIT),
        "normal_dead_zone": round(p.normal_dead_zone * ZONE_UNIT),
    }
    fields: tuple[Field, ...] = layout.PARAMETER_FIELDS
    if p.anchor_method == RANDOM:
        fields += layout.SEED_FIELDS
    return write_fields(fields, values)
