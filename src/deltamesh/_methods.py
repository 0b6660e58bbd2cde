"""Methods of geometry as values: all that the codec knows of one beside its functions.

The table of the container (`deltamesh_formats.container.layout.METHODS`) has what files say of a
method, this one what encoder, decoder and command line go by; `deltamesh._geometry.methods` has the
functions. Nothing here imports them, so that the command line starts fast.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from deltamesh_formats.container import layout
from deltamesh_formats.container.layout import MethodLayout

# The choice of a method by the search: refined or cartesian, of 0 bits highpass.
AUTO: Final = "auto"

# Options that say how small, at most one of them, and how good, which go together.
RATES: Final = ("bits", "step")
ANGLE_BOUNDS: Final = ("normal_error", "dihedral_error")
DISTANCE_BOUNDS: Final = ("rms_error", "rms_error_rel", "max_error", "max_error_rel")
BOUNDS: Final = ("quality", *ANGLE_BOUNDS, *DISTANCE_BOUNDS)
# Options of the methods that have anchors.
ANCHORING: Final = ("anchors", "anchor_method", "diffusion", "seed", "solution")


@dataclass(frozen=True)
class Method:
    """A geometry method.

    Attributes
    ----------
    layout : MethodLayout
        Its name and title, its sections, and whether it is anchored, exact, or coarse.
    memory, memory_per_vertex : int
        Bytes that decoding takes at most, measured as peak memory of whole processes
        (`benchmarks/memory.py`), and rounded up: coder tables; factorization and its solves.
    options : tuple of str
        The options of the encoder that mean something to it and not to all methods.
    solution : str
        What positions make of deltas and anchors by default; empty without anchors.
    first_step : float
        Where the search begins: the step over the mean edge for a mean normal deviation of one
        degree, at the default coarse factor; medians over scans and CAD parts. 0 without a search.
    """

    layout: MethodLayout
    memory: int
    memory_per_vertex: int
    options: tuple[str, ...] = ()
    solution: str = ""
    first_step: float = 0.0

    @property
    def name(self) -> str:
        """The name, as options and files have it."""
        return self.layout.name


REFINED: Final = Method(
    layout.METHODS["refined"],
    memory=256 << 20,
    memory_per_vertex=4000,
    options=(*RATES, *BOUNDS, *ANCHORING, "coarse"),
    solution=layout.INTERPOLATED,
    first_step=0.117,
)
HIGHPASS: Final = Method(
    layout.METHODS["highpass"],
    memory=256 << 20,
    memory_per_vertex=4000,
    options=(*RATES, *BOUNDS, *ANCHORING),
    solution=layout.LEAST_SQUARES,
    first_step=0.12,
)
CARTESIAN: Final = Method(
    layout.METHODS["cartesian"],
    memory=192 << 20,
    memory_per_vertex=400,
    options=(*RATES, *BOUNDS),
    first_step=0.03,
)
LOSSLESS: Final = Method(
    layout.METHODS["lossless"],
    memory=256 << 20,
    memory_per_vertex=600,
)

# In the order in which they are offered.
METHODS: Final[Mapping[str, Method]] = {
    method.name: method for method in (REFINED, HIGHPASS, CARTESIAN, LOSSLESS)
}
# The options that not all methods take.
METHOD_OPTIONS: Final = tuple(
    dict.fromkeys(name for method in METHODS.values() for name in method.options)
)
