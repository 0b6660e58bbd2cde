"""Table of the sections of a file.

An encoder walks the table with a draft, a decoder with the content so far; each section adds what
a decoder knows of it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, Protocol

from deltamesh._attributes.domains import Domains
from deltamesh._content import Content
from deltamesh._geometry.bounds import POSITION_TOLERANCE
from deltamesh._geometry.interpolation import FINER
from deltamesh._measures.metrics import diagonal
from deltamesh._parts import decode_parts, encode_parts
from deltamesh._sections import geometry, poses
from deltamesh._sections.draft import Draft
from deltamesh._shape import connectivity, merging, split_vertices, stitches
from deltamesh._shape.draft import ShapeDraft
from deltamesh._shape.structure import Structure
from deltamesh_formats.container import layout
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.method_layouts import METHODS
from deltamesh_formats.container.sections import payload_of

if TYPE_CHECKING:
    from deltamesh._attributes.candidates import AttributeSettings


@dataclass(frozen=True)
class Section:
    """Row of the table: one section, or those of the geometry.

    Attributes
    ----------
    stage : str
        Its name for whoever watches the progress.
    applies : callable
        Returns whether a draft needs the section.
    encode : callable
        Returns the payloads of a draft by their ids, and the draft with the section.
    is_in : callable
        Returns whether a container has the section.
    decode : callable
        Returns the content with the section of a container; raises FormatError.
    """

    stage: str
    applies: Callable[[Draft], bool]
    encode: Callable[[Draft], tuple[dict[str, bytes], Draft]]
    is_in: Callable[[Container], bool]
    decode: Callable[[Container, Content], Content]


def _single(
    name: str,
    stage: str,
    applies: Callable[[Draft], bool],
    encode: Callable[[Draft], tuple[bytes, Draft]],
    decode: Callable[[memoryview, Container, Content], Content],
) -> Section:
    """Return the row of one section, coded by functions of its payload."""

    def encode_named(draft: Draft) -> tuple[dict[str, bytes], Draft]:
        payload, draft = encode(draft)
        return {name: payload}, draft

    def decode_named(container: Container, content: Content) -> Content:
        with payload_of(container.sections[name]) as payload:
            return decode(payload, container, content)

    def is_in(container: Container) -> bool:
        return name in container.sections

    return Section(stage, applies, encode_named, is_in, decode_named)


class ShapeSection(Protocol):
    """Module that codes a section of the structure."""

    def applies(self, draft: ShapeDraft, /) -> bool:
        """Return whether a draft needs the section."""

    def encode(self, draft: ShapeDraft, /) -> tuple[bytes, ShapeDraft]:
        """Return the payload, and the draft with the section."""

    def decode(
        self, payload: memoryview, container: Container, structure: Structure, /
    ) -> Structure:
        """Return the structure with the section."""


def _of_shape(name: str, stage: str, module: ShapeSection) -> Section:
    """Return the row of a section of the structure."""

    def applies(draft: Draft) -> bool:
        return module.applies(draft.shape)

    def encode(draft: Draft) -> tuple[bytes, Draft]:
        payload, shape = module.encode(draft.shape)
        content = replace(draft.content, domains=Domains(shape.structure))
        return payload, replace(draft, shape=shape, content=content)

    def decode(payload: memoryview, container: Container, content: Content) -> Content:
        structure = module.decode(payload, container, content.structure)
        return replace(content, domains=Domains(structure))

    return _single(name, stage, applies, encode, decode)


# Many meshes have no attributes, and need no order: their coders are imported where they are met.
def _encode_attributes(draft: Draft) -> tuple[bytes, Draft]:
    from deltamesh._attributes.section import encode_attributes

    domains, provenance = draft.content.domains, draft.shape.provenance
    payload, coded = encode_attributes(draft.mesh, provenance, domains, _attribute_settings(draft))
    return payload, replace(draft, content=replace(draft.content, attributes=coded))


def _attribute_settings(draft: Draft) -> AttributeSettings:
    from deltamesh._attributes.candidates import AttributeSettings

    options, trial = draft.options, draft.chosen
    V = trial.vertices[draft.content.structure.points]
    solved = METHODS[trial.parameters.method].anchored
    doubt = max(POSITION_TOLERANCE * diagonal(V), FINER * trial.measured.doubt)
    return AttributeSettings(
        bits_uv=options.bits_uv,
        bits_normal=options.bits_normal,
        lossless=options.lossless_attributes or options.exact,
        positions=V,
        tolerance=doubt if solved else 0.0,
        bits_float=options.bits_float,
        errors=options.attribute_errors,
    )


def _decode_attributes(payload: memoryview, container: Container, content: Content) -> Content:
    from deltamesh._attributes.section import decode_attributes

    return replace(content, attributes=decode_attributes(payload, content.domains))


def _encode_parts(draft: Draft) -> tuple[bytes, Draft]:
    found, domains = draft.annotations, draft.content.domains
    assert found is not None
    payload = encode_parts(found, lambda: domains.faces)
    return payload, replace(draft, content=replace(draft.content, annotations=found))


def _decode_parts(payload: memoryview, container: Container, content: Content) -> Content:
    domains = content.domains
    found = decode_parts(payload, domains.count("face"), lambda: domains.faces)
    return replace(content, annotations=found)


def _encode_order(draft: Draft) -> tuple[bytes, Draft]:
    from deltamesh._order.coding import encode_order
    from deltamesh._order.reordering import order_of

    structure = draft.content.structure
    order = order_of(structure.polygons, draft.shape.provenance, draft.mesh.offsets)
    payload = encode_order(structure.faces, structure.polygons, order)
    return payload, replace(draft, content=replace(draft.content, order=order))


def _decode_order(payload: memoryview, container: Container, content: Content) -> Content:
    from deltamesh._order.coding import decode_order

    structure = content.structure
    order = decode_order(payload, structure.faces, structure.polygons, container.vertices)
    return replace(content, order=order)


def _encode_frames(draft: Draft) -> tuple[dict[str, bytes], Draft]:
    from deltamesh._sections import frames

    return frames.encode(draft)


def _encode_poses(draft: Draft) -> tuple[bytes, Draft]:
    return poses.encode(draft.content), draft


# In the order in which they are coded: each may use what those before it have made.
SECTIONS: Final = (
    _of_shape(layout.CONNECTIVITY, "connectivity", connectivity),
    _of_shape(layout.STITCHES, "stitches", stitches),
    _of_shape(layout.SPLIT_VERTICES, "split vertices", split_vertices),
    _of_shape(layout.POLYGONS, "polygons", merging),
    Section("geometry", lambda _: True, geometry.encode, lambda _: True, geometry.decode),
    _single(
        layout.ATTRIBUTES,
        "attributes",
        lambda draft: bool(draft.mesh.attributes),
        _encode_attributes,
        _decode_attributes,
    ),
    _single(
        layout.PARTS,
        "parts",
        lambda draft: draft.annotations is not None,
        _encode_parts,
        _decode_parts,
    ),
    _single(
        layout.ORDER,
        "order",
        lambda draft: draft.options.keep_order,
        _encode_order,
        _decode_order,
    ),
    _single(
        layout.POSES,
        "poses",
        lambda draft: bool(draft.content.poses),
        _encode_poses,
        poses.decode,
    ),
    Section(
        "frames",
        lambda draft: bool(draft.sequence.positions),
        _encode_frames,
        lambda container: layout.FRAMES in container.sections,
        lambda container, content: content,  # `frames` decodes those that are asked for
    ),
)
