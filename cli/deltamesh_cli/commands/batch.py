"""`deltamesh batch`: many files, on one machine or many."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any

import click

from deltamesh.batch import available_cores, physical_memory, share
from deltamesh_cli import options
from deltamesh_cli.batch.arguments import SLURM, job_of, rank_of, refuse_two_of
from deltamesh_cli.batch.engines import here, in_processes, on_dask
from deltamesh_cli.batch.plan import Destinations, plan_files
from deltamesh_cli.batch.run import dry_run, run_batch
from deltamesh_cli.batch.settings import ExistingFiles, Verbosity
from deltamesh_cli.encode_options import encode_options
from deltamesh_cli.epilogs import epilog
from deltamesh_cli.failures import Failure, report_failure
from deltamesh_cli.inputs import Choice, chosen_files
from deltamesh_cli.output import message
from deltamesh_cli.signals import stopping_cleanly
from deltamesh_cli.value_types import FILE, FOLDER, positive, size, whole
from deltamesh_formats.errors import OptionError

if TYPE_CHECKING:
    from deltamesh_cli.batch.engines import Engine

_EXAMPLES = """\
deltamesh batch *.ply                         writes beside the inputs
deltamesh batch -r scans --output-dir-mirror packed -j 0
deltamesh batch -r scans -j 4 --manifest run.jsonl --resume
deltamesh batch -r scans --include '*.stl' --exclude 'draft*' -n
deltamesh batch -d -r packed --output-dir-flat meshes --output-format obj
find scans -name '*.ply' -print0 | deltamesh batch -0 --filelist - -j 0
deltamesh batch -r scans --manifest run.jsonl --resume --html run.html
deltamesh batch -r scans --scheduler tcp://head:8786 --manifest run.jsonl
deltamesh batch -r scans --slurm array -j 0      a share of a SLURM array
"""
_CODE = """\
The exit code is the largest of the exit codes of all files."""


@click.command(epilog=epilog(_EXAMPLES, _CODE))
@click.argument("inputs", type=FILE, metavar="[FILE|FOLDER]...", nargs=-1)
@click.option("-d", "--decode", is_flag=True, help="Decode .dmesh files instead of encoding.")
@chosen_files
@click.option(
    "--output-dir-flat",
    "flat",
    type=FOLDER,
    metavar="DIR",
    help="Write all outputs into DIR. If two would have the same name, nothing is done.",
)
@click.option(
    "--output-dir-mirror",
    "mirror",
    type=FOLDER,
    metavar="DIR",
    help="Write outputs into folders in DIR that have the same paths as those of the inputs.",
)
@click.option("-f", "--force", is_flag=True, help="Overwrite outputs, and start the manifest anew.")
@click.option("--skip-existing", is_flag=True, help="Leave out files whose output exists.")
@click.option(
    "-n",
    "--dry-run",
    "dry",
    is_flag=True,
    help="Print what a run would do without doing anything.",
)
@click.option(
    "-j",
    "--jobs",
    type=whole(0),
    metavar="N",
    help="Work on N files at once, each in a process with one thread; 0 means one per core."
    "  [default: 1, in this process]",
)
@click.option(
    "--memory",
    type=size,
    metavar="SIZE",
    help="Limit on the estimated memory of all files that are processed at the same time, such as"
    " 8G. With -j, a mesh that needs more is encoded alone. With -d, a file that needs more is"
    " refused.  [default with -j: all memory of the machine; with -d: 16G per file]",
)
@click.option(
    "--timeout",
    type=positive,
    metavar="SECONDS",
    help="Give up a file after this time and kill the process that works on it.",
)
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Work on the Dask cluster whose scheduler has this address, such as tcp://head:8786, or"
    " this --scheduler-file. Its workers need access to the same files; extra `cluster`.",
)
@click.option(
    "--dask-local",
    type=whole(1),
    metavar="N",
    help="Work on a Dask cluster of N processes on this machine, which ends with the run; extra"
    " `cluster`.",
)
@click.option(
    "--rank",
    type=whole(0),
    metavar="R",
    help="Process only the share of machine R, counted from 0: with --world-size W, every W-th"
    " file.",
)
@click.option("--world-size", type=whole(1), metavar="W", help="Number of machines.")
@click.option(
    "--slurm",
    type=click.Choice(list(SLURM)),
    help="Take rank and world size from SLURM: from a task of a job array, or of a job step.",
)
@click.option(
    "--manifest",
    type=FILE,
    metavar="FILE",
    help="Keep a record of each file in FILE, one JSON object per line.",
)
@click.option(
    "--resume",
    is_flag=True,
    help="Continue with the manifest: files that it records as done are skipped, unless they have"
    " changed or were made with other options or by another version.",
)
@click.option(
    "--html",
    "page",
    type=FILE,
    metavar="PAGE",
    help="Write a page with a row for each file, and as many .dmesh files as fit, to look at. -f,"
    " --resume and --skip-existing overwrite it.",
)
@encode_options
@options.output_format
@options.digits
@options.max_vertices
@options.reporting
def command(
    inputs: tuple[str, ...],
    decode: bool,
    choice: Choice,
    flat: str | None,
    mirror: str | None,
    force: bool,
    skip_existing: bool,
    dry: bool,
    jobs: int | None,
    memory: int | None,
    timeout: float | None,
    scheduler: str | None,
    dask_local: int | None,
    rank: int | None,
    world_size: int | None,
    slurm: str | None,
    manifest: str | None,
    resume: bool,
    page: str | None,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    show_progress: bool | None,
    **parameters: Any,
) -> None:
    """Encode or decode many files.

    A FILE is a mesh file or, with -d, a .dmesh file, and may be compressed, as scan.ply.gz or
    scan.ply.zst. A FOLDER stands for all such files in it. A quoted pattern such as
    'scans/**/*.ply' is matched by this program. Files are sorted by name, and each is processed
    once. Each output has the same bytes as that of deltamesh encode or decode, regardless of the
    number and the kind of workers.

    A file that fails is reported, and the others are processed. Outputs are written beside the
    inputs unless a folder is given, and existing ones are overwritten only with -f. After an
    interruption, even by kill -9 or a power failure, the same command with --manifest and --resume
    completes the run.

    Files, folders, patterns, lists and output folders may be URLs, such as s3://bucket/scans, with
    the extra `remote`. Workers read and write them themselves, and need share no disk.

    All options of deltamesh encode apply, or with -d all options of deltamesh decode, but those of
    sequences: each mesh file becomes a file of its own, and of a sequence, frame 0 is decoded.
    """
    context = click.get_current_context()
    refuse_two_of(context, "flat", "mirror")
    refuse_two_of(context, "force", "skip_existing")
    refuse_two_of(context, "jobs", "scheduler", "dask_local")
    refuse_two_of(context, "timeout", "scheduler", "dask_local")
    if not decode:
        refuse_two_of(context, "memory", "scheduler", "dask_local")
    if resume and manifest is None:
        raise click.UsageError("--resume needs --manifest.")
    choice.require(inputs)
    on_cluster = scheduler is not None or dask_local is not None
    in_parallel = timeout is not None or jobs not in (None, 1)
    engine: Engine = here
    if on_cluster:
        engine = on_dask(scheduler, dask_local or 0)
    elif in_parallel:
        count = available_cores() if jobs == 0 else jobs or 1
        engine = in_processes(count, memory or physical_memory() or inf, timeout or inf)
    existing = ExistingFiles(manifest, resume, force, skip_existing)
    verbosity = Verbosity(as_json, quiet, verbose, show_progress)
    destinations = Destinations(flat, mirror)
    try:
        job = job_of(context, decode, memory, parameters, one_thread=on_cluster or in_parallel)
        planned = plan_files(job, destinations, inputs, choice)
        planned = share(planned, *rank_of(rank, world_size, slurm))
        if not planned:
            message("deltamesh: there is nothing to do")
        if dry:
            context.exit(dry_run(planned, job, existing, verbosity))
        with stopping_cleanly():
            if page is None:
                context.exit(run_batch(planned, job, engine, existing, verbosity))
            from deltamesh_cli.reports.files import reported

            with reported(page, planned, existing, decode) as listen:
                code = run_batch(planned, job, engine, existing, verbosity, listen)
        context.exit(code)
    except OptionError as error:
        raise click.UsageError(str(error)) from error
    except Failure as failure:
        report_failure(failure)
        context.exit(failure.code)
