"""Names of the other codecs, which the command line lists without importing them."""

from __future__ import annotations

from typing import Final

DRACO: Final = "draco"
MESHOPT: Final = "meshopt"
ZSTD: Final = "zstd"
PEER_NAMES: Final = (DRACO, MESHOPT, ZSTD)
