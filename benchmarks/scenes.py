"""Pictures of meshes: panels side by side, flat-shaded, rendered by pyvista without a display.

pyvista, the extra `view`, is imported where it is used. Without a display its VTK renders by the
system's EGL, with or without a GPU.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from deltamesh._measures.metrics import diagonal
from deltamesh._mesh import TriangleMesh

if TYPE_CHECKING:
    from PIL.Image import Image

# What is rendered larger and averaged has smooth silhouettes and lettering; faces stay flat.
SUPERSAMPLING = 2
# Of each channel. Bands cannot be seen yet, and files are smaller than with 8.
BITS = 7
_SURFACE = {"color": "#e2e2e2", "ambient": 0.12, "diffuse": 0.85, "specular": 0.1}
_LIT = {"specular_power": 25, "interpolation": "flat", "smooth_shading": False}
# In the camera's frame. The main light grazes, so that a small change of a normal is a large one of
# its shade; the other keeps shadows readable.
_LIGHTS = (((-1.0, 1.0, 0.8), 0.9), ((1.0, -0.4, 0.7), 0.3))


@dataclass(frozen=True)
class Look:
    """From where a mesh is looked at.

    Attributes
    ----------
    towards : tuple of float
        From the mesh to the camera, of any length.
    up : tuple of float
    focus : tuple of float
        The point in the middle of the picture, in fractions of the bounding box.
    height : float
        Of what the picture shows, in diagonals of the bounding box.
    """

    towards: tuple[float, float, float]
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    focus: tuple[float, float, float] = (0.5, 0.5, 0.5)
    height: float = 1.0


@dataclass(frozen=True)
class Panel:
    """One picture of a figure.

    Attributes
    ----------
    mesh : TriangleMesh
    frame : TriangleMesh
        Whose bounding box the look is measured in: the original, so that cameras do not move.
    look : Look
    text : str
        Below the picture.
    values : float64 (n,), optional
        At the vertices, shown as colours.
    points : float64 (k, 3), optional
        Shown as dots.
    """

    mesh: TriangleMesh
    frame: TriangleMesh
    look: Look
    text: str = ""
    values: NDArray[np.float64] | None = None
    points: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class Scale:
    """What the colours of a figure mean: a title, and where they begin and end.

    They are on a logarithmic scale, unless the least value is not positive.
    """

    title: str
    low: float
    high: float

    @property
    def is_logarithmic(self) -> bool:
        """Whether values are positive."""
        return self.low > 0


def draw(rows: Sequence[Sequence[Panel]], size: tuple[int, int], scale: Scale | None) -> Image:
    """Render a figure.

    Parameters
    ----------
    rows : sequence of sequences of Panel
        All of one length.
    size : tuple of int
        Width and height in pixels.
    scale : Scale or None
        Of the panels that have values.
    """
    import pyvista
    from PIL import Image

    plotter = pyvista.Plotter(
        off_screen=True,
        shape=(len(rows), len(rows[0])),
        window_size=[SUPERSAMPLING * side for side in size],
        border=False,
        lighting="none",
    )
    for position, intensity in _LIGHTS:
        light = pyvista.Light(position=position, intensity=intensity, light_type="camera light")
        plotter.add_light(light)  # to all panels
    for i, row in enumerate(rows):
        for j, panel in enumerate(row):
            plotter.subplot(i, j)
            _show(plotter, panel, scale)
    image = Image.fromarray(plotter.screenshot(return_img=True))
    plotter.close()
    return image.reduce(SUPERSAMPLING)


def save(image: Image, path: Path) -> None:
    """Write a small PNG."""
    from PIL import ImageOps
    from PIL.Image import Dither, Quantize

    # Greys stay as they are. Maximum coverage: colours that are rare count, as a scale's ends are.
    image = ImageOps.posterize(image, BITS)
    image = image.quantize(method=Quantize.MAXCOVERAGE, dither=Dither.NONE)
    image.save(path, optimize=True)


def _show(plotter: Any, panel: Panel, scale: Scale | None) -> None:
    """Put a panel into the current part of the window."""
    import pyvista

    plotter.set_background("white")
    surface = pyvista.PolyData.from_regular_faces(panel.mesh.vertices, panel.mesh.faces)
    if panel.values is None or scale is None:
        plotter.add_mesh(surface, **_SURFACE, **_LIT)
    else:
        least = scale.low / 10 if scale.is_logarithmic else scale.low
        surface["values"] = np.maximum(panel.values, least)
        plotter.add_mesh(
            surface,
            scalars="values",
            cmap="viridis" if scale.is_logarithmic else "coolwarm",
            log_scale=scale.is_logarithmic,
            clim=(scale.low, scale.high),
            lighting=False,
            show_scalar_bar=False,
        )
        if scale.is_logarithmic:
            plotter.add_scalar_bar(title=scale.title, **_bar())
    if panel.points is not None:
        dots = pyvista.PolyData(panel.points)
        size = 2.5 * SUPERSAMPLING
        plotter.add_mesh(dots, color="#c02020", point_size=size, render_points_as_spheres=True)
    if panel.text:
        size = 8 * SUPERSAMPLING
        where = {"position": (0.03, 0.03), "viewport": True}
        plotter.add_text(panel.text, font_size=size, color="black", **where)
    _aim(plotter, panel)


def _bar() -> dict[str, Any]:
    return {
        "position_x": 0.55,
        "position_y": 0.03,
        "height": 0.13,
        "width": 0.4,
        "n_labels": 3,
        "fmt": "%.0e",
        "color": "black",
        "title_font_size": 13 * SUPERSAMPLING,
        "label_font_size": 13 * SUPERSAMPLING,
    }


def _aim(plotter: Any, panel: Panel) -> None:
    """Place the camera, without perspective."""
    V, look = panel.frame.vertices, panel.look
    unit = diagonal(V)
    focus = V.min(axis=0) + np.array(look.focus) * np.ptp(V, axis=0)
    towards = np.array(look.towards) / np.linalg.norm(look.towards)
    plotter.camera_position = [focus + 3 * unit * towards, focus, look.up]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = look.height * unit / 2
    plotter.renderer.reset_camera_clipping_range()
