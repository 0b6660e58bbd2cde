"""Deltas of a surface: their step by the settings, and what quantized ones stand for."""

from __future__ import annotations

from deltamesh._geometry import steps
from deltamesh._geometry.integers import Integers
from deltamesh._geometry.quantize import delta_step, to_delta
from deltamesh._options import Settings
from deltamesh_formats.array_types import Floats
from deltamesh_formats.container.container import Parameters


def step_of(vertices: Floats, delta: Floats, settings: Settings) -> float:
    """Return the quantization step of the settings, 0 for 0 bits."""
    if settings.bits is not None:
        return delta_step(delta, settings.bits) if settings.bits else 0.0
    assert settings.step is not None
    return settings.step


def deltas(parameters: Parameters, integers: Integers) -> Floats:
    """Return the delta coordinates as they were quantized, before any refinement."""
    return to_delta(integers.values, coarse_steps(parameters, integers))


def coarse_steps(parameters: Parameters, integers: Integers) -> Floats:
    """Return the step of the deltas of each vertex, float64 (n, 1)."""
    return parameters.coarse * (parameters.step * steps.ratios(integers))
