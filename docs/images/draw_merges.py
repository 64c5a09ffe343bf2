"""Draw the merges of one moment of a drive from above: 3D boxes of each camera, and rings around those of one object.

    python docs/images/draw_merges.py DRIVE --model yolox_nano.onnx --frame 1 --workspace FOLDER --out merges.svg

Nothing of the drive's pictures or points is in the drawing.
"""

import argparse
from html import escape
from pathlib import Path

import numpy as np

from labeler.drive import Drive, open_drive
from labeler.identity import MergeState
from labeler.pipeline import LabelledDrive, LabelledFrame, label_drive

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555")
AHEAD_M, BEHIND_M, ASIDE_M = 55.0, 8.0, 32.0
PX_PER_M = 11.0
RING_M = 2.6
INK = {
    MergeState.ACCEPTED: "stroke='#111' stroke-width='2'",
    MergeState.PROPOSED: "stroke='#777' stroke-width='2' stroke-dasharray='5 4'",
}


def draw(drive: Drive, labelled: LabelledDrive, frame: LabelledFrame) -> str:
    """The drawing as SVG: ahead is up."""
    parts = [
        _text(8, 20, f"{drive.name}, frame {frame.frame_index}: boxes of each camera; a ring is one object in two", 14)
    ]
    parts += [_box(np.array([[4, 1], [4, -1], [-1, -1], [-1, 1]], float), "#111", "this car")]
    middle_of: dict[int, np.ndarray] = {}
    for number, (camera, view) in enumerate(sorted(frame.views.items())):
        colour = COLOURS[number % len(COLOURS)]
        parts.append(_text(8, 42 + 18 * number, camera, 13, colour))
        boxes = view.boxes_3d
        for row, track in enumerate(view.track_of_boxes_3d().tolist()):
            if track < 0:
                continue
            middle_of[track] = boxes.center_m[row, :2]
            corners_m = _corners(middle_of[track], boxes.size_m[row, :2], float(boxes.yaw_rad[row]))
            parts.append(_box(corners_m, colour, f"track {track} of {camera}"))
    for merge in labelled.merges:
        a, b = middle_of.get(merge.track_a), middle_of.get(merge.track_b)
        if a is None or b is None or merge.state not in INK:
            continue
        x, y = _place((a + b) / 2)
        radius = (RING_M + float(np.linalg.norm(a - b)) / 2) * PX_PER_M
        parts.append(f"<circle cx='{x:.0f}' cy='{y:.0f}' r='{radius:.0f}' fill='none' {INK[merge.state]}/>")
        parts.append(_text(x + radius + 6, y, f"{merge.score:.2f} {merge.state.value}", 12))
    width, height = 2 * ASIDE_M * PX_PER_M, (AHEAD_M + BEHIND_M) * PX_PER_M
    return (
        f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {width:.0f} {height:.0f}' font-family='sans-serif'>"
        "<rect width='100%' height='100%' fill='#fff'/>" + "\n".join(parts) + "</svg>\n"
    )


def _corners(middle_m: np.ndarray, size_m: np.ndarray, yaw_rad: float) -> np.ndarray:
    ahead = np.array([np.cos(yaw_rad), np.sin(yaw_rad)]) * size_m[0] / 2
    aside = np.array([-np.sin(yaw_rad), np.cos(yaw_rad)]) * size_m[1] / 2
    return middle_m + np.array([ahead + aside, ahead - aside, -ahead - aside, -ahead + aside])


def _place(xy_m: np.ndarray) -> tuple[float, float]:
    return (ASIDE_M - float(xy_m[1])) * PX_PER_M, (AHEAD_M - float(xy_m[0])) * PX_PER_M


def _box(corners_m: np.ndarray, colour: str, title: str) -> str:
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in map(_place, corners_m))
    return (
        f"<polygon points='{points}' fill='{colour}' fill-opacity='.15' stroke='{colour}' stroke-width='1.5'>"
        f"<title>{escape(title)}</title></polygon>"
    )


def _text(x: float, y: float, text: str, size: int, colour: str = "#111") -> str:
    return f"<text x='{x:.0f}' y='{y:.0f}' font-size='{size}' fill='{colour}'>{escape(text)}</text>"


def main() -> None:
    """Label the drive where that is not done, and write the drawing."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("drive", type=Path)
    parser.add_argument("--model", type=Path, required=True)
    parser.add_argument("--workspace", type=Path, required=True)
    parser.add_argument("--frame", type=int, default=0)
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    drive = open_drive(options.drive)
    labelled = label_drive(drive, model=options.model, workspace=options.workspace)
    frame = next(frame for frame in labelled.frames() if frame.frame_index == options.frame)
    options.out.write_text(draw(drive, labelled, frame), encoding="utf-8")


if __name__ == "__main__":
    main()
