"""Extensions of files that are not read, each with a program that makes a mesh file of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

_BLENDER: Final = "Blender imports it and exports GLB, which keeps names and materials"
_MAKER: Final = "the program that made it exports GLB, OBJ or PLY"
_CAD: Final = "a shape without triangles; gmsh makes them: gmsh -2 -o part.stl FILE"
_SURFACE: Final = "extract_surface().save('a.ply')"
_MESHIO: Final = f"PyVista makes a PLY of it, with meshio: pyvista.read_meshio(FILE).{_SURFACE}"
_PYVISTA: Final = f"PyVista makes a PLY of it: pyvista.read(FILE).{_SURFACE}"
_MESHLAB: Final = "MeshLab imports it and exports PLY or OBJ"
_POINTS: Final = "a point cloud, which LAZ, Draco and pcodec compress"
_DRAWING: Final = "a drawing of lines; the program that made it exports STL or OBJ of solids"
_ARCHIVE: Final = "an archive; unpack it, and give the mesh files in it"

_KINDS: Final[Mapping[str, str]] = {
    "fbx blend usd usda usdc usdz abc": _BLENDER,
    "max ma mb c4d skp 3dm sldprt sldasm": _MAKER,
    "step stp iges igs brep": _CAD,
    "msh inp mesh": _MESHIO,
    "vtk vtp vts vtu": _PYVISTA,
    "3ds wrl vrml x3d ctm": _MESHLAB,
    "xyz las laz pcd e57 pts": _POINTS,
    "dxf dwg svg": _DRAWING,
    "7z rar tar tgz": _ARCHIVE,
}
ADVICE: Final[Mapping[str, str]] = {
    extension: advice for some, advice in _KINDS.items() for extension in some.split()
}
