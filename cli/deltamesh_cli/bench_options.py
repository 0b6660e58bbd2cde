"""Options of `deltamesh bench` that say how to encode, some of them as lists, and their labels."""

from __future__ import annotations

from dataclasses import fields
from itertools import product
from typing import Any, Final

import click

from deltamesh._methods import AUTO, BOUNDS, METHOD_OPTIONS, METHODS, RATES
from deltamesh._options import ATTRIBUTE_BOUNDS, Options
from deltamesh_cli import options
from deltamesh_cli.encode_options import encode_options
from deltamesh_cli.lengths import refuse_units, settle_shares
from deltamesh_cli.value_types import comma_separated
from deltamesh_formats.errors import OptionError

# The encode options that may be lists here: rates and bounds, one at a time, and the others, each
# with each; and those that have another meaning here or none.
_RATES: Final = (*RATES, *BOUNDS)
_CROSSED: Final = ("method", "anchors", "anchor_method")
_LISTS: Final = (*_CROSSED, *_RATES)
_NOT_SHARED: Final = (
    *("solver", "threads", "source_format", "drop_isolated", "importance"),
    *ATTRIBUTE_BOUNDS,
)


def bench_options() -> list[click.Parameter]:
    """Return the options that say how to encode, some of them as lists."""
    names = {field.name for field in fields(Options)}.difference(_NOT_SHARED)
    shared = options.parameters_of(encode_options)
    return [
        _as_list(one) if name in _LISTS else one for name, one in shared.items() if name in names
    ]


def _as_list(option: click.Option) -> click.Option:
    kind = option.type
    metavar = "|".join(kind.choices) if isinstance(kind, click.Choice) else option.metavar
    default = f"  [default: {option.default}]" if isinstance(option.default, str) else ""
    return click.Option(
        [*option.opts, str(option.name)],
        type=comma_separated(kind),
        multiple=True,
        metavar=f"{metavar},...",
        help=f"{option.help}{default}",
    )


def labels_of(parameters: dict[str, Any]) -> list[str]:
    """Return the label of each method with each choice of anchors and each rate."""
    from deltamesh.bench import label

    lists = {name: _flat(parameters.pop(name, ())) for name in _LISTS}
    given = [[{name: value} for value in lists[name]] or [{}] for name in _CROSSED]
    rates = [{name: value} for name in _RATES for value in lists[name]] or [{}]
    common = options.specified(parameters)
    try:
        for rate in rates:
            settle_shares(rate)
            refuse_units(rate)
        labels = [
            label(Options(**_meant({**method, **anchors, **choice}), **rate, **common))
            for method, anchors, choice, rate in product(*given, rates)
        ]
        return list(dict.fromkeys(labels))
    except OptionError as error:
        raise click.UsageError(f"{error}.") from error


def _meant(crossed: dict[str, Any]) -> dict[str, Any]:
    """Return what means something to the method: the Cartesian one, for one, has no anchors."""
    method = crossed.get("method", AUTO)
    known = METHOD_OPTIONS if method == AUTO else METHODS[method].options
    return {name: value for name, value in crossed.items() if name in ("method", *known)}


def _flat(lists: tuple[tuple[Any, ...], ...]) -> list[Any]:
    """Return the values of an option that takes lists and may be repeated."""
    return [value for values in lists for value in values]
