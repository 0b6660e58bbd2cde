"""Pictures of meshes without a browser, drawn by PyVista (extra `view`) without a display."""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from deltamesh_formats.errors import DeltameshError

if TYPE_CHECKING:
    from deltamesh_formats.array_types import Floats
    from deltamesh_formats.polymesh.mesh import PolyMesh

_PLAIN: Final = "#c4cad0"
_COLOURS: Final = "turbo"
# The light of a picture: smooth, but for edges of so many degrees.
_SURFACE: Final = {"smooth_shading": True, "split_sharp_edges": True, "feature_angle": 50}
# The error at which the scale ends: below it are so many of the vertices.
_MOST_SHOWN: Final = 0.98
_SCALE: Final = {
    "title": "distance / diagonal\n",
    "color": "black",
    "fmt": "%.1e",
    "title_font_size": 18,
    "label_font_size": 16,
}
# The camera sees a ball around the mesh, of which most is empty.
_CLOSER: Final = 1.25


@dataclass(frozen=True)
class Look:
    """How a picture is taken.

    Attributes
    ----------
    width, height : int
        In pixels.
    direction : (float, float, float)
        From the mesh to the camera.
    up : (float, float, float)
    """

    width: int
    height: int
    direction: tuple[float, float, float]
    up: tuple[float, float, float]


def picture(mesh: PolyMesh, look: Look, errors: Floats | None = None) -> bytes:
    """Return a picture of a mesh as PNG.

    Parameters
    ----------
    mesh : PolyMesh
        Colours of its vertices are shown.
    look : Look
    errors : float64 (n,), optional
        At the vertices, shown in colours instead.

    Raises
    ------
    DeltameshError
        If PyVista is not installed.
    """
    try:
        import pyvista
    except ImportError:
        raise DeltameshError('pictures need PyVista: pip install "deltamesh[view]"') from None
    from vtkmodules.vtkCommonCore import vtkLogger

    # Without a display, VTK says so before it draws by other means.
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    surface = pyvista.PolyData.from_regular_faces(mesh.vertices, mesh.triangles)
    plotter = pyvista.Plotter(off_screen=True, window_size=[look.width, look.height])
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    plotter.add_mesh(surface, **_colours(mesh, errors), **_SURFACE)
    plotter.view_vector(look.direction, viewup=look.up)
    plotter.camera.zoom(_CLOSER)
    stream = io.BytesIO()
    plotter.show(screenshot=stream)
    return stream.getvalue()


def _colours(mesh: PolyMesh, errors: Floats | None) -> dict[str, Any]:
    """Return the arguments that colour a mesh."""
    import numpy as np

    if errors is not None:
        most = float(np.quantile(errors, _MOST_SHOWN)) or 1.0
        shown = {"scalars": errors, "cmap": _COLOURS, "clim": (0.0, most)}
        return {**shown, "scalar_bar_args": dict(_SCALE)}
    for one in mesh.attributes:
        rows = one.rows()
        if one.role == "colour" and one.domain == "vertex" and one.width >= 3 and rows.min() >= 0:
            return {"scalars": one.values[rows][:, :3], "rgb": True}
    return {"color": _PLAIN}
