"""Containers of parameters and payloads: what is rounded, what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from containers import DIGEST, HIGHPASS, META, PAYLOADS

from deltamesh_formats.container.building import build_container
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.container.writer import write_container


def test_a_container_has_the_numbers_that_its_file_has():
    """Those of binary32 and of hundredths are rounded when it is built, not when it is read."""
    parameters = replace(HIGHPASS, method="refined", coarse=8.1, dead_zone=0.123)
    payloads = PAYLOADS["highpass"] | {"NORM": b""}
    meta = replace(META, normal=0.1)
    container = build_container(1000, 2000, parameters, payloads, meta, DIGEST)
    assert container.parameters.coarse == float(np.float32(8.1)) != 8.1
    assert container.parameters.dead_zone == 0.12
    assert container.meta == replace(meta, normal=float(np.float32(0.1)))
    assert read_container(write_container(container)) == container


@pytest.mark.parametrize(
    ("payloads", "digest"),
    [
        ({"CONN": b""}, DIGEST),
        (PAYLOADS["cartesian"], DIGEST),
        (PAYLOADS["highpass"] | {"meta": b""}, DIGEST),
        (PAYLOADS["highpass"] | {"WXYZ": b""}, DIGEST),
        (PAYLOADS["highpass"] | {"ab1d": b""}, DIGEST),
        (PAYLOADS["highpass"], b"short"),
    ],
)
def test_wrong_payloads_are_a_mistake_of_the_caller(payloads, digest):
    with pytest.raises(ValueError, match=r"payloads|optional|digest"):
        build_container(
            10, 10, replace(HIGHPASS, anchor_count=1, isolated=0), payloads, None, digest
        )
