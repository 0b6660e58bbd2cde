"""Tables of SPEC.md, for tests that compare them with the package."""

from __future__ import annotations

import re

from places import ROOT

SPEC = (ROOT / "formats" / "SPEC.md").read_text(encoding="utf-8")


def spec_tables(number, *heads):
    """Return the rows of all tables in a section of SPEC.md whose first columns are headed so."""
    text = re.split(r"^#+ ", SPEC, flags=re.MULTILINE)
    body = next(part for part in text if part.startswith(number + " "))
    tables = (t for t in re.split(r"\n\n", body) if t.startswith(f"| {' | '.join(heads)} |"))
    return [
        [
            [cell.strip().strip("`") for cell in row.strip("|").split("|")]
            for row in table.strip().splitlines()[2:]
        ]
        for table in tables
    ]


def spec_table(number, first):
    return spec_tables(number, first)[0]


def spec_offset(number, field):
    return next(int(row[1]) for row in spec_table(number, "Name") if row[0] == field)
