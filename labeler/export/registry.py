"""The formats that labels can be written in."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from labeler.export.coco import CocoExporter
from labeler.export.errors import ExportError
from labeler.export.types import Exporter

EXPORTERS: Mapping[str, Exporter] = MappingProxyType({exporter.name: exporter for exporter in (CocoExporter(),)})
"""Every exporter by its name."""


def find_exporter(name: str) -> Exporter:
    """The exporter of that name; ExportError where there is none."""
    exporter = EXPORTERS.get(name.lower())
    if exporter is None:
        raise ExportError(f"{name!r} is no known dataset format. Known are: {', '.join(sorted(EXPORTERS))}.")
    return exporter
