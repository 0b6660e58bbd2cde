"""Constants of the file format by their names, whichever module has them."""

from __future__ import annotations

from deltamesh_formats.container import fields, layout, payload_layout

MODULES = (fields, layout, payload_layout)
CONSTANTS = {name: value for module in MODULES for name, value in vars(module).items()}
