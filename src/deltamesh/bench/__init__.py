"""Benchmarks of codecs: measurements of meshes under them, and tables of rates.

`measure` encodes a mesh with a `Codec`, decodes the file and compares; `codec_of` makes one of a
label such as "refined bits=6" or "draco bits=11". `row_of`, `as_text` and `from_text` keep
measurements as tables, and `changes` compares two of them. `deltamesh bench` is made of these. They
are imported when one of them is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from deltamesh.bench._measure import (
        Codec,
        Measurement,
        codec_of,
        label,
        measure,
        measured,
        warm_up,
    )
    from deltamesh.bench._peer_names import PEER_NAMES
    from deltamesh.bench._peers import PEERS, Coded, labels, missing
    from deltamesh.bench._rates import (
        COLUMNS,
        SECONDS,
        Change,
        Row,
        as_text,
        changes,
        from_text,
        row_of,
    )
    from deltamesh.bench._views import Views

_HOME = {
    "COLUMNS": "_rates",
    "Change": "_rates",
    "Codec": "_measure",
    "Coded": "_peers",
    "Measurement": "_measure",
    "PEERS": "_peers",
    "PEER_NAMES": "_peer_names",
    "Row": "_rates",
    "SECONDS": "_rates",
    "Views": "_views",
    "as_text": "_rates",
    "changes": "_rates",
    "codec_of": "_measure",
    "from_text": "_rates",
    "label": "_measure",
    "labels": "_peers",
    "measure": "_measure",
    "measured": "_measure",
    "missing": "_peers",
    "row_of": "_rates",
    "warm_up": "_measure",
}

__all__ = [
    "COLUMNS",
    "PEERS",
    "PEER_NAMES",
    "SECONDS",
    "Change",
    "Codec",
    "Coded",
    "Measurement",
    "Row",
    "Views",
    "as_text",
    "changes",
    "codec_of",
    "from_text",
    "label",
    "labels",
    "measure",
    "measured",
    "missing",
    "row_of",
    "warm_up",
]


def __getattr__(name: str) -> Any:
    """Import what was asked for."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    import importlib

    return getattr(importlib.import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return __all__
