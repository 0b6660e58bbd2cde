"""Options of `deltamesh batch`: those of `encode` and `decode` too, and how they go together."""

from __future__ import annotations

import os
from dataclasses import fields
from typing import Any, Final

import click
from click.core import ParameterSource

from deltamesh._options import Options
from deltamesh_cli import options
from deltamesh_cli.batch.work import Job
from deltamesh_cli.commands import decode as decoding
from deltamesh_cli.commands import encode as encoding
from deltamesh_cli.failures import Settings

# What `encode` and `decode` have that means something else here, or nothing.
_NOT_SHARED: Final = frozenset(
    {"source", "target", "output", "force", "as_json", "quiet", "verbose", "show_progress"}
    | {"debug", "memory"}
)

# SLURM's own names: of the tasks of an array (sbatch --array), and of those of a step (srun -n).
SLURM: Final = {
    "array": ("SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_COUNT"),
    "step": ("SLURM_PROCID", "SLURM_NTASKS"),
}


def _shared(command: click.Command) -> dict[str, click.Parameter]:
    return {p.name: p for p in command.params if p.name and p.name not in _NOT_SHARED}


_ENCODING: Final = _shared(encoding.command)
_DECODING: Final = _shared(decoding.command)

# What help pages end with.
_COMMON: Final = frozenset({"as_json", "quiet", "verbose", "show_progress", "debug"})


def with_options_of_both(command: click.Command) -> click.Command:
    """Give `batch` every option of `encode` and `decode`, those to come included."""
    own = [parameter for parameter in command.params if parameter.name not in _COMMON]
    common = [parameter for parameter in command.params if parameter.name in _COMMON]
    command.params = [*own, *{**_ENCODING, **_DECODING}.values(), *common]
    return command


def refuse_two_of(context: click.Context, *names: str) -> None:
    """Refuse options of which the first excludes the others, and these each other."""
    given = [_flag(context, name) for name in names if _is_given(context, name)]
    if len(given) > 1:
        raise click.UsageError(f"{' and '.join(given[:2])} exclude each other.")


def _is_given(context: click.Context, name: str) -> bool:
    return context.get_parameter_source(name) is ParameterSource.COMMANDLINE


def _flag(context: click.Context, name: str) -> str:
    found = next(p for p in context.command.params if p.name == name)
    return max(found.opts, key=len)


def job_of(
    context: click.Context,
    decode: bool,
    memory: int | None,
    parameters: dict[str, Any],
    *,
    one_thread: bool,
) -> Job:
    """Return what is done with each file; options of the other direction are refused."""
    own, other = (_DECODING, _ENCODING) if decode else (_ENCODING, _DECODING)
    for name in other.keys() - own.keys():
        if _is_given(context, name):
            direction = "with -d" if decode else "without -d"
            raise click.UsageError(f"{_flag(context, name)} means nothing {direction}.")
    chosen = {name: parameters[name] for name in own}
    debug = context.ensure_object(Settings).debug
    file_format = chosen.pop("output_format" if decode else "input_format")
    if one_thread and chosen["threads"] is None:
        chosen["threads"] = 1
    if decode:
        return Job(True, file_format, {**chosen, "memory": memory}, debug)
    encoding.check_parameters(chosen)
    known = {field.name for field in fields(Options)}
    Options(**{name: value for name, value in options.given(chosen).items() if name in known})
    return Job(False, file_format, chosen, debug)


def rank_of(rank: int | None, world_size: int | None, slurm: str | None) -> tuple[int, int]:
    """Return which machine this is, of how many."""
    if slurm is not None:
        if not (rank is None and world_size is None):
            raise click.UsageError("--slurm and --rank exclude each other.")
        return _slurm_rank(slurm)
    if (rank is None) != (world_size is None):
        raise click.UsageError("--rank and --world-size go together.")
    return (rank or 0, world_size or 1)


def _slurm_rank(kind: str) -> tuple[int, int]:
    """Return what SLURM has put into the environment.

    https://slurm.schedmd.com/job_array.html; an array may begin anywhere and take steps.
    """
    try:
        number, count = (int(os.environ[name]) for name in SLURM[kind])
        if kind == "step":
            return number, count
        first, last = (int(os.environ[f"SLURM_ARRAY_TASK_{end}"]) for end in ("MIN", "MAX"))
        step = int(os.environ.get("SLURM_ARRAY_TASK_STEP", "1"))
    except KeyError as error:
        raise click.UsageError(f"--slurm {kind}: {error.args[0]} is not set.") from error
    except ValueError as error:
        raise click.UsageError(f"--slurm {kind}: a variable of SLURM is not a number.") from error
    rank = number - first
    if (last - first) // step + 1 != count or rank % step:
        raise click.UsageError("--slurm array: the array has gaps: use --rank and --world-size.")
    return rank // step, count
