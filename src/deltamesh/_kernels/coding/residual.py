"""Model of vectors of one or three signed integers at vertices; `src/core/residual.h`."""

from __future__ import annotations

from deltamesh._kernels.coding.models import model_of

MODEL = model_of("vectors")
SLOTS, MIXERS = MODEL
