"""Ends of help pages."""

from __future__ import annotations

import textwrap

from deltamesh_cli.failures import EXIT_CODES


def epilog(examples: str, *explanations: str) -> str:
    """Return the end of a help page, kept line by line: explanations, examples, exit codes."""
    indented = textwrap.indent(textwrap.dedent(examples).strip(), "  ")
    blocks = [*explanations, f"Examples:\n{indented}", EXIT_CODES]
    return "\n\n".join(f"\b\n{block}" for block in blocks)
