"""`python -m deltamesh`, the same as the command `deltamesh`.

The command line is a layer above this one, which must not import it. So this asks the installed
distribution which function its command is.
"""

from __future__ import annotations

import sys
from importlib.metadata import PackageNotFoundError, distribution


def main() -> None:
    """Run the command that the distribution declares."""
    try:
        (command,) = distribution("deltamesh").entry_points.select(
            group="console_scripts", name="deltamesh"
        )
    except (PackageNotFoundError, ValueError):
        sys.exit("deltamesh: not installed, so there is no command: pip install deltamesh")
    command.load()()


if __name__ == "__main__":
    main()
