"""Table of the metrics: it names what is measured."""

from __future__ import annotations

from dataclasses import fields

from deltamesh._measures.metrics import Errors
from deltamesh._measures.table import METRICS
from deltamesh.bench import COLUMNS


def test_each_metric_is_a_field_and_a_column() -> None:
    names = {field.name for field in fields(Errors)}
    assert {metric.name for metric in METRICS} == names - {"diagonal"}
    assert [metric.column for metric in METRICS] == [
        c for c in COLUMNS if c in {metric.column for metric in METRICS}
    ]
    for attribute in ("name", "column", "title", "heading"):
        assert len({getattr(metric, attribute) for metric in METRICS}) == len(METRICS)
