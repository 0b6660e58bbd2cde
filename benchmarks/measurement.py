"""One measurement: one mesh, encoded and decoded under one configuration, as a row of text."""

from __future__ import annotations

from typing import NamedTuple

import corpus

from deltamesh.codec import decode, encode_mesh
from deltamesh.mesh import Mesh
from deltamesh.metrics import Errors, compare
from deltamesh.options import Options
from deltamesh_formats.layout import Container
from deltamesh_formats.reader import read_container

Row = dict[str, str]


class Configuration(NamedTuple):
    """How to encode.

    Attributes
    ----------
    method : {"highpass", "refined", "cartesian"}
    bits : int
        Bits per coordinate.
    diffusion : {"on", "off", "-"}
        "-" where it means nothing.
    """

    method: str
    bits: int
    diffusion: str


# The papers' bit depths, as they round and as we do, and what quantizing x, y, z costs instead.
CONFIGURATIONS = (
    *(Configuration("highpass", b, on) for b in (4, 5, 6, 7, 8) for on in ("on", "off")),
    *(Configuration("refined", b, "on") for b in (4, 5, 6, 7, 8)),
    *(Configuration("cartesian", b, "-") for b in (8, 9, 10, 11, 12)),
)

# The columns of a row: what it is of; what is exact; errors, which the last bits of the solve may
# move. Sizes are bytes, then bits per vertex of the file and its sections, their framing included.
KEYS = ("mesh", "method", "bits", "diffusion")
SECTIONS = ("CONN", "ANCH", "DELT", "NORM", "CART")
EXACT = ("vertices", "faces", "bytes", "bpv", *SECTIONS, "rest")
ERRORS = ("rms", "max", "hausdorff", "visual", "normal_deg", "dihedral_deg")
COLUMNS = ("mesh", "vertices", "faces", *KEYS[1:], *EXACT[2:], *ERRORS)


def number(value: float) -> str:
    """Return four significant digits: more would differ from machine to machine."""
    return f"{value:.4g}"


def measure(name: str, configuration: Configuration) -> Row:
    """Encode a mesh without its isolated vertices, decode the file, and compare."""
    mesh, (method, bits, diffusion) = corpus.load(name), configuration
    options = Options(method=method, bits=bits, diffusion=diffusion != "off", drop_isolated=True)
    encoded = encode_mesh(mesh, options)
    # The decoder's own mesh, not the encoder's idea of it.
    decoded = decode(encoded.data)
    reference = Mesh(mesh.vertices[encoded.order], encoded.mesh.faces)
    container = read_container(encoded.data)
    return {
        "mesh": name,
        "method": method,
        "bits": str(bits),
        "diffusion": diffusion,
        **_sizes(container),
        **_errors(compare(reference, decoded)),
    }


def _sizes(container: Container) -> Row:
    n = container.vertices
    size = {name: _size(container, name) for name in SECTIONS}
    rest = container.size - sum(size.values())
    counts = {"vertices": n, "faces": container.faces, "bytes": container.size}
    rates = {"bpv": container.size, **size, "rest": rest}
    return {
        **{column: str(count) for column, count in counts.items()},
        **{column: number(8 * count / n) for column, count in rates.items()},
    }


def _size(container: Container, name: str) -> int:
    return container.sections[name].size if name in container.sections else 0


def _errors(errors: Errors) -> Row:
    """Return lengths over the diagonal of the bounding box, and angles in degrees."""
    lengths = {name: getattr(errors, name) / errors.diagonal for name in ERRORS[:4]}
    angles = {"normal_deg": errors.normal_deviation, "dihedral_deg": errors.dihedral}
    return {name: number(value) for name, value in {**lengths, **angles}.items()}
