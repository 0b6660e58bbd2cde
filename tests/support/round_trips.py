"""Round trips: a mesh, encoded and decoded, with a check of all that holds for any mesh."""

from __future__ import annotations

import numpy as np
import strategies

from deltamesh._codec.decoding import decode
from deltamesh._measures.metrics import diagonal
from deltamesh._options import Options
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh_formats.polymesh.arrays import from_arrays

# The tolerance that is promised for positions, in diagonals.
TOLERANCE = 1e-9


def frozen(mesh):
    """Copies that cannot be written to: who modifies an input raises."""
    V, F = (array.copy() for array in mesh)
    V.flags.writeable = F.flags.writeable = False
    return V, F


def assert_round_trip(V, F, **options):
    """Encode, decode, check all that holds for any mesh; return what the encoder gave."""
    V, F = frozen((V, F))
    encoded = encode_mesh(from_arrays(V, F), Options(**options))
    decoded = decode(encoded.data)
    assert_decoded(decoded, encoded)
    # `order` takes the faces back to the input, winding and all.
    assert strategies.canonical(encoded.order[decoded.faces]) == strategies.canonical(F)
    assert len(set(encoded.order)) == len(encoded.order)
    used = np.unique(F)
    kept = used if options.get("drop_isolated") else np.arange(len(V))
    assert sorted(encoded.order) == kept.tolist()
    return encoded


def assert_decoded(decoded, encoded):
    assert decoded.vertices.dtype == np.float64
    assert decoded.faces.dtype == np.int64
    for array in (decoded.vertices, decoded.faces):
        assert array.flags.writeable
        assert array.flags.c_contiguous
    np.testing.assert_array_equal(decoded.faces, encoded.mesh.faces)
    atol = TOLERANCE * diagonal(encoded.mesh.vertices)
    np.testing.assert_allclose(decoded.vertices, encoded.mesh.vertices, rtol=0, atol=atol)
