"""Tables of the coder as C: `python src/core/make_tables.py > src/core/tables.c`.

They are part of the format. No entry is so near to a half-integer that an error of `math.log` or
`math.exp` in the last place could change its rounding; a test pins a digest of what is compiled.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

P_MIN = 24  # of 65536: a certain bit costs 0.0005 bits, a wrong certainty 11.4

HEAD = """\
/* Tables of the coder, written by make_tables.py. */
/* clang-format off */
#include "deltamesh_core.h"
"""


def squashed(x: int) -> int:
    """Return the probability in 1/65536 of a logistic number in 1/256."""
    return min(max(round(65536 / (1 + math.exp(-x / 256))), P_MIN), 65536 - P_MIN)


def printed(comment: str, declaration: str, entries: Iterable[int]) -> None:
    """Print one table, sixteen entries a line."""
    rows = list(entries)
    print(f"\n/* {comment} */\nconst {declaration} = {{")
    for at in range(0, len(rows), 16):
        print("    " + ", ".join(map(str, rows[at : at + 16])) + ",")
    print("};")


def main() -> None:
    """Print the tables."""
    print(HEAD, end="")
    printed(
        "ln(p / (1 - p)) in 1/256, for p in 1/4096.",
        "int16_t dm_stretch[4096]",
        (round(256 * math.log((p + 0.5) / (4095.5 - p))) for p in range(4096)),
    )
    squash = map(squashed, range(-2048, 2048))
    printed("Its inverse: p in 1/65536.", "int32_t dm_squash[4096]", squash)
    printed(
        "The rate at which a slot that has seen n bits moves towards the next, in 1/65536: that\n"
        "   of a running mean, with 1.8 for the 1.5 of Krichevsky and Trofimov's estimator, which\n"
        "   measured best.",
        "int32_t dm_rate[1024]",
        (int(65536 / (n + 1.8)) for n in range(1024)),
    )


if __name__ == "__main__":
    main()
