"""Functions of the methods: two pairs of mirrors, which each method's module has.

`quantize` <-> `reconstruct` go between positions and integers, `encode` <-> `decode` between
integers and payloads of the container.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Protocol, cast

from deltamesh._geometry.integers import Integers, Quantized
from deltamesh._geometry.prediction import Prediction
from deltamesh._geometry.systems import Systems
from deltamesh._methods import METHODS
from deltamesh._options import Settings
from deltamesh._shape.surface import Surface
from deltamesh_formats.array_types import Floats
from deltamesh_formats.container.container import Parameters, Section


class GeometryCodec(Protocol):
    """The functions of one method."""

    def quantize(
        self,
        surface: Surface,
        vertices: Floats,
        isolated: Floats,
        settings: Settings,
        systems: Systems,
    ) -> Quantized:
        """Choose the parameters, and round positions to integers.

        Parameters
        ----------
        surface : Surface
        vertices, isolated : float64 (n, 3), (i, 3)
            Positions of the vertices of the faces in coding order, and of the others by x.
        settings : Settings
        systems : Systems
            Methods without anchors solve nothing, and ignore it.

        Returns
        -------
        Parameters, Integers, float64 (n + i, 3)
            The last is what `reconstruct` makes of the others.

        Raises
        ------
        MeshError
            If the step is too small for the mesh.
        OptionError, SolveError
        """

    def reconstruct(
        self, surface: Surface, parameters: Parameters, integers: Integers, systems: Systems
    ) -> Floats:
        """Return the positions, float64 (n + i, 3); isolated vertices come last.

        Raises
        ------
        SolveError
        """

    def encode(
        self, surface: Surface, parameters: Parameters, integers: Integers
    ) -> dict[str, bytes]:
        """Return the payloads of the method's sections, by their ids."""

    def decode(
        self, surface: Surface, parameters: Parameters, sections: Mapping[str, Section]
    ) -> Integers:
        """Return the integers in the sections of a file.

        Raises
        ------
        FormatError
        """


class FrameCodec(GeometryCodec, Protocol):
    """The functions of a method that codes further frames, too.

    Where a `predicted` frame is given, deltas are quantized as differences from those it expects.
    """

    def quantize(
        self,
        surface: Surface,
        vertices: Floats,
        isolated: Floats,
        settings: Settings,
        systems: Systems,
        predicted: Prediction | None = None,
    ) -> Quantized:
        """Choose the parameters, and round positions to integers; see `GeometryCodec`."""

    def reconstruct(
        self,
        surface: Surface,
        parameters: Parameters,
        integers: Integers,
        systems: Systems,
        predicted: Prediction | None = None,
    ) -> Floats:
        """Return the positions, float64 (n + i, 3); see `GeometryCodec`."""

    def encode_frame(
        self, surface: Surface, parameters: Parameters, integers: Integers
    ) -> dict[str, bytes]:
        """Return the streams of a frame, whose grid points are relative, by their names."""

    def decode_frame(
        self,
        surface: Surface,
        parameters: Parameters,
        sections: Mapping[str, Section],
        first: Integers,
    ) -> Integers:
        """Return the integers in the streams, with anchors and exponents of the first frame.

        Raises
        ------
        FormatError
        """


def geometry_codec(method: str) -> GeometryCodec:
    """Return the functions of a method: the module of this package that has its name."""
    return cast(GeometryCodec, importlib.import_module(f"{__package__}.{METHODS[method].name}"))


def frame_codec(method: str) -> FrameCodec:
    """Return the functions of a method that codes frames: of all but the exact one."""
    return cast(FrameCodec, geometry_codec(method))
