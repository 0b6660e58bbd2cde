"""Folders of the repository that tests read."""

from __future__ import annotations

from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).parents[2]
SUPPORT: Final = Path(__file__).parent
BENCHMARKS: Final = ROOT / "benchmarks"
GOLDEN: Final = ROOT / "tests" / "data" / "golden"
REFUSED: Final = ROOT / "tests" / "data" / "refused"
