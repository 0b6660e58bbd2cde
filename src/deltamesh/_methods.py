"""Methods of geometry as values: all that the codec knows of one beside its functions.

The table of the container (`deltamesh_formats.container.method_layouts.METHODS`) has what files say
of a method, this one what encoder, decoder and command line go by; `deltamesh._geometry.methods`
has the functions. Nothing here imports them, so that the command line starts fast.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from deltamesh_formats.container import layout, method_layouts
from deltamesh_formats.container.layout import FARTHEST, GREEDY
from deltamesh_formats.container.method_layouts import MethodLayout

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
class Memory:
    """Bytes that decoding takes at most: coder tables and modules; and what grows with the mesh.

    They are measured as peak memory of whole processes (`benchmarks/memory.py`), and rounded up.
    """

    fixed: int
    per_vertex: int


# Of interpolated anchors, multigrid and the two surfaces of the refined method; of least squares,
# factorization and its solves.
INTERPOLATED: Final = Memory(64 << 20, 400)
LEAST_SQUARES: Final = Memory(256 << 20, 4000)


@dataclass(frozen=True)
class Method:
    """A geometry method.

    Attributes
    ----------
    layout : MethodLayout
        Its name and title, its sections, and whether it is anchored, exact, or coarse.
    memory : Memory or None
        Of decoding; None with anchors, where their solution decides.
    options : tuple of str
        The options of the encoder that mean something to it and not to all methods.
    solution : str
        What positions make of deltas and anchors by default; empty without anchors.
    anchor_method : str
        The choice of anchors by default where positions are those of least squares, and neither
        mesh nor anchors are many.
    first_step : float
        Where the search begins: the step over the mean edge for a mean normal deviation of one
        degree, at the default coarse factor; medians over scans and CAD parts. 0 without a search.
    """

    layout: MethodLayout
    memory: Memory | None
    options: tuple[str, ...] = ()
    solution: str = ""
    anchor_method: str = FARTHEST
    first_step: float = 0.0

    @property
    def name(self) -> str:
        """The name, as options and files have it."""
        return self.layout.name


REFINED: Final = Method(
    method_layouts.METHODS["refined"],
    memory=None,
    options=(*RATES, *BOUNDS, *ANCHORING, "coarse", "importance"),
    solution=layout.INTERPOLATED,
    first_step=0.11,
)
HIGHPASS: Final = Method(
    method_layouts.METHODS["highpass"],
    memory=None,
    options=(*RATES, *BOUNDS, *ANCHORING, "importance"),
    solution=layout.LEAST_SQUARES,
    anchor_method=GREEDY,
    first_step=0.12,
)
CARTESIAN: Final = Method(
    method_layouts.METHODS["cartesian"],
    memory=Memory(64 << 20, 300),
    options=(*RATES, *BOUNDS, "importance"),
    first_step=0.03,
)
LOSSLESS: Final = Method(
    method_layouts.METHODS["lossless"],
    memory=Memory(64 << 20, 400),
)

# In the order in which they are offered.
METHODS: Final[Mapping[str, Method]] = {
    method.name: method for method in (REFINED, HIGHPASS, CARTESIAN, LOSSLESS)
}
# The options that not all methods take.
METHOD_OPTIONS: Final = tuple(
    dict.fromkeys(name for method in METHODS.values() for name in method.options)
)
