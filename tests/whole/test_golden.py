"""Files that must decode for ever, and files that must be refused: see make_golden.py."""

from __future__ import annotations

import animated
import golden_polymeshes
import numpy as np
import posed
import pytest
from graphs import FREE_SOLVERS as SOLVERS
from graphs import tolerances_of
from places import GOLDEN, REFUSED

from deltamesh import decode, frames, info, verify
from deltamesh_formats import errors
from deltamesh_formats.container.attribute_table import entries_of
from deltamesh_formats.container.pose_table import entries_of as poses_of
from deltamesh_formats.container.reader import read_container

TABLE = (REFUSED / "expected.tsv").read_text(encoding="utf-8").splitlines()[1:]


def names(folder):
    return sorted(path.stem for path in folder.glob("*.dmesh"))


def test_the_folders_are_complete() -> None:
    assert names(GOLDEN) == sorted(path.stem for path in GOLDEN.glob("*.npz"))
    assert len(names(GOLDEN)) >= 20
    assert names(REFUSED) == sorted(row.split("\t")[0] for row in TABLE)
    size = sum(path.stat().st_size for folder in (GOLDEN, REFUSED) for path in folder.iterdir())
    assert size < 456_000


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", names(GOLDEN))
def test_golden_file_decodes(name: str, solver: str) -> None:
    data = (GOLDEN / f"{name}.dmesh").read_bytes()
    mesh = decode(data, solver=solver)
    with np.load(GOLDEN / f"{name}.npz") as expected:
        if "faces" in expected:
            np.testing.assert_array_equal(mesh.triangles, expected["faces"])
            assert (mesh.parts, mesh.metadata, mesh.lost) == ((), {}, ())
        else:
            own = golden_polymeshes.stored(mesh)
            for key in {*own} - {"vertices"}:
                np.testing.assert_array_equal(own[key], expected[key])
        error = np.abs(mesh.vertices - expected["vertices"])
        assert (error <= tolerances_of(data, mesh)).all()
        for key in expected:
            if key.startswith("pose "):
                found = decode(data, pose=key.removeprefix("pose "), solver=solver)
                error = np.abs(found.vertices - expected[key])
                assert (error <= posed.tolerances(data, mesh)).all()
        entries = entries_of(read_container(data))
        assert len(entries) == sum(key.startswith("values") for key in expected)
        for i, (entry, attribute) in enumerate(zip(entries, mesh.attributes, strict=True)):
            assert_expected(entry, attribute, expected, i)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", animated.MADE)
def test_golden_sequence_decodes(name: str, solver: str) -> None:
    data = (GOLDEN / f"{name}.dmesh").read_bytes()
    with np.load(GOLDEN / f"{name}.npz") as expected:
        first, *further = frames(data, solver=solver)
        np.testing.assert_array_equal(first.triangles, expected["faces"])
        assert len(further) == len(expected["frames"])
        for i, mesh in enumerate(further, 1):
            error = np.abs(mesh.vertices - expected["frames"][i - 1])
            assert (error <= (i + 1) * tolerances_of(data, mesh)).all()


def assert_expected(entry, attribute, expected, i) -> None:
    """What a file says of an attribute, to the last bit; of unit normals, nearly."""
    values, rows = expected[f"values{i}"], attribute.rows()
    has = expected.get(f"has{i}", np.ones(len(values), dtype=bool))
    np.testing.assert_array_equal(rows >= 0, has)
    found, values = attribute.values[rows[has]], values[has]
    assert (found.dtype, found.shape) == (values.dtype, values.shape)
    if entry.coding == "octahedral":
        np.testing.assert_allclose(found, values, rtol=0, atol=1e-7)
    else:
        assert found.tobytes() == values.tobytes()


def test_golden_files_have_poses() -> None:
    """Of both solutions, and all that are there are expected."""
    found = {}
    for name in names(GOLDEN):
        container = read_container((GOLDEN / f"{name}.dmesh").read_bytes())
        poses = [f"pose {entry.name}" for entry in poses_of(container)]
        with np.load(GOLDEN / f"{name}.npz") as expected:
            assert poses == [key for key in expected if key.startswith("pose ")]
        found[container.parameters.solution] = len(poses) + found.get(
            container.parameters.solution, 0
        )
    assert found["interpolated"] >= 2
    assert found["least-squares"] >= 2


@pytest.mark.parametrize("name", names(GOLDEN))
def test_golden_file_tells_of_itself(name: str) -> None:
    container = info((GOLDEN / f"{name}.dmesh").read_bytes())
    with np.load(GOLDEN / f"{name}.npz") as expected:
        assert container.vertices == len(expected["vertices"])
        polygons = len(expected["offsets"]) - 1 if "offsets" in expected else None
        faces = expected["faces"] if polygons is None else expected["corners"][2 * polygons :]
        assert container.triangles == len(faces)
    assert name.startswith(container.parameters.method)
    assert container.meta is not None


def test_golden_files_tell_of_parts_and_of_faces_that_are_lost() -> None:
    """Each beginning of the end of `meta`: all of it, without a part, none."""
    metas = [info((GOLDEN / f"{name}.dmesh").read_bytes()).meta for name in names(GOLDEN)]
    assert {(m.lost, m.turned, m.parts) for m in metas} >= {(0, 0, 1), (3, 300, 3), (0, 1, 1)}
    several = [(m.part, m.part_normal, m.part_rms) for m in metas if m.parts > 1]
    assert ("tétraèdre", 1.5, 0.0123) in several


@pytest.mark.parametrize("row", TABLE, ids=lambda row: row.split("\t")[0])
def test_refused_file_is_refused(row: str) -> None:
    name, kind, offset, message = row.split("\t")
    data = (REFUSED / f"{name}.dmesh").read_bytes()
    for reader in (decode, verify):
        with pytest.raises(getattr(errors, kind)) as caught:
            reader(data)
        assert type(caught.value) is getattr(errors, kind)
        assert str(caught.value).startswith(message)
        assert getattr(caught.value, "offset", None) == (int(offset) if offset else None)
