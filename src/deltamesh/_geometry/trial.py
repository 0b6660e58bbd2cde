"""Trial of some settings: a geometry, coded and decoded whole."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias

from deltamesh._geometry.integers import Integers
from deltamesh._measures.measure import Measured
from deltamesh._options import Settings
from deltamesh_formats.array_types import Floats
from deltamesh_formats.caching import cached_property
from deltamesh_formats.container.container import Parameters
from deltamesh_formats.errors import MeshError

# Bytes of a section beside its payload: an id, a length, a checksum.
SECTION: Final = 10


class ScaleError(MeshError):
    """Coordinates too large for a method, whatever its step; for another one they may not be."""


@dataclass(frozen=True)
class Trial:
    """A geometry under some settings: the contents of a file, and what its decoder makes of them.

    Attributes
    ----------
    settings : Settings
    parameters : Parameters
    integers : Integers
    encode : callable
        Makes the payloads, which only a trial within the bounds needs.
    vertices : float64 (n, 3)
        Decoded.
    measured : Measured
    """

    settings: Settings
    parameters: Parameters
    integers: Integers
    encode: Callable[[], dict[str, bytes]]
    vertices: Floats
    measured: Measured

    @cached_property
    def payloads(self) -> dict[str, bytes]:
        """The sections of the geometry, by their ids."""
        return self.encode()

    @property
    def step(self) -> float:
        """The coarsest step of what is most important; that of the parameters at a rate."""
        return self.parameters.step if self.settings.step is None else self.settings.step

    @property
    def size(self) -> int:
        """Bytes of the sections."""
        return sum(SECTION + len(payload) for payload in self.payloads.values())


Attempt: TypeAlias = Callable[[Settings], Trial]
