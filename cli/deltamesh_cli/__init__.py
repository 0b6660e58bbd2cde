"""The command line of deltamesh: it turns flags into a library call and the result into a message.

Each command is the module of `commands` that has its name. Importing this package imports neither
click nor any part of the codec; a command imports the codec when it runs, because `--help` and
`info` have to answer within 0.1 seconds, and numpy alone takes longer than that to import.
"""

from __future__ import annotations

import os


def main() -> None:
    """Run the command line and exit with its code."""
    # The BLAS of numpy starts a thread for each core when it is imported: a third of the time of an
    # import. No dense matrix here is large enough for threads to share it.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from deltamesh_cli.program import run_and_exit

    run_and_exit()
