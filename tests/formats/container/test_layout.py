"""The constants of the container against the tables of SPEC.md."""

from __future__ import annotations

import math
import re
import sys
from fractions import Fraction
from pathlib import Path
from typing import get_args

import children
import pytest
from format_constants import CONSTANTS, MODULES
from places import GOLDEN
from spec_tables import SPEC, spec_table, spec_tables

from deltamesh_formats.container import fields, layout, method_layouts
from deltamesh_formats.container import payload_layout as payloads
from deltamesh_formats.polymesh.kinds import Kind
from deltamesh_formats.polymesh.mesh import Domain, Role


def types():
    sizes = {name: (code.size, code.size) for name, code in fields.STRUCT_CODES.items()}
    varint, string = (1, fields.VARINT_MAX_BYTES), (1, 1 + fields.STRING_MAX_BYTES)
    return sizes | {"varint": varint, "string": string}


def size_text(kind):
    low, high = types()[kind]
    return str(low) if low == high else f"{low}-{high}"


def test_spec_types():
    assert [row[:2] for row in spec_table("1", "Type")] == [[k, size_text(k)] for k in types()]


@pytest.mark.parametrize(
    ("number", "tables"),
    [
        ("2", [layout.HEADER_FIELDS]),
        ("4.1", [layout.PARAMETER_FIELDS, layout.SEED_FIELDS]),
        ("4.2", [layout.META_FIELDS, layout.META_LOSS_FIELDS, layout.META_PART_FIELDS]),
        ("4.3", [layout.REGION_FIELDS]),
        ("5.7", [layout.CHECK_FIELDS]),
        (
            "5.12",
            [
                payloads.COLUMN_FIELDS,
                payloads.OPERATION_FIELDS,
                payloads.FORMAT_FIELDS,
            ],
        ),
        ("5.14", [payloads.INTEGER_FIELDS]),
        (
            "5.22",
            [
                payloads.SEQUENCE_FIELDS,
                payloads.FRAME_FIELDS,
                payloads.MAP_FIELDS,
            ],
        ),
    ],
)
def test_spec_byte_tables(number, tables):
    expected = []
    for table in tables:
        rows, offset = [], 0
        for name, kind in table:
            low, high = types()[kind]
            rows.append([name, "-" if offset is None else str(offset), size_text(kind), kind])
            offset = offset + low if offset is not None and low == high else None
        expected.append(rows)
    found = spec_tables(number, "Name", "Offset", "Size", "Type", "Range")
    assert [[row[:4] for row in rows] for rows in found] == expected


CODES = {
    ("5.11", "Anchor"): payloads.POLYGON_ANCHORS,
    ("5.12", "Operator"): payloads.OPERATORS,
    ("5.14", "Domain"): payloads.DOMAINS,
    ("5.14", "Role"): payloads.ROLES,
    ("5.14", "Type"): payloads.TYPES,
    ("5.14", "Coding"): payloads.CODINGS,
    ("5.15", "Kind"): payloads.KINDS,
    ("5.17", "Weights"): payloads.NORMAL_WEIGHTS,
    ("5.17", "Coding"): payloads.NORMAL_CODINGS,
    ("5.17", "State"): payloads.NORMAL_STATES,
}


@pytest.mark.parametrize(("number", "name"), CODES, ids=" ".join)
def test_spec_tables_of_codes(number, name):
    (rows,) = spec_tables(number, name, "Value")
    assert {row[0]: int(row[1]) for row in rows} == CODES[number, name]
    assert len(rows) == len(set(CODES[number, name].values()))


@pytest.mark.parametrize(
    ("number", "of", "masks"),
    [
        (
            "5.11",
            "`plan`",
            {
                "anchor": payloads.PLAN_ANCHOR,
                "newest": payloads.PLAN_NEWEST,
                "polygons_first": payloads.PLAN_POLYGONS_FIRST,
            },
        ),
        (
            "5.12",
            "`flags`",
            {
                "formats": payloads.COLUMN_FORMATS,
                "raw": payloads.COLUMN_RAW,
                "zeros": payloads.COLUMN_ZEROS,
                "operations": payloads.COLUMN_OPERATIONS,
                "double": payloads.COLUMN_DOUBLE,
                "deviations": payloads.COLUMN_DEVIATIONS,
            },
        ),
        (
            "5.14",
            "`flags`",
            {
                "normalized": payloads.NORMALIZED,
                "partly": payloads.PARTLY,
                "palette": payloads.PALETTE,
                "mixed": payloads.MIXED,
                "coding": 3 << payloads.CODING_AT,
                "first_none": payloads.FIRST_NONE,
            },
        ),
        (
            "5.22",
            "`flags`",
            {
                "key": payloads.FRAME_KEY,
                "cells": payloads.FRAME_CELLS,
                "corrections": payloads.FRAME_CORRECTIONS,
            },
        ),
        (
            "5.15",
            "the byte",
            {
                "kind": payloads.DIVISION_KIND,
                "partly": payloads.DIVISION_PARTLY,
                "moved": payloads.DIVISION_MOVED,
            },
        ),
    ],
)
def test_spec_tables_of_bits(number, of, masks):
    found = {}
    for bits, name, _ in spec_tables(number, f"Bits of {of}", "Name")[0]:
        low, *_, high = re.findall(r"\d", bits) * 2
        if name:
            found[name] = (2 << int(high)) - (1 << int(low))
    assert found == masks


def test_spec_says_what_fields_share_a_byte():
    text = " ".join(SPEC.split())
    assert (
        "Bits 0 and 1 of `what` are the domain, bits 2 and 3 the role, bits 4 to 7 the type" in text
    )
    assert (payloads.ROLE_AT, payloads.TYPE_AT) == (2, 4)
    assert "Bits 0 and 1 of `plan` are the *weights*, bit 2 is the coding" in text
    assert payloads.NORMAL_CODING_AT == 2
    assert "a byte, the *width*, 32 or 64" in text
    assert sorted(payloads.RAW_WIDTHS.values()) == [32, 64]
    assert (
        "a byte, its form; a varint, how many bytes it holds; in form 0, these. In form 1," in text
    )
    assert (payloads.BLOCK_PLAIN, payloads.BLOCK_DEFLATED) == (0, 1)
    assert "In form 2, a varint as in form 1; then so many bytes, one Zstandard frame" in text
    assert payloads.BLOCK_ZSTD == 2
    assert "`wedges` says: 0, wedges of the attribute's own; 1, the faces," in text
    assert "k + 2, the wedges of attribute k" in text
    assert (payloads.OWN_WEDGES, payloads.POLYGON_OWNERS, payloads.WEDGES_OF) == (
        0,
        1,
        2,
    )


def test_spec_ratios():
    text = re.search(r" c = (1, .*)\n", SPEC)[1]
    assert tuple(map(float, text.split(", "))) == payloads.QUARTERS
    assert "r(e) = c(e mod 4) * 2^-(e / 4)" in SPEC
    for k, ratio in enumerate(payloads.QUARTERS):
        # The double nearest to 2^(-k / 4): its neighbours are beyond, to the fourth power.
        low, high = (Fraction(math.nextafter(ratio, end)) for end in (0.0, 2.0))
        middle = [(side + Fraction(ratio)) / 2 for side in (low, high)]
        assert middle[0] ** 4 < Fraction(1, 2**k) < middle[1] ** 4
    assert len(payloads.QUARTERS) == payloads.PER_OCTAVE


def test_kernels_have_the_numbers_of_the_layout():
    """They are compiled apart, and their constants are their own."""
    from deltamesh._kernels.coding import steps

    anchors = {"first": steps.FIRST, "oldest": steps.OLDEST, "newest": steps.NEWEST}
    assert anchors == payloads.POLYGON_ANCHORS


def test_every_name_has_a_number():
    assert set(payloads.DOMAINS) == set(get_args(Domain))
    assert set(payloads.ROLES) == set(get_args(Role))
    assert set(payloads.CODINGS) == set(get_args(payloads.Coding))
    assert set(payloads.KINDS) == set(get_args(Kind))


SHUFFLED = """
import random, sys, typing

from deltamesh_formats.container import layout, method_layouts, payload_layout
from deltamesh_formats.polymesh import kinds, mesh

def shuffled(names):
    names = list(names)
    random.Random(7).shuffle(names)
    return names

# Before anything else is imported: what is derived from an order would be derived from this one.
for module, name in (
    (mesh, "Domain"), (mesh, "Role"), (kinds, "Kind"), (payload_layout, "Coding")
):
    setattr(module, name, typing.Literal[tuple(shuffled(typing.get_args(getattr(module, name))))])
kinds.KIND_WORDS = {name: kinds.KIND_WORDS[name] for name in shuffled(kinds.KIND_WORDS)}
for module in (layout, method_layouts, payload_layout):
    for name, table in vars(module).copy().items():
        if name.isupper() and isinstance(table, dict):
            setattr(module, name, {key: table[key] for key in shuffled(table)})

from pathlib import Path
import numpy as np
import deltamesh
from deltamesh_formats.container import attribute_table, reader, texts, writer

golden = Path(sys.argv[1])
for path in sorted(golden.glob("*.dmesh")):
    data = path.read_bytes()
    container = reader.read_container(data)
    assert writer.write_container(container) == data
    mesh = deltamesh.decode(container)
    if "ATTR" in container.sections:
        entries = attribute_table.entries_of(container)
        table = attribute_table.write_table(entries)
        assert bytes(container.sections["ATTR"].payload[: len(table)]) == table
    written = deltamesh.encode(mesh, method=container.parameters.method, keep_order=True)
    again = deltamesh.decode(written)
    assert [a.name for a in again.attributes] == [a.name for a in mesh.attributes]
    print(path.name, __import__("hashlib").sha256(written).hexdigest())
"""


@pytest.mark.slow
def test_no_order_of_names_is_in_the_bytes():
    """Mesh kinds, domains, roles and every table of codes may be listed in any order."""
    made = []
    for code in (SHUFFLED, SHUFFLED.replace("random.Random(7).shuffle(names)", "pass")):
        done = children.run([sys.executable, "-c", code, str(GOLDEN)], text=True)
        assert done.returncode == 0, done.stderr
        made.append(done.stdout)
    assert made[0] == made[1]
    assert len(made[0].splitlines()) == len(list(GOLDEN.glob("*.dmesh")))


def test_spec_header_values():
    ranges = {row[0]: row[4] for row in spec_table("2", "Name")}
    assert bytes.fromhex(ranges["magic"]) == layout.MAGIC
    assert ranges["version"] == str(layout.VERSION)
    assert ranges["vertices"] == ranges["triangles"] == f"0..2^{layout.MAX_COUNT.bit_length() - 1}"


def test_spec_section_order():
    rows = spec_table("3.2", "`id`")
    for column, method in ((2, "highpass"), (3, "cartesian"), (4, "refined"), (5, "lossless")):
        numbered = sorted((int(row[column]), row[0]) for row in rows if row[column].isdigit())
        assert [name for _, name in numbered] == list(method_layouts.METHODS[method].required)
        everything = sorted(
            (int(row[column].strip("()")), row[0])
            for row in rows
            if row[column].strip("()").isdigit()
        )
        present = {name for _, name in everything}
        assert tuple(name for _, name in everything) == method_layouts.required(method, present)
        assert [number for number, _ in everything] == list(range(1, len(everything) + 1))
    assert {row[0] for row in rows} == method_layouts.KNOWN
    assert rows[-1][0] == layout.CHECK


def test_spec_limits():
    values = {name: value.replace("2^", "2**") for name, value, _ in spec_table("3.3", "Name")}
    for name, value in values.items():
        base, _, power = value.partition("**")
        assert CONSTANTS[name] == int(base) ** int(power or 1)


def test_spec_codes():
    methods = {row[0]: int(row[1]) for row in spec_table("4.1", "`method`")}
    assert methods == {name: method.id for name, method in method_layouts.METHODS.items()}
    anchors = {row[0]: int(row[1]) for row in spec_table("4.1", "`anchor_method`")}
    assert anchors == {name or "none": code for name, code in layout.ANCHOR_METHODS.items()}
    bits = next(row[4] for row in spec_table("4.1", "Name") if row[0] == "bits")
    assert bits == f"0..{layout.MAX_BITS}, {layout.BITS_FROM_STEP}"


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__)
def test_layout_follows_the_order_of_the_spec(module):
    headings = re.findall(r"^#+ (\d[\d.]* .*)$", SPEC, flags=re.MULTILINE)
    anchors = [re.sub(r"[^\w -]", "", h).lower().replace(" ", "-") for h in headings]
    text = Path(module.__file__).read_text(encoding="utf-8")
    links = re.findall(r"^# SPEC\.md#(\S+)$", text, flags=re.MULTILINE)
    assert links
    assert [anchors.index(link) for link in links] == sorted(anchors.index(i) for i in links)


def test_spec_says_that_it_is_not_frozen():
    assert "**not frozen**" in SPEC.split("\n## ")[0]
