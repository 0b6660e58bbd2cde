"""Writing of reports: refused before the work begins, or written whole after it."""

from __future__ import annotations

from collections.abc import Callable

from deltamesh._page.filling import REPORT, template
from deltamesh_cli import files
from deltamesh_cli.failures import attempt


def check_report(target: str, *, force: bool) -> None:
    """Refuse a report that cannot be written, before the work begins.

    Raises
    ------
    Failure
        If the file cannot be written, or this installation has no page to fill.
    """
    files.check_output(files.STDIO, target, force=force, text=True)
    with attempt(target, "cannot write"):
        template(REPORT)


def write_report(target: str, make: Callable[[], str], *, force: bool) -> None:
    """Write a report; with `force` an existing file is overwritten.

    Raises
    ------
    Failure
        If it cannot be written.
    """
    with attempt(target, "cannot write"):
        text = make()
    files.write_output(target, text.encode(), force=force)
