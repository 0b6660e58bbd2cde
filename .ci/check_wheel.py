"""Check of a wheel of another system: its tag, the kind of its library, and what that exports.

`python .ci/check_wheel.py TARGET WHEEL`; the targets are those of `src/core/build.py`.
"""

from __future__ import annotations

import re
import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "src" / "core"))
import build  # noqa: E402

# How a library of each system begins, and of which processor it says that it is.
KINDS = {
    "x86_64-linux": (b"\x7fELF\x02\x01", 18, b"\x3e\x00"),
    "aarch64-linux": (b"\x7fELF\x02\x01", 18, b"\xb7\x00"),
    "x86_64-macos": (b"\xcf\xfa\xed\xfe", 4, b"\x07\x00\x00\x01"),
    "aarch64-macos": (b"\xcf\xfa\xed\xfe", 4, b"\x0c\x00\x00\x01"),
    "x86_64-windows": (b"MZ", None, b"\x64\x86"),
}


def main(target: str, wheel: Path) -> None:
    """Check one wheel.

    Raises
    ------
    AssertionError
    """
    tag = f"py3-none-{build.TARGETS[target]}.whl"
    assert wheel.name.endswith(tag), f"{wheel.name}: not {tag}"
    with zipfile.ZipFile(wheel) as archive:
        names = [name for name in names_of(wheel) if "/_core." in name]
        assert [Path(name).name for name in names] == [build.library_of(target).name], names
        library = archive.read(names[0])
    magic, at, machine = KINDS["-".join(target.split(".")[0].split("-")[:2])]
    assert library.startswith(magic), f"{wheel.name}: {library[:8]!r}"
    if at is None:  # of a PE file: behind the signature that its header points to
        at = int.from_bytes(library[60:64], "little") + 4
    assert library[at : at + len(machine)] == machine, f"{wheel.name}: another processor"
    header = (ROOT / "src" / "core" / "deltamesh_core.h").read_text(encoding="utf-8")
    exported = re.findall(r"DM_API [^;]*?\b(dm_\w+)[(\[]", header)
    missing = [name for name in exported if name.encode() not in library]
    assert len(exported) > 50, exported
    assert not missing, f"{wheel.name}: {missing}"
    pages = [name for name in names_of(wheel) if re.search(r"/_page/\w+\.html$", name)]
    assert len(pages) == 2, f"{wheel.name}: {pages}"
    print(f"{wheel.name}: {len(library)} bytes of library, {len(exported)} names")


def names_of(wheel: Path) -> list[str]:
    """Return the names of the files in a wheel."""
    with zipfile.ZipFile(wheel) as archive:
        return archive.namelist()


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
