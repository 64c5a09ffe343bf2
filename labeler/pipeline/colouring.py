"""The colours of every track of a camera, from the images of its best looks: what merging compares across cameras.

Only images that show a track well are read, a few for each track. One that can't be read was named by detection.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from labeler.drive import Camera, DriveFileError, ImageFile, read_image
from labeler.identity.colours import BINS, Look, best_looks, colour_histogram
from labeler.pipeline.stages import Stage
from labeler.pipeline.tables import read_batches, rows_of, write_table
from labeler.tracking import Observations


@dataclass(frozen=True)
class ColourUnit:
    """The colours of one camera's tracks; ``images`` are its images by frame."""

    key: str
    camera: Camera
    images: Mapping[int, ImageFile]
    tracks: Path
    effort: int


def measure_colours(unit: ColourUnit, path: Path) -> None:
    """Write a table with a row for each track whose colours can be seen: its id, and its mean histogram (BINS,)."""
    looks = best_looks(rows_of(Observations, columns) for columns in read_batches(unit.tracks))
    in_frame: dict[int, list[tuple[int, Look]]] = {}
    for track, of_track in looks.items():
        for look in of_track:
            in_frame.setdefault(look.frame_index, []).append((track, look))
    sums: dict[int, NDArray[np.float64]] = {}
    for frame_index in sorted(in_frame):
        file = unit.images.get(frame_index)
        if file is None:
            continue
        try:
            image = read_image(file, camera=unit.camera)
        except DriveFileError:
            continue
        for track, look in in_frame[frame_index]:
            histogram = colour_histogram(image, look.xyxy_px)
            if histogram is not None:
                sums.setdefault(track, np.zeros(BINS))[:] += histogram
    tracks = sorted(sums)
    means = [sums[track] / sums[track].sum() for track in tracks]
    histograms = np.array(means, np.float32).reshape(-1, BINS)
    write_table(path, [{"track_id": np.array(tracks, np.int32), "histogram": histograms}])


def read_colours(paths: Sequence[Path]) -> dict[int, NDArray[np.float32]]:
    """The histogram (BINS,) of every track of all cameras whose colours are known."""
    found: dict[int, NDArray[np.float32]] = {}
    for path in paths:
        for columns in read_batches(path):
            found.update(zip(columns["track_id"].tolist(), columns["histogram"], strict=True))
    return found


COLOURS = Stage("colours", 1, "arrow", measure_colours)
