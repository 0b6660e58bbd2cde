"""Container: a `.dmesh` file that is not decoded.

`reader.read_container` makes one of bytes, `building.build_container` of what an encoder has, and
`writer.write_container` makes bytes of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from deltamesh_formats.container.layout import CHECK
from deltamesh_formats.container.meta import Meta
from deltamesh_formats.container.parameters import Parameters
from deltamesh_formats.container.sections import Section

if TYPE_CHECKING:
    from deltamesh_formats.container.frame_table import Frame

# With the records that it is made of.
__all__ = ["Container", "Meta", "Parameters", "Section"]


@dataclass(frozen=True)
class Container:
    """A file, checked but not decoded: a whole one, unless a prefix was asked for.

    Attributes
    ----------
    version : int
        Of the container.
    vertices, triangles : int
        Counts of the decoded mesh, whose polygons are cut into triangles.
    parameters : Parameters
    meta : Meta or None
    sections : dict of str to Section
        All of them by their ids, in the order of the file; of a prefix, those that have come.
    digest : bytes, 8
        Checksum of the decoded integers; empty in a prefix.
    cut : str
        The id of the section that a prefix ends within; "" for none, or before its id is there.
    """

    version: int
    vertices: int
    triangles: int
    parameters: Parameters
    meta: Meta | None
    sections: dict[str, Section]
    digest: bytes
    cut: str = ""

    @property
    def is_whole(self) -> bool:
        """Whether all sections have come."""
        return CHECK in self.sections

    @property
    def size(self) -> int:
        """Bytes of the whole file; of a prefix, up to the end of the last section."""
        return next(reversed(self.sections.values())).end

    @property
    def margin(self) -> float:
        """How far each decoded coordinate may be rounded; see `Meta.room`."""
        return 0.0 if self.meta is None else self.meta.room

    @property
    def frame_count(self) -> int:
        """Frames of a sequence; 1 for a mesh that does not move.

        Raises
        ------
        FormatError
            If the table of the frames is damaged; so do `frames` and `fps`.
        """
        return 1 + len(self.frames)

    @property
    def frames(self) -> tuple[Frame, ...]:
        """The frames of a sequence beyond the first, to which `parameters` and `meta` belong."""
        from deltamesh_formats.container.frame_table import frames_of

        return frames_of(self)[1]

    @property
    def fps(self) -> float | None:
        """Frames a second, as far as that is known."""
        from deltamesh_formats.container.frame_table import frames_of

        return frames_of(self)[0] or None

    def __str__(self) -> str:
        from deltamesh_formats.container.summary import container_text

        return container_text(self)

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        from deltamesh_formats.container.summary import container_html

        return container_html(self)
