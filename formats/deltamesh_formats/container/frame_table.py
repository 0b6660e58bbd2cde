"""Frames of a `.dmesh` file beyond the first: how each is coded, and its streams; SPEC.md 5.22.

Plain bytes, so that programs can list frames without decoding any, and without numpy. `read_frames`
and `write_frames` are mirrors.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from deltamesh_formats.container.container import Container, Parameters, Section
from deltamesh_formats.container.fields import (
    CRC_SIZE,
    check_crc,
    read_fields,
    read_varint,
    struct_of,
    take,
    varint_size,
    with_crc,
    write_fields,
    write_varint,
)
from deltamesh_formats.container.layout import CELLS, CORRECTIONS, FRAMES, ID_SIZE
from deltamesh_formats.container.method_layouts import METHODS
from deltamesh_formats.container.payload_layout import (
    FRAME_CELLS,
    FRAME_CORRECTIONS,
    FRAME_FIELDS,
    FRAME_KEY,
    MAP_FIELDS,
    MAPS,
    MAX_FINER,
    MAX_MAP_UNIT,
    MAX_RUN,
    SEQUENCE_FIELDS,
)
from deltamesh_formats.container.sections import payload_of
from deltamesh_formats.errors import FormatError, located

# A record has that many bytes or more.
_LEAST_RECORD: Final = struct_of(FRAME_FIELDS[:-1]).size + CRC_SIZE
_ERRORS: Final = ("rms", "max", "normal", "dihedral")


@dataclass(frozen=True)
class Frame:
    """A frame of a sequence beyond the first.

    Attributes
    ----------
    index : int
        From 1 on.
    is_key : bool
        Whether it is predicted from frame 0, and not from the frame before.
    finer : int
        How often its grid has halved that of frame 0.
    step, coarse : float
        As in `Parameters`.
    rms, max : float
        Distances between input and decoded vertices, over the diagonal of the frame.
    normal, dihedral : float
        Mean deviation of the face normals and of the dihedral angles, in degrees.
    maps : int
        Number of linear maps by which the deltas are predicted; 0 for none.
    rounds, unit : int
        Of these: rounds of smoothing, and their numbers are multiples of 2^-unit.
    digest : bytes, 8
        Checksum of the decoded integers.
    sections : mapping of str to Section
        The streams, with their places in the file.
    offset, size : int
        Where its record begins in the file, and how many bytes that has.
    """

    index: int
    is_key: bool
    finer: int
    step: float
    coarse: float
    rms: float
    max: float
    normal: float
    dihedral: float
    maps: int
    rounds: int
    unit: int
    digest: bytes
    sections: Mapping[str, Section] = field(repr=False)
    offset: int
    size: int


def frames_of(container: Container) -> tuple[float, tuple[Frame, ...]]:
    """Return the rate of a file, in frames a second, 0 if it is unknown, and its further frames.

    Raises
    ------
    FormatError
    """
    if FRAMES not in container.sections:
        return 0.0, ()
    with payload_of(container.sections[FRAMES]) as payload:
        start = container.sections[FRAMES].start
        return read_frames(payload, start, container.parameters, container.vertices)


def read_frames(
    payload: memoryview, start: int, parameters: Parameters, vertices: int
) -> tuple[float, tuple[Frame, ...]]:
    """Return the rate and the frames in the payload of FRAM, which begins at byte `start`.

    Raises
    ------
    FormatError
        The offset counts from the beginning of the payload.
    """
    values, offsets, at = read_fields(payload, 0, SEQUENCE_FIELDS)
    rate, count = values["rate"], values["count"]
    if not (math.isfinite(rate) and rate >= 0):
        raise FormatError(f"a rate of {rate} frames a second", offsets["rate"])
    if parameters.step == 0:
        raise FormatError("frames in a file of 0 bits", 0)
    if not 0 < count <= (len(payload) - at) // _LEAST_RECORD:
        raise FormatError(f"{count} frames in {len(payload)} bytes", offsets["count"])
    sizes = []
    for _ in range(count):
        size, at = read_varint(payload, at)
        sizes.append(size)
    frames: list[Frame] = []
    run = 0
    for i, size in enumerate(sizes, start=1):
        record = take(payload, at, size)
        with located(at, f"frame {i}: "):
            frame = _read_frame(memoryview(record), start + at, i, parameters, vertices)
            run = 0 if frame.is_key else run + 1
            if run > MAX_RUN:
                raise FormatError(f"more than {MAX_RUN} frames since a key frame", 0)
        frames.append(frame)
        at += size
    if at < len(payload):
        raise FormatError("bytes after the last frame", at)
    return rate, tuple(frames)


def _read_frame(
    record: memoryview, start: int, index: int, parameters: Parameters, vertices: int
) -> Frame:
    """Return the frame in a record; offsets count from its beginning, at byte `start`."""
    end = max(len(record) - CRC_SIZE, 0)
    check_crc(record, 0, end, "the record")
    inside = record[:end]
    values, offsets, at = read_fields(inside, 0, FRAME_FIELDS)
    rounds = unit = 0
    if values["maps"]:
        further, where, at = read_fields(inside, at, MAP_FIELDS)
        rounds, unit = further["rounds"], further["unit"]
        values, offsets = {**values, **further}, {**offsets, **where}
    for name, message in _faults(values, index, parameters, vertices):
        raise FormatError(message, offsets[name])
    sizes = {}
    for name in _streams(parameters.method, values["flags"], values["maps"]):
        sizes[name], at = read_varint(inside, at)
    sections: dict[str, Section] = {}
    for name, size in sizes.items():
        stream = memoryview(take(inside, at, size))
        # As if an id and a length were before it: `Section.start` is where the stream begins.
        offset = start + at - ID_SIZE - varint_size(size)
        sections[name] = Section(name, offset, stream)
        at += size
    if at < end:
        raise FormatError("bytes after the last stream", at)
    return Frame(
        index=index,
        is_key=bool(values["flags"] & FRAME_KEY),
        finer=values["finer"],
        step=values["step"],
        coarse=values["coarse"],
        **{name: values[name] for name in _ERRORS},
        maps=values["maps"],
        rounds=rounds,
        unit=unit,
        digest=values["digest"],
        sections=sections,
        offset=start,
        size=len(record),
    )


def _streams(method: str, flags: int, maps: int) -> Iterator[str]:
    """Yield the names of the streams of a frame, in their order."""
    if maps:
        yield MAPS
    yield from METHODS[method].geometry
    if flags & FRAME_CELLS:
        yield CELLS
    if flags & FRAME_CORRECTIONS:
        yield CORRECTIONS


def _faults(
    values: Mapping[str, float], index: int, parameters: Parameters, vertices: int
) -> Iterator[tuple[str, str]]:
    """Yield (field, what is wrong with it) by the rules of SPEC.md 5.22."""
    method, flags = METHODS[parameters.method], int(values["flags"])
    if flags & ~(FRAME_KEY | FRAME_CELLS | FRAME_CORRECTIONS):
        yield "flags", "reserved bits are set: it needs a newer deltamesh"
    if flags & FRAME_KEY and index == 1:
        yield "flags", "a key frame after frame 0, which is before it in any case"
    if flags & FRAME_CELLS and not parameters.interpolated:
        yield "flags", "vectors of cells that have none"
    if flags & FRAME_CORRECTIONS and not method.corrected:
        yield "flags", f"corrections in a {method.title} file"
    if values["finer"] > MAX_FINER:
        yield "finer", f"a grid halved {values['finer']} times"
    step = values["step"]
    if not (math.isfinite(step) and step > 0):
        yield "step", f"a quantization step of {step}"
    if not method.anchored and step != math.ldexp(parameters.step, -int(values["finer"])):
        yield "step", f"a step of {step} on a grid of another"
    if not (1 <= values["coarse"] < math.inf and (method.coarse or values["coarse"] == 1)):
        yield "coarse", f"method {parameters.method} with deltas {values['coarse']} times as coarse"
    for name in _ERRORS:
        if not (math.isfinite(values[name]) and values[name] >= 0):
            yield name, f"{name} is {values[name]}"
    if values["maps"] > (vertices if method.anchored else 0):
        yield "maps", f"{values['maps']} maps of {vertices} vertices"
    if values.get("unit", 0) > MAX_MAP_UNIT:
        yield "unit", f"a unit of 2^-{values['unit']}"


def write_frames(rate: float, frames: Sequence[Frame], method: str) -> bytes:
    """Return the payload of FRAM.

    Parameters
    ----------
    rate : float
    frames : sequence of Frame
        Their `size` and the places of their sections do not count.
    method : str

    Raises
    ------
    MeshError
        For a value that its field does not hold.
    """
    records = [_record(frame, method) for frame in frames]
    head = write_fields(SEQUENCE_FIELDS, {"rate": rate, "count": len(records)})
    return b"".join([head, *(write_varint(len(one)) for one in records), *records])


def _record(frame: Frame, method: str) -> bytes:
    flags = frame.is_key * FRAME_KEY
    flags |= (CELLS in frame.sections) * FRAME_CELLS
    flags |= (CORRECTIONS in frame.sections) * FRAME_CORRECTIONS
    fields = FRAME_FIELDS + (MAP_FIELDS if frame.maps else ())
    head = write_fields(fields, {**vars(frame), "flags": flags})
    names = _streams(method, flags, frame.maps)
    streams = [bytes(frame.sections[name].payload) for name in names]
    sizes = (write_varint(len(stream)) for stream in streams)
    return with_crc(b"".join([head, *sizes, *streams]))
