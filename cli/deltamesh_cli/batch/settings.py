"""Settings of a run of `deltamesh batch`: what becomes of files that exist, and what is printed."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ExistingFiles:
    """Treatment of files that exist: of outputs, and of the manifest.

    Attributes
    ----------
    manifest : str or None
        Name of the manifest, if one is kept.
    resume : bool
        Whether files that the manifest records as done are not done again.
    force, skip_existing : bool
        Whether existing outputs are overwritten, or left.
    """

    manifest: str | None = None
    resume: bool = False
    force: bool = False
    skip_existing: bool = False


@dataclass(frozen=True)
class Verbosity:
    """Amount and format of the printed output: the options that all commands have."""

    as_json: bool = False
    quiet: bool = False
    verbose: bool = False
    show_progress: bool | None = None
