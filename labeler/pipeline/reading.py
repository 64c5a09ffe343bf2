"""Reading artifacts back, all cameras in step, one frame in memory at a time."""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import TypeVar

import numpy as np

from labeler.identity import CameraView, MultiCameraFrame
from labeler.lidar import Boxes3D, Positions3D
from labeler.pipeline.lidar_units import boxes_of, positions_of
from labeler.pipeline.tables import Columns, read_batches, read_note, rows_by_frame, rows_of
from labeler.pipeline.types import LabelledFrame, LabelledView
from labeler.propagation import Labels
from labeler.tracking import Observations

Item = TypeVar("Item")


def read_observations(path: Path) -> Iterator[tuple[int, Observations]]:
    """(frame_index, observations) of one camera, in order of frames."""
    for frame_index, rows in rows_by_frame(read_batches(path)):
        yield frame_index, rows_of(Observations, rows)


def read_views(tracks: Mapping[str, Path], boxes_3d: Sequence[Path]) -> Iterator[MultiCameraFrame]:
    """Every frame in which anything was seen: the observations of each camera, its 3D boxes and positions."""
    streams = {camera: read_observations(path) for camera, path in tracks.items()}
    located = _LocatedReader(boxes_3d)
    for frame_index, seen in _in_step(streams):
        found = located.at(frame_index)
        nothing = Boxes3D.empty(), Positions3D.empty()
        views = {camera: CameraView(observations, *found.get(camera, nothing)) for camera, observations in seen.items()}
        yield MultiCameraFrame(frame_index, views)


def read_labelled_frames(
    tracks: Mapping[str, Path], labels: Mapping[str, Path], boxes_3d: Sequence[Path]
) -> Iterator[LabelledFrame]:
    """Like :func:`read_views`, with the label of every observation."""
    label_streams = {camera: rows_by_frame(read_batches(path)) for camera, path in labels.items()}
    labelled: Iterator[tuple[int, dict[str, Columns]]] = _in_step(label_streams)
    for view, (_, rows) in zip(read_views(tracks, boxes_3d), labelled, strict=True):
        views = {
            camera: LabelledView(seen.observations, rows_of(Labels, rows[camera]), seen.boxes_3d, seen.positions)
            for camera, seen in view.views.items()
        }
        yield LabelledFrame(view.frame_index, views)


class _LocatedReader:
    """3D boxes and positions of each camera by frame, for frames that are asked for in order."""

    def __init__(self, paths: Sequence[Path]) -> None:
        self._frames = (item for path in paths for item in _located_by_frame(path))
        self._next = next(self._frames, None)

    def at(self, frame_index: int) -> Mapping[str, tuple[Boxes3D, Positions3D]]:
        while self._next is not None and self._next[0] < frame_index:
            self._next = next(self._frames, None)
        if self._next is None or self._next[0] != frame_index:
            return {}
        return self._next[1]


def _located_by_frame(path: Path) -> Iterator[tuple[int, dict[str, tuple[Boxes3D, Positions3D]]]]:
    cameras: list[str] = read_note(path)["cameras"]
    for frame_index, rows in rows_by_frame(read_batches(path)):
        located: dict[str, tuple[Boxes3D, Positions3D]] = {}
        for number in np.unique(rows["camera"]):
            chosen = rows["camera"] == number
            of_camera = {name: column[chosen] for name, column in rows.items()}
            located[cameras[number]] = boxes_of(of_camera), positions_of(of_camera)
        yield frame_index, located


def _in_step(streams: Mapping[str, Iterator[tuple[int, Item]]]) -> Iterator[tuple[int, dict[str, Item]]]:
    """(frame_index, what each stream has at that frame) in order of frames."""
    tagged = [_tag(name, stream) for name, stream in streams.items()]
    for frame_index, items in groupby(heapq.merge(*tagged, key=itemgetter(0)), key=itemgetter(0)):
        yield frame_index, {name: item for _, name, item in items}


def _tag(name: str, stream: Iterator[tuple[int, Item]]) -> Iterator[tuple[int, str, Item]]:
    for frame_index, item in stream:
        yield frame_index, name, item
