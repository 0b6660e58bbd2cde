"""Measurements of codecs on meshes: bytes, errors, seconds.

A codec is named by a label, one line of text that says everything needed to repeat a measurement:
"refined bits=6 coarse=4", "draco bits=11", "zstd". The options of ours are those of
`deltamesh.encode` that are not at their defaults.
"""

from __future__ import annotations

import ast
import dataclasses
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

import numpy as np

from deltamesh._codec.decoding import decode
from deltamesh._measures.metrics import compare
from deltamesh._measures.table import METRICS
from deltamesh._mesh import TriangleMesh, triangulated
from deltamesh._options import CHOICES, Options
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh.bench._peers import PEERS, Coded, settings_of
from deltamesh_formats.arguments import require_type
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import DeltameshError, OptionError
from deltamesh_formats.polymesh.mesh import PolyMesh, from_triangles

# Options that no byte of a file that is measured here depends on.
_SILENT: Final = ("solver", "threads", "source_format")


@dataclass(frozen=True)
class Codec:
    """A codec with its options.

    Attributes
    ----------
    label : str
    code : callable
        Encodes a mesh and decodes the file.
    """

    label: str
    code: Callable[[TriangleMesh], Coded]


@dataclass(frozen=True)
class Measurement:
    """A mesh under a codec.

    Attributes
    ----------
    mesh, codec : str
        The mesh's name and the codec's label.
    vertices, faces : int
        Of the decoded mesh.
    bytes : int
        Of the whole file.
    rms, max, hausdorff, visual : float
        Fractions of the bounding box diagonal; see `deltamesh._measures.metrics`.
    normal_deg, dihedral_deg : float
        Degrees.
    encode_seconds, decode_seconds : float
    sections : mapping of str to int
        Bytes of each section, its framing included; empty for other codecs.
    """

    mesh: str
    codec: str
    vertices: int
    faces: int
    bytes: int
    rms: float
    max: float
    hausdorff: float
    visual: float
    normal_deg: float
    dihedral_deg: float
    encode_seconds: float
    decode_seconds: float
    sections: Mapping[str, int]

    @property
    def bpv(self) -> float:
        """Bits per vertex of the whole file."""
        return 8 * self.bytes / max(self.vertices, 1)


def measure(name: str, mesh: PolyMesh | TriangleMesh, codec: Codec) -> Measurement:
    """Encode the triangles of a mesh, decode the file, and compare.

    Parameters
    ----------
    name : str
        Name of the mesh in the result.
    mesh : PolyMesh or TriangleMesh
    codec : Codec
        From `codec_of`.

    Raises
    ------
    MeshError, OptionError, TargetError, SolveError
        As `deltamesh.encode`.
    """
    return measured(name, mesh, codec)[0]


def measured(name: str, mesh: PolyMesh | TriangleMesh, codec: Codec) -> tuple[Measurement, Coded]:
    """Return what `measure` does, and what the codec made of the mesh."""
    coded = codec.code(triangulated(mesh) if isinstance(mesh, PolyMesh) else mesh)
    errors = compare(coded.reference, coded.decoded)
    unit = errors.diagonal or 1.0
    measurement = Measurement(
        mesh=name,
        codec=codec.label,
        vertices=len(coded.decoded.vertices),
        faces=len(coded.decoded.faces),
        bytes=coded.size,
        **{m.column: getattr(errors, m.name) / (unit if m.is_length else 1.0) for m in METRICS},
        encode_seconds=coded.encode_seconds,
        decode_seconds=coded.decode_seconds,
        sections=coded.sections,
    )
    return measurement, coded


def code(options: Options, mesh: TriangleMesh) -> Coded:
    """Encode a mesh with `options` and decode the file, which names no source format."""
    options = dataclasses.replace(options, source_format="")
    start = time.perf_counter()
    encoded = encode_mesh(from_triangles(mesh.vertices, mesh.faces), options)
    middle = time.perf_counter()
    # The decoder's own mesh, not the encoder's idea of it, without a limit to its memory.
    container = read_container(encoded.data)
    decoded = decode(container, solver=options.solver, threads=options.threads, memory=sys.maxsize)
    end = time.perf_counter()
    return Coded(
        size=len(encoded.data),
        reference=TriangleMesh(mesh.vertices[encoded.order], encoded.mesh.triangles),
        decoded=triangulated(decoded),
        encode_seconds=middle - start,
        decode_seconds=end - middle,
        sections={section.id: section.size for section in container.sections.values()},
        data=encoded.data,
    )


def deltamesh_codec(options: Options) -> Codec:
    """Return our own codec with these options."""
    return Codec(label(options), partial(code, options))


def label(options: Options) -> str:
    """Return the method and the options that are not at their defaults, as `codec_of` reads it."""
    fields = [one for one in dataclasses.fields(options) if one.name not in ("method", *_SILENT)]
    values = [(one.name, getattr(options, one.name), one.default) for one in fields]
    words = [f"{name}={value}" for name, value, default in values if value != default]
    return " ".join([options.method, *words])


def codec_of(text: str, **more: Any) -> Codec:
    """Return the codec that a label names.

    Parameters
    ----------
    text : str
        Such as "highpass step=0.01 diffusion=False" or "draco bits=11".
    **more
        Further options of `deltamesh.encode`, such as the solver; they mean nothing to others.

    Raises
    ------
    OptionError
        If there is no such codec, or no such option of it.
    """
    require_type("text", text, str)
    name, *words = text.split() or [""]
    settings = dict(_setting(word) for word in words)
    if name in PEERS:
        return Codec(text, partial(_peer, name, settings_of(name, settings)))
    if name not in CHOICES:
        known = ", ".join((*CHOICES, *PEERS))
        raise OptionError(f"{name!r} is no codec; there are {known}")
    try:
        return deltamesh_codec(Options(method=name, **settings, **more))
    except TypeError as error:
        raise OptionError(f"{text!r} has an option that is unknown or makes no sense") from error


def _peer(name: str, settings: Mapping[str, Any], mesh: TriangleMesh) -> Coded:
    return PEERS[name].code(mesh, **settings)


def _setting(word: str) -> tuple[str, Any]:
    """Return the name and the value of `name=value`; text beside literals stays text."""
    name, equals, text = word.partition("=")
    if not (name and equals):
        raise OptionError(f"{word!r} is not an option, such as bits=6")
    try:
        return name, ast.literal_eval(text)
    except (ValueError, SyntaxError):
        return name, text


def warm_up(codec: Codec) -> None:
    """Code a tetrahedron, so that loading modules does not count as time to encode."""
    faces = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
    vertices = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    try:
        measure("", TriangleMesh(vertices, faces), codec)
    except DeltameshError:
        return  # a target that a tetrahedron cannot meet; the modules have been loaded
