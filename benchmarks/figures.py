"""Plots of measurements, for paper and screen."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING

from deltamesh.bench import Measurement

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

Style = tuple[str, str, str]

# What a family of codecs is called in a legend, if not by its label.
_NAMES = {
    "refined": "deltamesh, refined high-pass",
    "highpass": "deltamesh, high-pass",
    "highpass diffusion=False": "high-pass, plain rounding",
    "cartesian": "deltamesh, Cartesian",
    "auto": "deltamesh",
    "draco": "Draco, level 10",
    "meshopt": "meshoptimizer + zstd -19",
    "zstd": "zstd -19, float32 arrays",
}
# Colours that colour-blind readers can tell apart (M. Okabe, K. Ito, "Color Universal Design",
# 2008), and markers for those who print in grey.
_STYLES = (
    ("#D55E00", "o", "-"),
    ("#E69F00", "s", "-"),
    ("#CC79A7", "^", "-"),
    ("#0072B2", "D", "-"),
    ("#000000", "X", "--"),
    ("#009E73", "v", "--"),
    ("#56B4E9", "P", "--"),
)
# An RMS distance over the diagonal that is rounding to float32, or less.
NEGLIGIBLE = 1e-7
_NO_ERROR = "RMS < $10^{-7}$"
_PANELS = {
    "normal_deg": "mean face-normal deviation [degrees]",
    "dihedral_deg": "mean dihedral-angle error [degrees]",
    "visual": "visual error / diagonal",
    "rms": "RMS vertex distance / diagonal",
    "hausdorff": "Hausdorff distance / diagonal",
}


def curves(found: Mapping[str, Sequence[Measurement]], title: str) -> Figure:
    """Plot errors over bits per vertex, both logarithmic, a panel an error.

    Parameters
    ----------
    found : mapping of str to sequence of Measurement
        By family; each is a curve. What has no error to speak of would squeeze all others into a
        corner: the legend tells its bits per vertex.
    title : str
        Of the legend.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.5, 6.6), layout="constrained")
    axes = figure.subplots(2, 3).ravel()
    lossy = {family: points for family, points in found.items() if _is_lossy(points)}
    styles = dict(zip(lossy, cycle(_STYLES), strict=False))
    for axis, (error, label) in zip(axes, _PANELS.items(), strict=False):
        for family, points in lossy.items():
            _plot(axis, points, error, styles[family])
        _dress(axis, label)
    handles = [_handle(_name(family), styles[family]) for family in lossy]
    for family in (one for one in found if one not in lossy):
        rate = ", ".join(f"{p.bpv:.1f}" for p in found[family])
        handles.append(_handle(f"{_name(family)}:\n{rate} bits/vertex, {_NO_ERROR}"))
    axes[-1].axis("off")
    legend = axes[-1].legend(handles=handles, loc="center", frameon=False, fontsize=9)
    legend.set_title(title, {"size": "large"})
    legend.set_in_layout(False)
    return figure


def _is_lossy(points: Sequence[Measurement]) -> bool:
    return any(p.rms > NEGLIGIBLE for p in points)


def _plot(axis: Axes, points: Sequence[Measurement], error: str, style: Style) -> None:
    """Draw a curve through the points that have an error."""
    colour, marker, line = style
    pairs = sorted((p.bpv, getattr(p, error)) for p in points if getattr(p, error) > 0)
    xs, ys = [x for x, _ in pairs], [y for _, y in pairs]
    axis.plot(xs, ys, color=colour, marker=marker, linestyle=line, markersize=4, linewidth=1.2)


def _dress(axis: Axes, label: str) -> None:
    """Set scales, labels and a grid; bits are told as plain numbers."""
    from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

    axis.set_xscale("log", base=2)
    axis.set_yscale("log")
    axis.xaxis.set_major_formatter(ScalarFormatter())
    axis.xaxis.set_minor_locator(LogLocator(base=2, subs=(1.25, 1.5, 1.75)))
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.set_xlabel("bits per vertex, whole file")
    axis.set_ylabel(label)
    axis.grid(True, which="major", color="0.85", linewidth=0.6)
    axis.set_axisbelow(True)


def _name(family: str) -> str:
    return textwrap.fill(_NAMES.get(family, family), 36)


def _handle(name: str, style: Style = ("none", "", "")) -> Line2D:
    from matplotlib.lines import Line2D

    colour, marker, line = style
    return Line2D([], [], color=colour, marker=marker, linestyle=line, markersize=5, label=name)


def save(figure: Figure, path: Path) -> None:
    """Write a figure; the same data give the same bytes."""
    figure.savefig(path, dpi=200, metadata={"Software": None})
