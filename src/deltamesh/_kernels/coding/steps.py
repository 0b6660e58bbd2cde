"""Steps over a mesh that both sides know, which code an order of its vertices or faces.

See `src/core/steps.h`.
"""

from __future__ import annotations

from deltamesh._kernels.coding.models import model_of
from deltamesh._kernels.core import constant

# Anchors: the first vertex of a face, or the oldest or newest of the vertices around.
FIRST, OLDEST, NEWEST = constant("DM_FIRST"), constant("DM_OLDEST"), constant("DM_NEWEST")

MODEL = model_of("steps")
SLOTS, MIXERS = MODEL
