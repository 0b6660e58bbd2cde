"""`deltamesh batch`: many files, on one machine or many."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any

import click

from deltamesh.batch import available_cores, physical_memory, share
from deltamesh_cli import options
from deltamesh_cli.batch.engines import here, in_processes, on_dask
from deltamesh_cli.batch.options import SLURM, job_of, rank_of, refuse_two_of, with_options_of_both
from deltamesh_cli.batch.plan import Places, listed, planned, selection
from deltamesh_cli.batch.run import Keeping, Telling, dry_run
from deltamesh_cli.batch.run import run as run_batch
from deltamesh_cli.failures import Failure, report
from deltamesh_cli.signals import stopping_cleanly
from deltamesh_formats.errors import OptionError

if TYPE_CHECKING:
    from deltamesh_cli.batch.engines import Engine

_EXAMPLES = """\
deltamesh batch *.ply                         writes each beside its input
deltamesh batch -r scans --output-dir-mirror packed -j 0
deltamesh batch -r scans -j 4 --manifest run.jsonl --resume
deltamesh batch -r scans --include '*.stl' --exclude 'draft*' -n
deltamesh batch -d -r packed --output-dir-flat meshes --output-format obj
find scans -name '*.ply' -print0 | deltamesh batch -0 --filelist - -j 0
deltamesh batch -r scans --scheduler tcp://head:8786 --manifest run.jsonl
deltamesh batch -r scans --slurm array -j 0      one share of a SLURM array
"""
_CODE = """\
The exit code is that of the worst file: the largest."""


@with_options_of_both
@click.command(epilog=options.epilog(_EXAMPLES, _CODE))
@click.argument("inputs", type=options.FILE, metavar="[FILE|FOLDER]...", nargs=-1)
@click.option("-d", "--decode", is_flag=True, help="Decode .dmesh files, instead of encoding.")
@click.option("-r", "--recursive", is_flag=True, help="Take the files in folders, at any depth.")
@click.option(
    "--filelist",
    "lists",
    type=options.FILE,
    metavar="LIST",
    multiple=True,
    help="Take the files that are named in LIST too, one a line; - is standard input.",
)
@click.option(
    "-0", "--null", is_flag=True, help="Names in LIST end with a NUL, as find -print0 writes them."
)
@click.option(
    "--include",
    metavar="PATTERN",
    multiple=True,
    help="Take only what matches, such as '*.stl'. With a slash in PATTERN it is the whole path"
    " that has to match.",
)
@click.option(
    "--exclude", metavar="PATTERN", multiple=True, help="Leave out what matches, folders too."
)
@click.option(
    "--output-dir-flat",
    "flat",
    type=options.FOLDER,
    metavar="DIR",
    help="Write all files into DIR. Two of one name are refused before anything is done.",
)
@click.option(
    "--output-dir-mirror",
    "mirror",
    type=options.FOLDER,
    metavar="DIR",
    help="Write files into folders in DIR that are named as those of the inputs.",
)
@click.option("-f", "--force", is_flag=True, help="Overwrite outputs, and begin a manifest anew.")
@click.option("--skip-existing", is_flag=True, help="Leave out files whose output exists.")
@click.option("-n", "--dry-run", "dry", is_flag=True, help="Tell what would be done, do nothing.")
@click.option(
    "-j",
    "--jobs",
    type=options.whole(0),
    metavar="N",
    help="Work on N files at once, each in a process with one thread; 0 is one a core."
    "  [default: 1, in this process]",
)
@click.option(
    "--memory",
    type=options.size,
    metavar="SIZE",
    help="What all files at work may need together, by estimate, such as 8G. With -j, a mesh that"
    " needs more is encoded alone; a .dmesh that needs more is refused.  [default: -j: all there"
    " is; -d: 16G a file]",
)
@click.option(
    "--timeout",
    type=options.length,
    metavar="SECONDS",
    help="Give up a file after that long, and kill the process that works on it.",
)
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Work on the Dask cluster whose scheduler is there, such as tcp://head:8786, or a"
    " --scheduler-file. Its workers have to see the same files; extra `cluster`.",
)
@click.option(
    "--dask-local",
    type=options.whole(1),
    metavar="N",
    help="Work on a Dask cluster of N processes here, which ends with this run; extra `cluster`.",
)
@click.option(
    "--rank",
    type=options.whole(0),
    metavar="R",
    help="Do only the share of machine R, from 0, of --world-size machines: every W-th file.",
)
@click.option("--world-size", type=options.whole(1), metavar="W", help="How many machines.")
@click.option(
    "--slurm",
    type=click.Choice(list(SLURM)),
    help="Take rank and world size from SLURM: of the task of a job array, or of a step's task.",
)
@click.option(
    "--manifest",
    type=options.FILE,
    metavar="FILE",
    help="Keep a record of each file in FILE, one JSON object a line.",
)
@click.option(
    "--resume",
    is_flag=True,
    help="Go on with the manifest: what it says is done, with these options, by this version, and"
    " has not changed since, is not done again.",
)
@options.as_json
@options.verbosity
@options.debug
def command(
    inputs: tuple[str, ...],
    decode: bool,
    recursive: bool,
    lists: tuple[str, ...],
    null: bool,
    include: tuple[str, ...],
    exclude: tuple[str, ...],
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
    as_json: bool,
    quiet: bool,
    verbose: bool,
    show_progress: bool | None,
    **parameters: Any,
) -> None:
    """Encode or decode many files.

    FILE is a mesh file or, with -d, a .dmesh file; of a FOLDER all such files are taken. A pattern
    such as 'scans/**/*.ply', in quotes, is matched here. Names are sorted, and each file is taken
    once. The bytes of an output are those that deltamesh encode or decode writes, however many
    work on it and wherever.

    A file that fails is told, and the others go on. Outputs are written beside the inputs, unless
    a folder is given; one that exists is overwritten only with -f. After an interruption, even by
    kill -9 or a power failure, the same command with --manifest and --resume does what is left.

    All options of deltamesh encode hold here or, with -d, all of deltamesh decode.
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
    if not (inputs or lists):
        raise click.UsageError("No file, folder or --filelist is given.")
    on_cluster = scheduler is not None or dask_local is not None
    in_parallel = timeout is not None or jobs not in (None, 1)
    engine: Engine = here
    if on_cluster:
        engine = on_dask(scheduler, dask_local or 0)
    elif in_parallel:
        count = available_cores() if jobs == 0 else jobs or 1
        engine = in_processes(count, memory or physical_memory() or inf, timeout or inf)
    keeping = Keeping(manifest, resume, force, skip_existing)
    telling = Telling(as_json, quiet, verbose, show_progress)
    places = Places(flat, mirror)
    try:
        job = job_of(context, decode, memory, parameters, one_thread=on_cluster or in_parallel)
        names = [name for one in lists for name in listed(one, null=null)]
        chosen = selection(job, places, include, exclude, recursive)
        items = planned(job, places, inputs, names, chosen)
        items = share(items, *rank_of(rank, world_size, slurm))
        if not items:
            click.echo("deltamesh: there is nothing to do", err=True)
        if dry:
            context.exit(dry_run(items, job, keeping, telling))
        with stopping_cleanly():
            context.exit(run_batch(items, job, engine, keeping, telling))
    except OptionError as error:
        raise click.UsageError(str(error)) from error
    except Failure as failure:
        report(failure)
        context.exit(failure.code)
