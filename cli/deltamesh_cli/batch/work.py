"""What `deltamesh batch` does with one file: a task in, a record out, here or in any process."""

from __future__ import annotations

import io
import json
import time
import traceback
import warnings
from dataclasses import dataclass
from typing import Any, Final

from deltamesh._options import CHOICES
from deltamesh._version import __version__
from deltamesh.batch import DONE, FAILED, Record, Task, file_state
from deltamesh_cli import files, options, summary
from deltamesh_cli.commands.decode import decode_into
from deltamesh_cli.commands.encode import encode_file
from deltamesh_cli.failures import Failure, as_object, attempt
from deltamesh_cli.meshes import container_of
from deltamesh_formats.container.layout import Container

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

# Options that change how fast an output is made, or whether, but not what is in it.
_OF_NO_EFFECT: Final = ("threads", "memory", "max_vertices")


@dataclass(frozen=True)
class Job:
    """What is done with each file.

    Attributes
    ----------
    decode : bool
        Whether `.dmesh` files become meshes, or meshes `.dmesh` files.
    file_format : str or None
        Of the mesh files; None where their names tell.
    parameters : dict
        The other options of `deltamesh encode` or `deltamesh decode`, by name.
    debug : bool
        Whether the record of a file that fails has the traceback.
    """

    decode: bool
    file_format: str | None
    parameters: dict[str, Any]
    debug: bool = False

    @property
    def what(self) -> str:
        """What it means that a file fails."""
        return "cannot decode" if self.decode else "cannot encode"

    def options(self) -> Record:
        """Return what the output depends on, but for the input, as JSON gives it back."""
        given = options.given({"format": self.file_format, **self.parameters})
        for name in _OF_NO_EFFECT:
            given.pop(name, None)
        chosen: Record = json.loads(json.dumps({"decode": self.decode, **given}))
        return chosen


def work(job: Job, task: Task) -> Record:
    """Encode or decode a file, and return the record of what became of it; nothing is raised."""
    start = time.perf_counter()
    try:
        # A file that exists has been settled before, and after the work task.overwrite decides.
        files.check_output(task.source, task.target, force=True)
        with attempt(task.source, "cannot read"):
            before = file_state(task.source, "source")
        container, lost = _decode(job, task) if job.decode else _encode(job, task)
        with attempt(task.target, "cannot read"):
            after = file_state(task.target, "target")
    except Failure as failure:
        return failed(job, task, failure, time.perf_counter() - start)
    return {
        "status": DONE,
        "source": task.source,
        "target": task.target,
        **before,
        **after,
        "vertices": container.vertices,
        "faces": container.faces,
        "not_kept": list(lost),
        "errors": None if container.meta is None else summary.errors(container.meta),
        "seconds": time.perf_counter() - start,
        "options": job.options(),
        "version": __version__,
    }


def failed(job: Job, task: Task, failure: Failure, seconds: float | None = None) -> Record:
    """Return the record of a file that could not be processed."""
    told = as_object(failure)
    trace = "".join(traceback.format_exception(failure.error)) if job.debug else None
    return {
        "status": FAILED,
        "source": task.source,
        "target": task.target,
        "source_bytes": task.size,
        "error": told["error"],
        "exit_code": told["exit_code"],
        "message": str(failure),
        **({} if trace is None else {"traceback": trace}),
        "seconds": seconds,
        "options": job.options(),
        "version": __version__,
    }


def _encode(job: Job, task: Task) -> tuple[Container, tuple[str, ...]]:
    source, target = task.source, task.target
    _, data, lost = encode_file(
        source, target, job.file_format, _silent, job.parameters, force=task.overwrite
    )
    return container_of(target, data, job.what), lost


def _decode(job: Job, task: Task) -> tuple[Container, tuple[str, ...]]:
    data = files.read_input(task.source)
    container = container_of(task.source, data, job.what)
    file_format = job.file_format or files.extension(task.target)
    _, lost = decode_into(
        task.target, file_format, task.source, data, _silent, job.parameters, force=task.overwrite
    )
    return container, lost


def _silent(stage: str) -> None:
    """Tell nobody."""


def prepare(job: Job) -> None:
    """Load the codec, or compile it after an installation, before the clock of a file runs."""
    warnings.simplefilter("ignore")  # as in deltamesh_cli.program
    import deltamesh
    from deltamesh_formats.meshfiles.files import read_mesh

    mesh, method = read_mesh(io.BytesIO(_TETRAHEDRON), "off"), job.parameters.get("method")
    for one in [method] if method in CHOICES else CHOICES:
        deltamesh.decode(deltamesh.encode(mesh.vertices, mesh.triangles, method=one, threads=1))
