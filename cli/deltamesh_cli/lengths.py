"""Lengths on the command line: a number in the unit of a file, with a unit of its own, or a share.

A share, such as 0.1%, is one of the diagonal of the bounding box. A length with a unit needs a file
that has one: 3MF and COLLADA name it, glTF is in metres.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from deltamesh_cli.options import flag_of
from deltamesh_cli.output import number
from deltamesh_cli.value_types import SHARE, Length
from deltamesh_formats.errors import OptionError
from deltamesh_formats.meshfiles.formats import format_of_extension
from deltamesh_formats.polymesh.units import METRES, SYMBOLS, metres

if TYPE_CHECKING:
    from deltamesh_formats.polymesh.mesh import PolyMesh

# Options that are lengths, and the option that each share of the diagonal is given to.
LENGTHS: Final = {"step": "", "rms_error": "rms_error_rel", "max_error": "max_error_rel"}


def settle_shares(parameters: dict[str, Any]) -> None:
    """Replace lengths that are shares of the diagonal; of two that bound the same, the less."""
    for name, relative in LENGTHS.items():
        length = parameters.get(name)
        if isinstance(length, Length) and length.unit == SHARE:
            share = length.value / 100
            del parameters[name]
            parameters[relative] = min(share, parameters.get(relative) or share)


def without_units(parameters: dict[str, Any]) -> dict[str, Any]:
    """Return parameters with the bare numbers of lengths, to be checked without a file."""
    return {
        name: value.value if isinstance(value, Length) else value
        for name, value in parameters.items()
    }


def refuse_units(parameters: dict[str, Any]) -> None:
    """Refuse lengths with a unit, where there is no one file that could have it.

    Raises
    ------
    OptionError
    """
    for name, value in parameters.items():
        if isinstance(value, Length):
            hint = "give a bare number, or a share such as 0.1%"
            raise OptionError(
                f"{flag_of(name)} {value} has a unit, which means nothing here: {hint}"
            )


def in_unit_of(mesh: PolyMesh, parameters: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """Return parameters with lengths in the unit of a mesh, and that unit in words.

    The words are empty if no length is given.

    Raises
    ------
    OptionError
        If a length has a unit, and the mesh has none.
    """
    given = {name: parameters[name] for name in LENGTHS if parameters.get(name) is not None}
    if not given:
        return parameters, ""
    unit = unit_of(mesh)
    size = metres(unit)
    words = [unit] if unit else [f"that of the file, which {_title(mesh)} does not name"]
    for name, length in given.items():
        if isinstance(length, Length):
            if size is None:
                raise OptionError(
                    f"{flag_of(name)} {length} has a unit, but {unit or _title(mesh)}"
                    f" {'is an unknown one' if unit else 'names none'}: give a bare number"
                )
            converted = length.value * METRES[SYMBOLS[length.unit]] / size
            words.append(f"{flag_of(name)} {length} is {number(converted)}")
            given[name] = converted
    return {**parameters, **given}, "; ".join(words)


def unit_of(mesh: PolyMesh) -> str:
    """Return the unit of a mesh as its file, or the format of its file, names it; "" for none."""
    form = format_of_extension(mesh.format)
    named = mesh.metadata.get("units", ())
    return (*named, "" if form is None else form.unit)[0].strip().lower()


def _title(mesh: PolyMesh) -> str:
    form = format_of_extension(mesh.format)
    return mesh.format if form is None else form.title
