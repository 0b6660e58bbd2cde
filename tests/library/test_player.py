"""Player: frames in any order, limits, and how far two decoders may be from each other."""

from __future__ import annotations

import animated
import meshes
import numpy as np
import pytest
from animated import moving

from deltamesh import LimitError, OptionError, decode, encode, frames, info, load, save, verify
from deltamesh._geometry.methods import geometry_codec
from deltamesh._geometry.systems import Systems
from deltamesh._limits import memory_needed
from deltamesh._pipeline.decoder import proven_content
from deltamesh._player import Player

MOVING = moving(meshes.torus(12, 9), 16, each=0.1)


@pytest.mark.parametrize("name", animated.MADE)
def test_any_order_gives_the_same_frames(name: str) -> None:
    data = animated.file_of(name)
    every = [mesh.vertices for mesh in frames(data)]
    for index in (2, 1, 0, 1):
        if index < len(every):
            found = decode(data, frame=index)
            np.testing.assert_array_equal(found.vertices, every[index])
    assert len(every) == info(data).frame_count


def test_a_player_goes_back_and_forth() -> None:
    container = info(encode(MOVING, step=0.05, method="refined", key_every=4))
    content = proven_content(container, 2**40, 2**50)
    surface = content.structure.surface
    systems = Systems(surface)
    first = geometry_codec("refined").reconstruct(
        surface, container.parameters, content.integers, systems
    )
    every = [mesh.vertices for mesh in frames(container)]
    player = Player(container, content, systems, first)
    for index in (15, 3, 4, 9, 8, 1, 15, 15):
        np.testing.assert_array_equal(player.positions(index), every[index])


@pytest.mark.parametrize("method", ["refined", "highpass"])
def test_decoders_do_not_drift_apart(method: str) -> None:
    """15 frames, each predicted from the one before, by solvers that stop at other errors."""
    data = encode(MOVING, method=method, step=0.02, solution="interpolated", key_every=16)
    container = info(data)
    content = proven_content(container, 2**40, 2**50)
    surface, step = content.structure.surface, container.parameters.step
    found = []
    for precision in (1.0, 1e-3):
        systems = Systems(surface).to_precision(precision)
        first = geometry_codec(method).reconstruct(
            surface, container.parameters, content.integers, systems
        )
        player = Player(container, content, systems, first)
        found.append([first, *(player.positions(i) for i in range(1, 16))])
    apart = [np.abs(a - b).max() / step for a, b in zip(*found, strict=True)]
    assert 0 < apart[15] < 1e-4
    assert max(apart) < 16e-3


def test_frames_that_are_missing_are_refused() -> None:
    data = animated.file_of("refined-sequence")
    for frame in (4, -1):
        with pytest.raises(OptionError, match=f"no frame {frame}: the file has 4, from 0 on"):
            decode(data, frame=frame)


def test_files_are_saved_loaded_and_verified(tmp_path) -> None:
    path = tmp_path / "walk.dmesh"
    save(path, iter(MOVING[:3]), fps=24, keep_order=True, method="refined")
    assert (info(path).fps, info(path).frame_count) == (24.0, 3)
    for i, mesh in enumerate(frames(path)):
        np.testing.assert_array_equal(load(path, frame=i).vertices, mesh.vertices)
        np.testing.assert_array_equal(mesh.faces, MOVING[i].faces)
    assert verify(path).frame_count == 3
    with pytest.raises(ValueError, match="frame 1"):
        verify(animated.with_first(path.read_bytes(), digest=bytes(8)))


def test_positions_frame_by_frame_are_a_sequence() -> None:
    stacked = np.stack([mesh.vertices for mesh in MOVING[:3]])
    assert encode(stacked, MOVING[0].triangles, step=0.1) == encode(MOVING[:3], step=0.1)


def test_memory_of_frames_is_counted_before_it_is_taken() -> None:
    one, several = (encode(MOVING[:count], step=0.1, method="refined") for count in (1, 2))
    needed = memory_needed(info(several))
    assert needed == memory_needed(info(one)) + 600 * len(MOVING[0].vertices)
    with pytest.raises(LimitError):
        next(frames(several, memory=needed - 1))


def test_a_rate_means_nothing_for_one_mesh() -> None:
    with pytest.raises(OptionError, match="fps means nothing for one mesh"):
        encode(MOVING[0], fps=25)
    for options in ({"fps": 0}, {"key_every": 0}, {"key_every": 256}):
        with pytest.raises(OptionError):
            encode(MOVING[:2], **options)
