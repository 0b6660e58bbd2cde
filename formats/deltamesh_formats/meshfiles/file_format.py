"""Description of a format of mesh files, and of what its writer makes of a mesh."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from deltamesh_formats.meshfiles.beside import Beside
    from deltamesh_formats.polymesh.kinds import Kind
    from deltamesh_formats.polymesh.mesh import Attribute, Domain, PolyMesh


class Written(NamedTuple):
    """The bytes of a mesh file, and descriptions of what of the mesh they do not hold."""

    data: bytes
    lost: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class FileFormat:
    """A format of mesh files.

    Each format is a package beside this module, which defines its value and imports its reader and
    its writer, and numpy with them, when one of them is called.

    Attributes
    ----------
    name : str
        As options and `PolyMesh.format` have it, in lower case; the first of the extensions.
    title : str
        As messages and help pages have it.
    extensions : tuple of str
        Of file names, in lower case, without the dot; new files get the first one.
    beginnings : tuple of bytes
        First bytes of files of this format; empty where a file may begin with anything.
    is_text : bool
        Whether the writer makes text.
    bytes_per_vertex : int
        Bytes of a file, at least, for a vertex and its two triangles.
    unit : str
        Unit of the positions in every file, of `deltamesh_formats.polymesh.units`; "" where files
        name one themselves, or none.
    has_top_left_textures : bool
        Whether texture coordinates begin at the top left of the picture, not at its bottom left.
    polygons, transforms : bool
        Whether a file holds faces of more than three corners, and the transforms of objects.
    gaps : tuple of {"vertex", "corner", "face"}
        Domains whose elements may be without a row of an attribute that others have.
    parts : tuple of {"object", "mesh", "group", "material", "smoothing"}
        Kinds of parts that a file holds.
    metadata : tuple of str
        Keys of `PolyMesh.metadata` that a file holds.
    read : callable
        Reader: bytes, and the files beside them (None for bytes of no file), to `PolyMesh`, with
        its format if that is not this one. It raises `MeshError` for what is no such file.
    names_beside : callable
        The relative paths of the files that are read with these bytes; None for a format whose
        files are whole.
    write : callable
        Writer: `PolyMesh`, with faces and with texture coordinates that begin where the format has
        their origin, to `Written`. It raises `MeshError` for what the format cannot hold. None for
        a format that is only read.
    """

    name: str
    title: str
    extensions: tuple[str, ...]
    beginnings: tuple[bytes, ...] = ()
    is_text: bool = False
    bytes_per_vertex: int
    unit: str = ""
    has_top_left_textures: bool = False
    polygons: bool = False
    transforms: bool = False
    gaps: tuple[Domain, ...] = ()
    parts: tuple[Kind, ...] = ()
    metadata: tuple[str, ...] = ()
    read: Callable[[bytes, Beside | None], PolyMesh]
    names_beside: Callable[[bytes], list[str]] | None = None
    write: Callable[[PolyMesh], Written] | None = None

    def losses(self, mesh: PolyMesh, kept: Collection[Attribute]) -> tuple[str, ...]:
        """Return descriptions of what a file does not hold that has these attributes of a mesh."""
        from deltamesh_formats.polymesh.descriptions import filled_gaps, losses_of

        losses = losses_of(
            mesh,
            attributes=kept,
            parts=self.parts,
            metadata=self.metadata,
            polygons=self.polygons,
            transforms=self.transforms,
        )
        gaps = filled_gaps(a for a in kept if a.domain not in self.gaps)
        return *losses, *dict.fromkeys(gaps)
