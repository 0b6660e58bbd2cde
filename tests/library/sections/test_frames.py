"""Frames of a sequence: bounds in every one of them, key frames, and what cannot be a sequence."""

from __future__ import annotations

from dataclasses import replace

import animated
import meshes
import numpy as np
import pytest
from animated import moving

from deltamesh import (
    MeshError,
    OptionError,
    TargetError,
    decode,
    encode,
    frames,
    from_arrays,
    info,
)
from deltamesh._content import frame_digest
from deltamesh._measures.metrics import diagonal, vertex_errors
from deltamesh._options import Options
from deltamesh._pipeline import encoder
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh._sections import frames as section
from deltamesh._sections.draft import Sequence
from deltamesh._sections.trials import Trials

TORUS = meshes.torus(24, 18)
MOVING = moving(TORUS, 6)


def errors(data, given):
    """The errors of each frame of a file that keeps the order."""
    found = zip(given, frames(data), strict=True)
    return [vertex_errors(one.vertices, got.vertices, one.triangles) for one, got in found]


@pytest.mark.parametrize("method", ["auto", "refined", "highpass", "cartesian"])
def test_bounds_hold_in_every_frame_and_are_told(method: str) -> None:
    bounds = {"normal_error": 1.5, "rms_error_rel": 1e-3}
    data = encode(MOVING, method=method, keep_order=True, key_every=3, **bounds)
    found, container = errors(data, MOVING), info(data)
    assert max(e.normal_deviation for e in found) <= 1.5
    for e, mesh in zip(found, MOVING, strict=True):
        assert e.rms <= 1e-3 * diagonal(mesh.vertices)
    for e, mesh, frame in zip(found[1:], MOVING[1:], container.frames, strict=True):
        assert frame.normal == pytest.approx(e.normal_deviation, rel=1e-3)
        assert frame.rms == pytest.approx(e.rms / diagonal(mesh.vertices), rel=1e-3)
        assert frame.max >= e.max / diagonal(mesh.vertices) * (1 - 1e-3)


def test_maximum_distances_hold_in_every_frame() -> None:
    data = encode(MOVING, method="refined", keep_order=True, normal_error=8, max_error_rel=2e-3)
    for e, mesh in zip(errors(data, MOVING), MOVING, strict=True):
        assert e.max <= 2e-3 * diagonal(mesh.vertices)


def test_each_frame_is_smaller_than_a_file_of_its_own() -> None:
    data = encode(MOVING, quality=6, method="refined")
    own = [len(encode(mesh, quality=6, method="refined")) for mesh in MOVING[1:]]
    sizes = [frame.size for frame in info(data).frames]
    assert max(sizes) < 0.7 * min(own)


def test_nothing_accumulates() -> None:
    """Frame 30 is no worse than frame 1, all predicted from the one before."""
    given = moving(meshes.torus(12, 9), 31, each=0.05)
    data = encode(given, step=0.02, method="refined", keep_order=True, key_every=255)
    found = [e.normal_deviation for e in errors(data, given)]
    assert np.mean(found[25:]) < 1.2 * np.mean(found[1:6])


def test_still_frames_take_next_to_nothing() -> None:
    own = len(encode(MOVING[0], method="refined"))
    data = encode([MOVING[0]] * 3, method="refined")
    assert all(frame.size < 0.1 * own for frame in info(data).frames)


def test_settings_are_those_of_a_frame_that_moves() -> None:
    still = info(encode([MOVING[0], *MOVING[:2]], method="refined")).frames
    at_once = info(encode(MOVING[:2], method="refined")).frames
    assert (still[1].coarse, still[1].maps) == (at_once[0].coarse, at_once[0].maps)


def test_key_frames_come_where_they_are_asked_for() -> None:
    data = encode(MOVING, step=0.05, method="refined", key_every=2)
    assert [f.index for f in info(data).frames if f.is_key] == [2, 4]
    one = encode(MOVING, step=0.05, method="refined", key_every=1)
    assert [f.index for f in info(one).frames if f.is_key] == [2, 3, 4, 5]


def test_a_frame_with_smaller_steps_has_a_finer_grid() -> None:
    V, F = TORUS
    given = [from_arrays(V * size, F) for size in (1, 1, 2e-4, 1)]
    data = encode(given, method="refined", keep_order=True)
    fine = info(data).frames[1]
    assert fine.finer > 2
    assert fine.step < 0.1 * info(data).parameters.step
    assert max(e.normal_deviation for e in errors(data, given)) <= 1
    cartesian = encode(given, method="cartesian", keep_order=True, quality=5)
    assert info(cartesian).frames[1].finer > 2
    assert max(e.normal_deviation for e in errors(cartesian, given)) <= 1


def test_vertices_that_part_are_no_copies() -> None:
    """Two vertices at one position in frame 0 are one point only if they stay together."""
    V, F = meshes.union(meshes.tetrahedron(), meshes.tetrahedron())
    apart = V.copy()
    apart[4:] += [2.0, 0, 0]
    data = encode([from_arrays(V, F), from_arrays(apart, F)], step=1e-3, keep_order=True)
    assert np.abs(decode(data, frame=1).vertices - apart).max() < 0.1
    together = encode([from_arrays(V, F), from_arrays(V + 1, F)], step=1e-3, keep_order=True)
    assert ("COPY" in info(together).sections, "COPY" in info(data).sections) == (True, False)


def test_a_bound_that_cannot_be_kept_names_the_frame() -> None:
    V, F = TORUS
    given = [from_arrays(V, F), from_arrays(V + np.array([1e9, 0, 0]), F)]
    with pytest.raises(TargetError, match=r"^frame 1: "):
        encode(given, method="refined", max_error=1e-6, only=True)


@pytest.mark.parametrize("options", [{"method": "lossless"}, {"method": "highpass", "bits": 0}])
def test_what_has_no_steps_is_no_sequence(options) -> None:
    with pytest.raises(OptionError, match="cannot have several frames"):
        encode(MOVING, **options)


def test_an_importance_is_for_one_mesh() -> None:
    with pytest.raises(OptionError, match="several frames cannot have an importance"):
        encode(MOVING, importance=np.ones(len(MOVING[0].vertices)))


def test_auto_is_cartesian_where_refined_cannot_keep_the_bounds(monkeypatch) -> None:
    whole, tried = encoder._encoded, []

    def encoded(mesh, options, progress, sequence):
        tried.append((options.method, options.quality))
        if options.method == "refined":
            raise TargetError("frame 0: it cannot")
        return whole(mesh, options, progress, sequence)

    assert info(encode(MOVING)).parameters.method == "refined"
    monkeypatch.setattr(encoder, "_encoded", encoded)
    assert info(encode(MOVING)).parameters.method == "cartesian"
    assert tried == [("refined", 5), ("cartesian", 5)]
    with pytest.raises(TargetError):
        encode(MOVING, step=0.1)


@pytest.mark.parametrize(
    ("margin", "other", "size", "both"),
    [(20, 22, 1.0, 22), (20, 18, 1.0, 20), (20, 18, 0.01, 25), (20, 22, 8.0, 20), (20, 0, 1.0, 0)],
)
def test_a_margin_suits_frames_of_any_size(margin, other, size, both) -> None:
    assert section._finer_margin(margin, other, size) == both
    assert section._finer_margin(0, other, size) == 0


def test_what_is_written_of_a_small_frame_keeps_its_bounds() -> None:
    V, F = TORUS
    given = [from_arrays(V * size, F) for size in (1, 0.05)]
    data = encode(given, method="refined", keep_order=True)
    room = decode(data, frame=1).margin
    assert 0 < room < 0.05 * 0.01 * diagonal(V)


def test_effort_1_tries_nothing_else() -> None:
    fast, usual = (encode(MOVING, method="refined", effort=effort) for effort in (1, 2))
    assert info(fast).frames[0].coarse == info(fast).parameters.coarse
    assert sum(f.size for f in info(usual).frames) <= sum(f.size for f in info(fast).frames)


def test_the_draft_tells_of_each_frame() -> None:
    first, *others = MOVING
    sequence = Sequence(tuple(mesh.vertices for mesh in others), 24.0, 16)
    encoded = encode_mesh(first, Options(quality=4), sequence=sequence)
    draft = encoded.draft
    assert [frame.index for frame in draft.frames] == [1, 2, 3, 4, 5]
    costs = [draft.cost, *(frame.cost for frame in draft.frames)]
    assert draft.costliest == max(costs, key=lambda cost: cost.error / cost.bound)
    assert isinstance(Trials(draft, others[0].vertices, draft.systems, "x").scale, float)


def test_a_wrong_digest_of_a_frame_is_refused() -> None:
    data = animated.file_of("refined-sequence")
    wrong = animated.with_first(data, digest=bytes(8))
    with pytest.raises(ValueError, match="frame 1: the checksum of the decoded integers is wrong"):
        decode(wrong, frame=1)
    assert len(decode(wrong).vertices) == len(decode(data).vertices)


def test_too_few_maps_are_refused() -> None:
    V, F = meshes.two_components()
    data = encode(moving((V, F), 2), step=0.05, method="refined")
    frame = info(data).frames[0]
    assert frame.maps >= 2
    with pytest.raises(ValueError, match="frame 1: 1 maps of"):
        decode(animated.with_first(data, maps=1), frame=1)


def test_maps_that_are_all_the_identity_are_refused() -> None:
    data = animated.file_of("refined-sequence")
    frame = info(data).frames[0]
    rows = np.zeros((3 * frame.maps, 3), dtype=np.int64)
    container = info(data)
    streams = {**frame.sections, "MAPS": replace(frame.sections["MAPS"], payload=b"")}
    from deltamesh._geometry.frames import decode_frame, encode_frame
    from deltamesh._geometry.motion import Motion
    from deltamesh._pipeline.decoder import proven_content

    content = proven_content(container, 2**40, 2**50)
    surface = content.structure.surface
    p = section.frame_parameters(container, frame)
    _, seen = decode_frame(surface, p, frame.sections, content.integers, frame.maps)
    zero = Motion(rows, frame.rounds, frame.unit)
    payloads = encode_frame(surface, p, seen, zero)
    streams = {name: replace(frame.sections[name], payload=payloads[name]) for name in streams}
    wrong = animated.with_first(data, sections=streams, digest=frame_digest(rows, seen))
    with pytest.raises(ValueError, match="MAPS: no map moves anything"):
        decode(wrong, frame=1)


@pytest.mark.parametrize("method", ["auto", "highpass", "cartesian"])
@pytest.mark.parametrize("size", [1e-12, 1.0, 1e12])
def test_sequences_that_begin_with_a_point_keep_the_bounds(method: str, size: float) -> None:
    """All vertices of frame 0 are at one place, and say nothing of how fine a grid has to be."""
    grown = [replace(mesh, vertices=size * i * mesh.vertices) for i, mesh in enumerate(MOVING[:4])]
    data = encode(grown, method=method, keep_order=True)
    for e, mesh in zip(errors(data, grown)[1:], grown[1:], strict=True):
        assert e.normal_deviation <= 1
        assert e.rms <= 0.0015 * diagonal(mesh.vertices)
    np.testing.assert_array_equal(decode(data).vertices, grown[0].vertices)
    still = encode([grown[0]] * 3, method=method, keep_order=True)
    np.testing.assert_array_equal(decode(still, frame=2).vertices, grown[0].vertices)


def test_frames_far_larger_than_the_first_are_told_why_they_fail() -> None:
    small = replace(MOVING[0], vertices=1e-9 * MOVING[0].vertices)
    with pytest.raises(MeshError, match=r"^frame 1: .*: it is 1e\+09 times as large as frame 0"):
        encode([small, MOVING[0]])


def test_bits_of_a_sequence_that_begins_with_a_point_are_those_of_the_largest_frame() -> None:
    point = replace(MOVING[0], vertices=0 * MOVING[0].vertices)
    step = info(encode([point, *MOVING[:3]], method="highpass", bits=8)).parameters.step
    assert step == info(encode(MOVING[2], method="highpass", bits=8)).parameters.step
