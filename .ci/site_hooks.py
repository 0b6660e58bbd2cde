"""Hooks of mkdocs: pages that are not in docs/, and links between files of the repository.

The same files are read on a page of the repository and on the site: what a link names is found from
the place of its page in the repository. Files that are no pages, such as LICENSE, are copied.
"""

from __future__ import annotations

import posixpath
import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[1]

# Places in the repository, by those on the site.
PAGES = {
    "index.md": "README.md",
    "commands.md": "cli/README.md",
    "format.md": "formats/SPEC.md",
    "changes.md": "CHANGELOG.md",
    "contributing.md": "CONTRIBUTING.md",
    "measurements.md": "benchmarks/README.md",
}
COPIES = {"license.txt": "LICENSE"}
_SITE = {there: here for here, there in (PAGES | COPIES).items()}
_LINK = re.compile(r"(\]\()([^)\s]+)(\))")
_COMMENT = re.compile(r"^<!-- (?:run|table).* -->\n", re.MULTILINE)


def on_files(files: Files, config: Any) -> Files:
    """Add the pages and copies from outside of docs/."""
    for here, there in (PAGES | COPIES).items():
        text = (ROOT / there).read_text(encoding="utf-8")
        files.append(File.generated(config, here, content=text))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Return the text of a page with links to places on the site."""
    here = page.file.src_uri
    folder = posixpath.dirname(PAGES.get(here, f"docs/{here}"))

    def on_site(link: re.Match[str]) -> str:
        target, mark, anchor = link[2].partition("#")
        if not target or "://" in target:
            return link[0]
        place = posixpath.normpath(posixpath.join(folder, target))
        found = _SITE.get(place, place.removeprefix("docs/"))
        return f"{link[1]}{found}{mark}{anchor}{link[3]}"

    return _LINK.sub(on_site, _COMMENT.sub("", markdown))
