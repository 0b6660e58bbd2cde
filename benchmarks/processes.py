"""What a whole process takes: seconds, CPU seconds, and its peak memory.

A child's `ru_maxrss` starts at what its parent had resident when it was started (getrusage(2) and
exec on Linux), and a parent with scipy in it has a lot. So each command is started by a bare
interpreter that runs this file as a script and imports next to nothing. POSIX only.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from typing import NamedTuple

# Seconds; no command that is measured takes nearly as long.
_LIMIT = 3600


class Usage(NamedTuple):
    """What a process took.

    Attributes
    ----------
    seconds : float
        From its start to its end.
    cpu : float
        Those of all its threads, in user and in system mode.
    peak : int
        Largest resident set, in bytes.
    """

    seconds: float
    cpu: float
    peak: int


def deltamesh(*arguments: object) -> Usage:
    """Run a `deltamesh` command of this interpreter's environment, as `python` does."""
    return python("-m", "deltamesh_cli", *arguments)


def python(*arguments: object) -> Usage:
    """Run this interpreter; its output goes nowhere.

    Raises
    ------
    RuntimeError
        When it fails, with what it said.
    subprocess.TimeoutExpired
        When it has not ended after an hour.
    """
    command = [sys.executable, *map(str, arguments)]
    launcher = [sys.executable, "-I", "-S", __file__, *command]
    done = subprocess.run(launcher, capture_output=True, text=True, timeout=_LIMIT)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip()}")
    return Usage(**json.loads(done.stdout))


def main(command: list[str]) -> int:
    """Run a command, print what it took as JSON, and return its exit code."""
    start = time.perf_counter()
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    unit = 1 if sys.platform == "darwin" else 1024  # macOS counts bytes, others KiB
    cpu = used.ru_utime + used.ru_stime
    print(json.dumps({"seconds": seconds, "cpu": cpu, "peak": used.ru_maxrss * unit}))
    return process.returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
