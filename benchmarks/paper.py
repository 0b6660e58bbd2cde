"""Tables of docs/paper.md: the statements of the paper behind the codec, measured.

D. Cohen-Or, O. Sorkine, "Encoding Meshes in Differential Coordinates", SCCG 2006.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import click
import corpus
import paper_anchors
import paper_bases
import paper_bounds
import paper_edits
import paper_graphs
import paper_shapes
import paper_spectra
from pages import replaced
from paper_models import is_there
from paper_tables import Table, markdown

_MODULES = (
    paper_graphs,
    paper_spectra,
    paper_shapes,
    paper_anchors,
    paper_bounds,
    paper_bases,
    paper_edits,
)
TABLES: Mapping[str, Table] = {one.name: one for module in _MODULES for one in module.TABLES}

PAGE = Path(__file__).parents[1] / "docs" / "paper.md"

_EXAMPLES = """\
python benchmarks/paper.py
python benchmarks/paper.py predictions spectrum
python benchmarks/paper.py --quick rows"""


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.argument("names", nargs=-1, metavar="[TABLE]...", type=click.Choice(list(TABLES)))
@click.option("--write", is_flag=True, help="Write the tables into docs/paper.md instead.")
@click.option(
    "--quick", is_flag=True, help="Measure only what is small, and made by the repository."
)
def command(names: tuple[str, ...], quick: bool, write: bool) -> None:
    """Print tables of docs/paper.md, all by default, as Markdown.

    Meshes that are not there are skipped, and named on standard error.
    """
    for name in names or TABLES:
        table = TABLES[name]
        wanted = table.quick if quick else table.quick + table.slow
        for one in wanted:
            if not is_there(one):
                click.echo(f"{name}: skipped, no {one}", err=True)
        text = markdown(table, table.measured(wanted))
        if write:
            PAGE.write_text(
                replaced(PAGE.read_text(encoding="utf-8"), name, text), encoding="utf-8"
            )
        else:
            click.echo(f"{name}\n\n{text}\n")


if __name__ == "__main__":
    command()
