"""Audits of two cars that stand still, where what comes back follows from the tracker."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from labeler.drive import Camera, Drive, Frame
from labeler.evaluation.audit import AuditConfig, agreement, audit_labels
from labeler.evaluation.types import EvaluationError
from labeler.identity import Decisions, IdentityConfig
from labeler.pipeline.detecting import read_detections
from labeler.pipeline.results import ResultFiles
from labeler.pipeline.tables import write_table
from labeler.pipeline.units import track_detections
from labeler.propagation import PropagationConfig
from labeler.tracking import TrackingConfig

FRAMES = 100
PERIOD_NS = 100_000_000
CAR, TRUCK = 0, 1
NEAR_PX, FAR_PX = (100, 100, 200, 190), (300, 100, 330, 130)


def made_drive(root: Path) -> Drive:
    """One camera without calibration; nothing of it is read."""
    frames = tuple(Frame(index, index * PERIOD_NS, {}, None) for index in range(FRAMES))
    camera = Camera("front", 640, 360, None)

    def reads_nothing(*_: Any, **__: Any) -> Any:
        """In place of both readers."""

    return Drive("made", "argoverse2", root, (camera,), frames, None, reads_nothing, reads_nothing)


def made_files(folder: Path, method: str, *, far_class: tuple[int, ...] = (CAR,)) -> ResultFiles:
    """A car of .9 and one of .85 in every frame; the classes of the second alternate through ``far_class``."""
    columns = {
        "xyxy_px": np.tile(np.array([NEAR_PX, FAR_PX], np.float32), (FRAMES, 1)),
        "score": np.tile(np.array([0.9, 0.85], np.float32), FRAMES),
        "class_id": np.array(
            [one for frame in range(FRAMES) for one in (CAR, far_class[frame % len(far_class)])], np.int16
        ),
        "frame_index": np.repeat(np.arange(FRAMES, dtype=np.int32), 2),
    }
    note = {"frames": list(range(FRAMES)), "timestamps_ns": [frame * PERIOD_NS for frame in range(FRAMES)]}
    detections, tracks = folder / "detections.arrow", folder / "tracks.arrow"
    write_table(detections, [columns], note=note)
    tracking = TrackingConfig(method=method)
    track_detections(
        read_detections([detections]), tracks, tracking, class_groups=(0, 0), first_track_id=1, motion=None
    )
    return ResultFiles(
        detections={"front": (detections,)},
        tracks={"front": tracks},
        boxes_3d=(),
        class_groups=(0, 0),
        tracking=tracking,
        identity=IdentityConfig(),
        propagation=PropagationConfig(),
        decisions=Decisions(),
    )


def test_what_the_offline_tracker_fills_in_comes_back(tmp_path: Path) -> None:
    files = made_files(tmp_path, "offline")
    before = files.tracks["front"].read_bytes()
    found = audit_labels(made_drive(tmp_path), files, config=AuditConfig(share=0.2, seed=1))
    assert found["confident"] == 2 * FRAMES
    assert 20 <= found["hidden"] <= 60
    # at the very ends of a track nothing can be filled in
    assert found["box"]["of"] == found["hidden"]
    assert found["box"]["agree"] >= found["hidden"] - 4
    assert found["label"]["agree"] == found["label"]["of"] == found["box"]["agree"]
    assert found["by_distance"] == []
    near, far = (row for row in found["by_height"])
    assert [(row["start"], row["stop"]) for row in (far, near)] == [(80, 160), (20, 40)]
    assert near["box"]["of"] + far["box"]["of"] == found["hidden"]
    assert files.tracks["front"].read_bytes() == before


def test_a_tracker_that_fills_nothing_in_finds_nothing(tmp_path: Path) -> None:
    found = audit_labels(made_drive(tmp_path), made_files(tmp_path, "baseline"), config=AuditConfig(share=0.2))
    assert found["box"]["agree"] == 0
    assert found["label"] == {"agree": 0, "of": 0, "share": None, "low": None, "high": None}


def test_a_class_that_wavers_does_not_come_back(tmp_path: Path) -> None:
    """The far car is called car and truck by turns with one score, so its label is that of frame 0: car. Every box that
    was called truck comes back as a car."""
    files = made_files(tmp_path, "offline", far_class=(CAR, TRUCK))
    found = audit_labels(made_drive(tmp_path), files, config=AuditConfig(share=0.3, seed=2))
    far, near = (next(row for row in found["by_height"] if row["start"] == start) for start in (20, 80))
    assert near["label"]["share"] == 1.0
    assert 0 < far["label"]["agree"] < far["label"]["of"]


def test_the_seed_says_who_is_hidden(tmp_path: Path) -> None:
    files = made_files(tmp_path, "offline")
    drive = made_drive(tmp_path)
    first, again, other = (audit_labels(drive, files, config=AuditConfig(share=0.2, seed=seed)) for seed in (1, 1, 2))
    assert first == again
    assert first["hidden"] != other["hidden"] or first["by_height"] != other["by_height"]


def test_of_a_short_drive_more_is_hidden(tmp_path: Path) -> None:
    """Of 200 confident observations a twentieth would be 10."""
    found = audit_labels(made_drive(tmp_path), made_files(tmp_path, "offline"))
    assert found["share"] == 0.2
    assert found["hidden"] > 20
    # only the near car is sure enough here: 100, of which 20 are too few to hide more of
    found = audit_labels(made_drive(tmp_path), made_files(tmp_path, "offline"), config=AuditConfig(confidence=0.9))
    assert (found["confident"], found["share"]) == (100, 0.2)
    # who asks for less gets less, and a wide interval
    found = audit_labels(made_drive(tmp_path), made_files(tmp_path, "offline"), config=AuditConfig(share=0.02))
    assert 0 < found["hidden"] < 20
    box: Any = found["box"]
    assert box["high"] - box["low"] > 0.1


def test_nothing_to_hide(tmp_path: Path) -> None:
    with pytest.raises(EvaluationError, match=r"of 0 observations with a confidence of at least 0\.95"):
        audit_labels(made_drive(tmp_path), made_files(tmp_path, "offline"), config=AuditConfig(confidence=0.95))


@pytest.mark.parametrize(
    ("agree", "of", "expected"),
    [
        (8, 10, (0.8, 0.4902, 0.9433)),  # Wilson's interval, as tabulated
        (0, 10, (0.0, 0.0, 0.2775)),
        (10, 10, (1.0, 0.7225, 1.0)),
        (0, 0, (None, None, None)),
    ],
)
def test_intervals(agree: int, of: int, expected: tuple[float | None, ...]) -> None:
    found = agreement(agree, of)
    assert (found["share"], found["low"], found["high"]) == expected


@pytest.mark.parametrize("given", [{"share": 0.0}, {"share": 0.6}, {"confidence": 1.5}, {"seed": -1}])
def test_refuses_settings_that_make_no_sense(given: dict[str, Any]) -> None:
    with pytest.raises(EvaluationError):
        AuditConfig(**given)
