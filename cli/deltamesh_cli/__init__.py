"""The command line of deltamesh: flags in, a library call, a message out.

Each command is a module of `commands`, named as the command is. Importing this package imports
neither click nor anything of the codec; a command imports the codec when it runs (`--help` and
`info` must answer within 0.3 seconds, and numba alone takes longer than that to import).
"""

from __future__ import annotations


def main() -> None:
    """Run the command line and exit with its code."""
    from deltamesh_cli.program import run_and_exit

    run_and_exit()
