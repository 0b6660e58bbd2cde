"""Options of a batch that go together, and which machine this is of how many."""

from __future__ import annotations

import click
import pytest

from deltamesh_cli.batch.arguments import rank_of

ARRAY = {
    "SLURM_ARRAY_TASK_ID": "7",
    "SLURM_ARRAY_TASK_COUNT": "3",
    "SLURM_ARRAY_TASK_MIN": "3",
    "SLURM_ARRAY_TASK_MAX": "7",
    "SLURM_ARRAY_TASK_STEP": "2",
}
STEP = {"SLURM_PROCID": "2", "SLURM_NTASKS": "4"}


@pytest.fixture(autouse=True)
def slurm(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in (*ARRAY, *STEP):
        monkeypatch.delenv(name, raising=False)


def set_all(monkeypatch: pytest.MonkeyPatch, values: dict[str, str]) -> None:
    for name, value in values.items():
        monkeypatch.setenv(name, value)


def test_one_machine_is_the_first_of_one() -> None:
    assert rank_of(None, None, None) == (0, 1)
    assert rank_of(2, 5, None) == (2, 5)


def test_a_rank_needs_the_size_of_its_world() -> None:
    for rank, size in ((1, None), (None, 4)):
        with pytest.raises(click.UsageError, match="--rank and --world-size go together"):
            rank_of(rank, size, None)
    with pytest.raises(click.UsageError, match="--slurm and --rank exclude each other"):
        rank_of(0, 1, "array")


def test_ranks_are_those_of_slurm(monkeypatch: pytest.MonkeyPatch) -> None:
    set_all(monkeypatch, ARRAY | STEP)
    assert rank_of(None, None, "array") == (2, 3)
    assert rank_of(None, None, "step") == (2, 4)
    monkeypatch.delenv("SLURM_ARRAY_TASK_STEP")
    set_all(monkeypatch, {"SLURM_ARRAY_TASK_MAX": "9", "SLURM_ARRAY_TASK_COUNT": "7"})
    assert rank_of(None, None, "array") == (4, 7)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"SLURM_ARRAY_TASK_COUNT": "2"}, "the array has gaps"),
        ({"SLURM_ARRAY_TASK_ID": "6"}, "the array has gaps"),
        ({"SLURM_ARRAY_TASK_ID": "x"}, "is not a number"),
    ],
)
def test_arrays_of_slurm_that_tell_no_rank_are_refused(
    monkeypatch: pytest.MonkeyPatch, change: dict[str, str], message: str
) -> None:
    set_all(monkeypatch, ARRAY | change)
    with pytest.raises(click.UsageError, match=message):
        rank_of(None, None, "array")


@pytest.mark.parametrize("kind", ["array", "step"])
def test_without_slurm_there_is_no_rank(kind: str) -> None:
    with pytest.raises(click.UsageError, match="is not set"):
        rank_of(None, None, kind)
