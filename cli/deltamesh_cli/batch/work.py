"""Work of `deltamesh batch` on one file: it turns a task into a record, in any process."""

from __future__ import annotations

import io
import json
import time
import traceback
import warnings
from dataclasses import dataclass
from typing import Any, Final

from deltamesh._options import CHOICES
from deltamesh._progress import silent
from deltamesh._version import __version__
from deltamesh.batch import DONE, FAILED, SKIPPED, Record, Task, file_state
from deltamesh_cli import files, options
from deltamesh_cli.decoding import decode_to_file
from deltamesh_cli.encoding import encode_file
from deltamesh_cli.failures import Failure, attempt, failure_object
from deltamesh_cli.meshes import memory_notes, parse_container
from deltamesh_cli.output import display_name
from deltamesh_cli.summary import errors_object
from deltamesh_formats.container.container import Container
from deltamesh_formats.errors import NoSurfaceError

_TETRAHEDRON: Final = b"""OFF
4 4 0
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 1 2 3
3 0 3 2
"""

# Options that change how fast an output is made, or whether it is, but not its bytes.
_OF_NO_EFFECT: Final = ("threads", "memory", "max_vertices")


@dataclass(frozen=True)
class Job:
    """Operation on each file of a batch, with its options.

    Attributes
    ----------
    decode : bool
        Whether `.dmesh` files are decoded; otherwise mesh files are encoded.
    file_format : str or None
        Format of the mesh files; None if their names determine it.
    parameters : dict
        The other options of `deltamesh encode` or `deltamesh decode`, by name.
    debug : bool
        Whether the record of a failure has the traceback.
    """

    decode: bool
    file_format: str | None
    parameters: dict[str, Any]
    debug: bool = False

    @property
    def problem(self) -> str:
        """The problem with a file that fails."""
        return "cannot decode" if self.decode else "cannot encode"

    def options(self) -> Record:
        """Return everything but the input that the output depends on, as JSON represents it."""
        specified = options.specified({"format": self.file_format, **self.parameters})
        for name in _OF_NO_EFFECT:
            specified.pop(name, None)
        as_json: Record = json.loads(json.dumps({"decode": self.decode, **specified}))
        return as_json


def work(job: Job, task: Task) -> Record:
    """Encode or decode a file and return its record; a failure is a record, too."""
    start = time.perf_counter()
    try:
        # The plan has settled outputs that exist, and task.overwrite decides after the work.
        files.check_output(task.source, task.target, force=True)
        with attempt(task.source, "cannot read"):
            source_state = file_state(task.source, "source")
        container, lost = _decode(job, task) if job.decode else _encode(job, task)
        with attempt(task.target, "cannot read"):
            target_state = file_state(task.target, "target")
    except Failure as failure:
        seconds = time.perf_counter() - start
        if isinstance(failure.error, NoSurfaceError):
            return _skipped_record(job, task, failure, seconds)
        return failure_record(job, task, failure, seconds)
    return {
        "status": DONE,
        "source": task.source,
        "target": task.target,
        **source_state,
        **target_state,
        "vertices": container.vertices,
        "faces": container.triangles,
        "not_kept": list(lost),
        "notes": [] if job.decode else memory_notes(task.target, container),
        "errors": None if container.meta is None else errors_object(container.meta),
        "seconds": time.perf_counter() - start,
        "options": job.options(),
        "version": __version__,
    }


def failure_record(job: Job, task: Task, failure: Failure, seconds: float | None = None) -> Record:
    """Return the record of a file that could not be processed."""
    described = failure_object(failure)
    trace = "".join(traceback.format_exception(failure.error)) if job.debug else None
    return {
        "status": FAILED,
        "source": task.source,
        "target": task.target,
        "source_bytes": task.size,
        "error": described["error"],
        "exit_code": described["exit_code"],
        "message": str(failure),
        **({} if trace is None else {"traceback": trace}),
        "seconds": seconds,
        "options": job.options(),
        "version": __version__,
    }


def _skipped_record(job: Job, task: Task, failure: Failure, seconds: float) -> Record:
    """Return the record of a file that holds points or lines, which is no fault of it."""
    return {
        "status": SKIPPED,
        "source": task.source,
        "target": task.target,
        "source_bytes": task.size,
        "message": f"{display_name(task.source)}: skipped: {failure.reason}",
        "seconds": seconds,
        "options": job.options(),
        "version": __version__,
    }


def _encode(job: Job, task: Task) -> tuple[Container, tuple[str, ...]]:
    source, target = task.source, task.target
    encoded = encode_file(
        source, target, job.file_format, silent, job.parameters, force=task.overwrite
    )
    return encoded.container, encoded.lost


def _decode(job: Job, task: Task) -> tuple[Container, tuple[str, ...]]:
    source, target = task.source, task.target
    container = parse_container(source, files.read_input(source, job.parameters), job.problem)
    file_format = job.file_format or files.extension(target)
    _, lost = decode_to_file(
        target, file_format, source, container, silent, job.parameters, force=task.overwrite
    )
    return container, lost


def prepare(job: Job) -> None:
    """Load the codec before the clock of a file runs."""
    warnings.simplefilter("ignore")  # as in deltamesh_cli.program
    import deltamesh
    from deltamesh_formats.meshfiles.files import read_mesh

    mesh, method = read_mesh(io.BytesIO(_TETRAHEDRON), "off"), job.parameters.get("method")
    for one in [method] if method in CHOICES else CHOICES:
        deltamesh.decode(deltamesh.encode(mesh.vertices, mesh.triangles, method=one, threads=1))
