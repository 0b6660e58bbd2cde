"""Arguments of `deltamesh batch`: their checks, and the `Job` and the rank that they give."""

from __future__ import annotations

import os
from dataclasses import fields
from typing import Any, Final

import click
from click.core import ParameterSource

from deltamesh._options import Options
from deltamesh_cli import options
from deltamesh_cli.batch.work import Job
from deltamesh_cli.encode_options import check_encode_options, encode_options
from deltamesh_cli.failures import RunSettings
from deltamesh_cli.lengths import without_units

# Variables of SLURM: of a task of a job array (sbatch --array), and of a task of a step (srun -n).
SLURM: Final = {
    "array": ("SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_COUNT"),
    "step": ("SLURM_PROCID", "SLURM_NTASKS"),
}

_ENCODE: Final = frozenset(options.parameters_of(encode_options))
# The option --memory of `batch` has another meaning.
_DECODE: Final = frozenset(options.parameters_of(options.decode_options)) - {"memory"}


def refuse_two_of(context: click.Context, *names: str) -> None:
    """Refuse the command line if more than one of these options is given."""
    flags = [_flag(context, name) for name in names if _on_command_line(context, name)]
    if len(flags) > 1:
        raise click.UsageError(f"{' and '.join(flags[:2])} exclude each other.")


def _on_command_line(context: click.Context, name: str) -> bool:
    return context.get_parameter_source(name) is ParameterSource.COMMANDLINE


def _flag(context: click.Context, name: str) -> str:
    parameter = next(p for p in context.command.params if p.name == name)
    return max(parameter.opts, key=len)


def job_of(
    context: click.Context,
    decode: bool,
    memory: int | None,
    parameters: dict[str, Any],
    *,
    one_thread: bool,
) -> Job:
    """Return the job that the options describe.

    Parameters
    ----------
    context : click.Context
    decode : bool
        Whether files are decoded.
    memory : int or None
        The option --memory.
    parameters : dict
        The options of `encode` and `decode`.
    one_thread : bool
        Whether the solver has one thread unless --threads is given.

    Raises
    ------
    click.UsageError
        If options exclude each other, or belong to the other direction.
    OptionError
        If an option is out of range.
    """
    own, other = (_DECODE, _ENCODE) if decode else (_ENCODE, _DECODE)
    for name in [parameter for parameter in parameters if parameter in other - own]:
        if _on_command_line(context, name):
            direction = "with -d" if decode else "without -d"
            raise click.UsageError(f"{_flag(context, name)} means nothing {direction}.")
    chosen = {name: value for name, value in parameters.items() if name in own}
    debug = context.ensure_object(RunSettings).debug
    file_format = chosen.pop("output_format" if decode else "input_format")
    if one_thread and chosen["threads"] is None:
        chosen["threads"] = 1
    if decode:
        return Job(True, file_format, {**chosen, "memory": memory}, debug)
    check_encode_options(chosen)
    known = {field.name for field in fields(Options)}
    given = without_units(options.specified(chosen))
    Options(**{name: value for name, value in given.items() if name in known})
    return Job(False, file_format, chosen, debug)


def rank_of(rank: int | None, world_size: int | None, slurm: str | None) -> tuple[int, int]:
    """Return the rank of this machine and the number of machines."""
    if slurm is not None:
        if not (rank is None and world_size is None):
            raise click.UsageError("--slurm and --rank exclude each other.")
        return _slurm_rank(slurm)
    if (rank is None) != (world_size is None):
        raise click.UsageError("--rank and --world-size go together.")
    return (rank or 0, world_size or 1)


def _slurm_rank(kind: str) -> tuple[int, int]:
    """Return rank and world size from the environment that SLURM has set.

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
