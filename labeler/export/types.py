"""What every exporter gets: the labelled images of a drive, one after the other."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol


@dataclass(frozen=True)
class DatasetInfo:
    """What a dataset says about itself. ``class_names`` gives the meaning of every ``class_id``.

    ``created_at`` is a moment in ISO 8601; ``min_score`` the score below which labels were left out.
    """

    drive: str
    drive_format: str
    model: str
    hindsight_version: str
    created_at: str
    min_score: float
    class_names: tuple[str, ...]


@dataclass(frozen=True)
class DonorReference:
    """The observation that a propagated label was taken from."""

    track_id: int
    camera: str
    frame_index: int
    score: float | None


@dataclass(frozen=True)
class LabelledBox:
    """One label: ``xyxy_px`` in pixels of the image, ``class_id`` and ``score`` of the label (not of the detector).

    ``source`` is "auto", "propagated" or "human"; ``filled`` boxes were put in by the tracker. ``score`` is None where
    none is known, as is ``probability``, how likely the label is right. ``withheld`` is why it is the detector's own
    and not that of the box's identity, None where it is that.
    """

    xyxy_px: tuple[float, float, float, float]
    class_id: int
    score: float | None
    track_id: int
    identity_id: int
    source: str
    filled: bool
    donor: DonorReference | None
    probability: float | None = None
    withheld: str | None = None


@dataclass(frozen=True)
class LabelledImage:
    """One image with its labels; ``file_name`` is relative to the drive's folder."""

    file_name: str
    camera: str
    frame_index: int
    timestamp_ns: int
    width_px: int
    height_px: int
    boxes: tuple[LabelledBox, ...]


@dataclass(frozen=True)
class ExportSummary:
    """How much a dataset holds."""

    image_count: int
    label_count: int


class Exporter(Protocol):
    """Writes one dataset format."""

    @property
    def name(self) -> str:
        """What users call the format, in lower case."""
        ...

    @property
    def suffix(self) -> str:
        """How its files end, with the dot."""
        ...

    @property
    def media_type(self) -> str: ...

    def write(self, path: Path, images: Iterable[LabelledImage], *, info: DatasetInfo) -> ExportSummary:
        """Write a file that appears whole or not at all; reads ``images`` once and keeps none of them.

        Raises ExportError when it can't be written."""
        ...
