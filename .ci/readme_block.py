"""Print a block of the README that is marked to be run: the fenced code under `<!-- run: NAME -->`.

python .ci/readme_block.py NAME
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

README = Path(__file__).parents[1] / "README.md"


def block(name: str, document: Path = README) -> str:
    """Return the code of the one block of that name in a document.

    Raises
    ------
    LookupError
        If there is none, or more than one.
    """
    pattern = rf"^<!-- run: {re.escape(name)} -->\n+```\w+\n(.*?)^```$"
    found = re.findall(pattern, document.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    if len(found) != 1:
        raise LookupError(f"{document.name} has {len(found)} blocks marked 'run: {name}'")
    return str(found[0])


if __name__ == "__main__":
    sys.stdout.write(block(sys.argv[1]))
