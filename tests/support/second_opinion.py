"""The second decoder's opinion of a file beside the first one's."""

from __future__ import annotations

import numpy as np
import posed
import spec_attributes
import spec_decoder
from graphs import tolerances_of

from deltamesh import decode, frames, info
from deltamesh_formats.container.pose_table import entries_of
from deltamesh_formats.polymesh.mesh import Attribute


def assert_same(data: bytes) -> None:
    vertices, faces, exact = spec_decoder.decode(data)
    mesh = decode(data)
    np.testing.assert_array_equal(np.concatenate(faces), mesh.corners)
    np.testing.assert_array_equal([len(face) for face in faces], np.diff(mesh.offsets))
    divisions, metadata, lost, precision = exact["told"]
    assert (metadata, lost) == ({k: [*v] for k, v in mesh.metadata.items()}, [*mesh.lost])
    assert precision == mesh.precision
    assert [row[0] for row in divisions] == [parts.kind for parts in mesh.parts]
    for (_, names, of_face, transforms), parts in zip(divisions, mesh.parts, strict=True):
        assert names == [*parts.names]
        np.testing.assert_array_equal(of_face, parts.of_face)
        assert (transforms is None) == (parts.transforms is None)
        assert transforms is None or b"".join(transforms) == parts.transforms.tobytes()
    for attribute, found in zip(mesh.attributes, exact["attributes"], strict=True):
        assert_same_attribute(attribute, found)
    if info(data).parameters.method == "lossless":
        assert vertices.tobytes() == mesh.vertices.tobytes()
        return
    assert (np.abs(vertices - mesh.vertices) <= tolerances_of(data, mesh)).all()
    _, *further = frames(data)
    for i, (found, frame) in enumerate(zip(exact["frames"], further, strict=True), 1):
        # What two decoders may differ by adds up over the frames.
        error = np.abs(found - frame.vertices)
        assert (error <= (1 + i) * tolerances_of(data, frame)).all(), i
    for pose in entries_of(info(data)):
        theirs, ours = spec_decoder.decode(data, pose=pose.name)[0], decode(data, pose=pose.name)
        assert (np.abs(theirs - ours.vertices) <= posed.tolerances(data, mesh)).all()


def assert_same_prefix(data: bytes) -> None:
    vertices, faces, exact = spec_decoder.decode(data, cut=True)
    found = decode(data, partial=True)
    assert found.stage == exact["stage"]
    np.testing.assert_array_equal(np.concatenate(faces), found.mesh.corners)
    assert len(found.mesh.attributes) == len(exact["attributes"])
    # Of least squares, 1e-9; interpolated anchors that are not solved to that have steps far above.
    allowed = 1e-9 * np.linalg.norm(np.ptp(vertices, axis=0)) + 1e-3 * step_of(data)
    assert np.abs(vertices - found.mesh.vertices).max() <= allowed


def step_of(data: bytes) -> float:
    """The step of a file whose anchors are interpolated, 0 of others."""
    parameters = info(data, partial=True).parameters
    return parameters.step if parameters.interpolated else 0.0


def assert_same_attribute(attribute: Attribute, found: spec_attributes.Decoded) -> None:
    """To the last bit, but for normals, which positions are part of."""
    entry, rows = found.entry, attribute.rows()
    for name in ("name", "domain", "role", "normalized", "width"):
        assert getattr(entry, name) == getattr(attribute, name)
    np.testing.assert_array_equal(found.has, rows >= 0)
    ours, theirs = attribute.values[rows[found.has]], found.values[found.has]
    assert ours.dtype == theirs.dtype
    if entry.coding == spec_attributes.OCTAHEDRAL:
        np.testing.assert_allclose(theirs, ours, rtol=0, atol=1e-7)
    else:
        assert ours.tobytes() == theirs.tobytes()
