"""Directions of conjugate gradients, for systems that are solved without being formed.

M. R. Hestenes, E. Stiefel, "Methods of conjugate gradients for solving linear systems", J. Res.
Nat. Bur. Stand. 49, 1952. What a step along a direction does differs between our systems: what
else moves with it, what its curvature is computed from, and when steps end. So the caller takes it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final

import numpy as np

from deltamesh_formats.array_types import Floats

# Below this, a product of gradients is rounding.
TINY: Final = 1e-300


def directions(
    r: Floats, precondition: Callable[[Floats], Floats]
) -> Iterator[tuple[Floats, Floats]]:
    """Yield the directions of conjugate gradients for A x = b, column by column, without an end.

    Parameters
    ----------
    r : float64 (k, c)
        The residual b - A x. A step goes along a direction p by the `quotient` of the product and
        of p A p; whoever takes it subtracts that much of A p from r, in place.
    precondition : callable
        Applies what is near to the inverse of A, symmetric and definite; it returns a new array.

    Yields
    ------
    float64 (k, c)
        A direction p.
    float64 (c,)
        The product of the residual and the preconditioned one.
    """
    z = p = precondition(r)
    product = (r * z).sum(axis=0)
    while True:
        yield p, product
        z, before = precondition(r), product
        product = (r * z).sum(axis=0)
        p = z + quotient(product, before) * p


def quotient(a: Floats, b: Floats) -> Floats:
    """Return a / b for b that are not negative; where b is 0, so is a."""
    return np.asarray(a / np.maximum(b, TINY))
