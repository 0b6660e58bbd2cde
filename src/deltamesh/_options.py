"""Options of the encoder, and the one place where they are checked."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import TypedDict

from deltamesh._methods import AUTO, BOUNDS, METHOD_OPTIONS, METHODS, RATES
from deltamesh_formats.arguments import (
    is_real,
    require,
    require_above_0,
    require_flag,
    require_limit,
    require_number,
    require_one_of,
    require_type,
    require_whole,
)
from deltamesh_formats.container import layout
from deltamesh_formats.container.fields import STRING_MAX_BYTES
from deltamesh_formats.container.method_layouts import MethodLayout
from deltamesh_formats.container.payload_layout import (
    MAX_GRID_BITS,
    MAX_LIMB_BITS,
    MAX_NORMAL_BITS,
    MAX_RUN,
    MIN_NORMAL_BITS,
)
from deltamesh_formats.errors import OptionError

CHOICES = (AUTO, *METHODS)
ANCHOR_METHODS = tuple(sorted(filter(None, layout.ANCHOR_METHODS)))
# The step of the deltas that get refined along the normals, in steps of these refinements.
DEFAULT_COARSE = 4.5
SOLUTIONS = (INTERPOLATED, LEAST_SQUARES) = (layout.INTERPOLATED, layout.LEAST_SQUARES)
MAX_COARSE = 64.0
SOLVERS = ("auto", "core", "rslab", "pardiso", "scipy")
DEFAULT_QUALITY, MAX_QUALITY = 5, 9
# Efforts of the search for fewer bytes: none, among the likeliest settings, among all.
DEFAULT_EFFORT, MAX_EFFORT = 2, 3
MAX_BITS = MAX_GRID_BITS
# Of texture coordinates, of the largest extent, and of both coordinates of a normal.
DEFAULT_BITS_UV, MAX_BITS_UV = 12, MAX_LIMB_BITS
DEFAULT_BITS_NORMAL = 10
MIN_BITS_NORMAL, MAX_BITS_NORMAL = MIN_NORMAL_BITS, MAX_NORMAL_BITS
# Options that let attributes lose what they would keep by default, or say how much.
ATTRIBUTE_BOUNDS = ("bits_float", "max_uv_error", "max_attribute_error")
MAX_THREADS = 1024
MAX_SEED = (1 << 64) - 1
# Of a sequence, a frame in so many is a key frame.
DEFAULT_KEY_EVERY, MAX_KEY_EVERY = 16, MAX_RUN
# Options that mean nothing for one mesh.
SEQUENCE_OPTIONS = ("fps", "key_every")


class EncodeOptions(TypedDict, total=False):
    """Keywords of `deltamesh.encode`, which documents them, for functions that hand them on."""

    method: str
    bits: int | None
    step: float | None
    quality: int | None
    normal_error: float | None
    dihedral_error: float | None
    rms_error: float | None
    rms_error_rel: float | None
    max_error: float | None
    max_error_rel: float | None
    only: bool
    effort: int
    diffusion: bool
    anchors: int | float | None
    anchor_method: str | None
    seed: int
    coarse: float | None
    solution: str | None
    solver: str
    threads: int | None
    drop_isolated: bool
    keep_order: bool
    drop: str | Iterable[str]
    bits_uv: int
    bits_normal: int
    bits_float: int | None
    max_uv_error: float | None
    max_attribute_error: Mapping[str, float] | None
    lossless_attributes: bool
    fps: float | None
    key_every: int
    importance: str | Iterable[float] | None
    source_format: str
    progress: Callable[[str], None] | None


@dataclass(frozen=True)
class Options:
    """Options of the encoder, checked; `deltamesh.encode` documents each.

    Raises
    ------
    OptionError
        For the first option that is unknown, out of range, or contradicts another.
    """

    method: str = AUTO
    bits: int | None = None
    step: float | None = None
    quality: int | None = None
    normal_error: float | None = None
    dihedral_error: float | None = None
    rms_error: float | None = None
    rms_error_rel: float | None = None
    max_error: float | None = None
    max_error_rel: float | None = None
    only: bool = False
    effort: int = DEFAULT_EFFORT
    diffusion: bool = True
    anchors: int | float | None = None
    anchor_method: str | None = None
    seed: int = 0
    solver: str = "auto"
    threads: int | None = None
    coarse: float | None = None
    solution: str | None = None
    drop_isolated: bool = False
    keep_order: bool = False
    drop: tuple[str, ...] = ()
    bits_uv: int = DEFAULT_BITS_UV
    bits_normal: int = DEFAULT_BITS_NORMAL
    bits_float: int | None = None
    max_uv_error: float | None = None
    max_attribute_error: Mapping[str, float] | None = None
    lossless_attributes: bool = False
    fps: float | None = None
    key_every: int = DEFAULT_KEY_EVERY
    importance: str | Iterable[float] | None = None
    source_format: str = ""

    def __post_init__(self) -> None:
        require_one_of("method", self.method, CHOICES)
        for name in ("only", "diffusion", "drop_isolated", "keep_order", "lossless_attributes"):
            require_flag(name, getattr(self, name))
        if self.anchor_method is not None:
            require_one_of("anchor_method", self.anchor_method, ANCHOR_METHODS)
        if self.solution is not None:
            require_one_of("solution", self.solution, SOLUTIONS)
            bare = self.solution == INTERPOLATED and self.bits == 0
            if bare:
                raise OptionError("of 0 bits, anchors are not interpolated: they would be spikes")
        require_one_of("solver", self.solver, SOLVERS)
        self._check_rate()
        require_whole("effort", self.effort, 1, MAX_EFFORT)
        if self.coarse is not None:
            require_number("coarse", self.coarse, 1, MAX_COARSE)
        require_whole("bits_uv", self.bits_uv, 1, MAX_BITS_UV)
        require_whole("bits_normal", self.bits_normal, MIN_BITS_NORMAL, MAX_BITS_NORMAL)
        if self.bits_float is not None:
            require_whole("bits_float", self.bits_float, 1, MAX_BITS_UV)
        self._check_attribute_errors()
        names = all(isinstance(name, str) for name in self.drop)
        require(names, "drop must be names", self.drop)
        if self.anchors is not None:
            require(is_real(self.anchors), "anchors must be a count or a fraction", self.anchors)
        require_whole("seed", self.seed, 0, MAX_SEED)
        if self.threads is not None:
            require_whole("threads", self.threads, 1, MAX_THREADS)
        if self.fps is not None:
            require_above_0("fps", self.fps)
        require_whole("key_every", self.key_every, 1, MAX_KEY_EVERY)
        require_type("source_format", self.source_format, str)
        most = STRING_MAX_BYTES
        fits = self.source_format.isprintable() and len(self.source_format.encode()) <= most
        rule = f"source_format must be printable, and at most {most} bytes"
        require(fits, rule, self.source_format)

    def _check_attribute_errors(self) -> None:
        if self.max_uv_error is not None:
            require_above_0("max_uv_error", self.max_uv_error)
        if self.max_attribute_error is None:
            return
        require_type("max_attribute_error", self.max_attribute_error, Mapping)
        for name, error in self.max_attribute_error.items():
            named = isinstance(name, str) and bool(name)
            require(named, "max_attribute_error must have names", name)
            require_above_0(f"max_attribute_error of {name!r}", error)

    def _check_rate(self) -> None:
        # Options with defaults may be left as they are with any method.
        names = (*RATES, *BOUNDS, *ATTRIBUTE_BOUNDS, "coarse", "importance")
        given = [name for name in names if getattr(self, name) is not None]
        given += [name for name in ("only", "lossless_attributes") if getattr(self, name)]
        check_together(self.method, given)
        for name in ("step", *BOUNDS[1:]):
            if (value := getattr(self, name)) is not None:
                require_above_0(name, value)
        if self.quality is not None:
            require_whole("quality", self.quality, 1, MAX_QUALITY)
        if self.bits is not None:
            # Of 0 bits, the connectivity and the anchors make a surface; nothing else does.
            bare = self.method == AUTO or METHODS[self.method].layout.bare
            require_whole("bits", self.bits, 0 if bare else 1, MAX_BITS)
            if self.bits == 0 and self.importance is not None:
                raise OptionError("importance means nothing with 0 bits")

    @property
    def asks_nothing(self) -> bool:
        """Whether method, rate and bounds are all left to the encoder."""
        rate = any(getattr(self, name) is not None for name in RATES)
        return self.method == AUTO and not rate and not self.is_bounded

    @property
    def is_bounded(self) -> bool:
        """Whether any bound was given."""
        return any(getattr(self, name) is not None for name in BOUNDS)

    @property
    def attribute_errors(self) -> dict[str, float]:
        """The largest errors of attributes, by names and roles."""
        errors = dict(self.max_attribute_error or {})
        if self.max_uv_error is not None:
            errors["uv"] = min(self.max_uv_error, errors.get("uv", math.inf))
        return errors

    @property
    def exact(self) -> bool:
        """Whether positions are kept to the last bit."""
        return self.method != AUTO and METHODS[self.method].layout.exact


def names_of(drop: str | Iterable[str]) -> tuple[str, ...]:
    """Return what is to be left out, one name or several, as names.

    Raises
    ------
    OptionError
        If it is neither.
    """
    require(isinstance(drop, Iterable), "drop must be names", drop)
    return (drop,) if isinstance(drop, str) else tuple(drop)


def check_together(method: str, given: Collection[str], shown: Callable[[str], str] = str) -> None:
    """Refuse options that exclude each other, or mean nothing to the method.

    Parameters
    ----------
    method : str
        Of `CHOICES`.
    given : collection of str
        Names of the options that have been given.
    shown : callable, optional
        The name of an option in messages, such as "--bits" for "bits".

    Raises
    ------
    OptionError
    """
    rates, bounds = ([name for name in names if name in given] for names in (RATES, BOUNDS))
    if rates and len(rates + bounds) > 1:
        raise OptionError(f"{' and '.join(map(shown, rates + bounds))} exclude each other")
    exact = [] if method == AUTO or not METHODS[method].layout.exact else ["method"]
    exact += [name for name in ("lossless_attributes",) if name in given]
    for name in ATTRIBUTE_BOUNDS:
        if name in given and exact:
            other = f"{shown(exact[0])} {method}" if exact[0] == "method" else shown(exact[0])
            raise OptionError(f"{shown(name)} and {other} exclude each other")
    if "only" in given and not bounds:
        raise OptionError(f"{shown('only')} needs a bound: a quality, or the error of a kind")
    known = METHOD_OPTIONS if method == AUTO else METHODS[method].options
    for name in METHOD_OPTIONS:
        if name in given and name not in known:
            raise OptionError(f"{shown(name)} means nothing with {shown('method')} {method}")


@dataclass(frozen=True)
class Settings:
    """Options of one method, without anything left to search for.

    Attributes
    ----------
    method : str
        Of `METHODS`.
    bits : int or None
    step : float or None
        With neither, the method has a default.
    coarse : float
    diffusion : bool
    anchors, anchor_method, seed
        As in `Options`.
    interpolated : bool
        Whether positions go through the anchors.
    largest : float
        Correct the vertices that would be further than that from their input positions.
    exponents : bytes
        Of the step of each vertex of the faces in coding order, in quarters of an octave below
        `step`; the smallest is 0. None: all vertices have the same step.
    coarser : bytes
        By how many quarters of an octave the step of each of these vertices is coarser than that,
        since it is less important; the smallest is 0. None: all are important.
    no_bits : bytes
        Whether each of these vertices has no importance at all, 0 or 1. None: all have some.
    """

    method: str
    bits: int | None = None
    step: float | None = None
    coarse: float = DEFAULT_COARSE
    diffusion: bool = True
    anchors: int | float | None = None
    anchor_method: str | None = None
    seed: int = 0
    interpolated: bool = False
    largest: float = math.inf
    exponents: bytes = b""
    coarser: bytes = b""
    no_bits: bytes = b""

    @property
    def layout(self) -> MethodLayout:
        """What the container knows of the method."""
        return METHODS[self.method].layout


def settings_of(options: Options, method: str) -> Settings:
    """Return the settings that options ask of a method, whatever their bounds."""
    solution = options.solution or METHODS[method].solution
    return Settings(
        method=method,
        bits=options.bits,
        step=None if options.step is None else float(options.step),
        coarse=options.coarse or DEFAULT_COARSE,
        diffusion=options.diffusion,
        anchors=options.anchors,
        anchor_method=options.anchor_method,
        seed=options.seed,
        interpolated=solution == INTERPOLATED and options.bits != 0,
    )


def check_decoding(solver: str, threads: int | None, max_vertices: float, memory: float) -> None:
    """Refuse arguments of a decoder that are of a wrong type, or out of range.

    Raises
    ------
    OptionError
    """
    require_one_of("solver", solver, SOLVERS)
    if threads is not None:
        require_whole("threads", threads, 1, MAX_THREADS)
    require_limit("max_vertices", max_vertices)
    require_limit("memory", memory)
