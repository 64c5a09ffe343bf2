"""Datasets for training elsewhere: one file for each format, behind one registry."""

from labeler.export.errors import ExportError
from labeler.export.registry import EXPORTERS, find_exporter
from labeler.export.types import DatasetInfo, DonorReference, Exporter, ExportSummary, LabelledBox, LabelledImage

__all__ = [
    "EXPORTERS",
    "DatasetInfo",
    "DonorReference",
    "ExportError",
    "ExportSummary",
    "Exporter",
    "LabelledBox",
    "LabelledImage",
    "find_exporter",
]
