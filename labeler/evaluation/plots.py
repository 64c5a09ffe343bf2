"""The plots of an evaluation as SVG, written by hand: they need no plotting library, and follow a dark or light page.

Each is whole by itself: its style is inside, and it loads nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape

from labeler.evaluation.reliability import Reliability
from labeler.evaluation.types import METHODS, BinRow, Calibration, Curve, Evaluation

WIDTH_PX, HEIGHT_PX = 560, 340
_LEFT, _RIGHT, _TOP, _BOTTOM = 52, 16, 40, 52
_SHARES = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
_STYLE = """
.plot { --ink: #23262f; --faint: #6b7182; --grid: #e3e6ec; --m0: #868d9c; --m1: #c9721c; --m2: #3b5bdb;
  font: 12px system-ui, sans-serif; }
@media (prefers-color-scheme: dark) { .plot { --ink: #e4e7ee; --faint: #9aa1b0; --grid: #2c303b; --m0: #9aa1b0;
  --m1: #f0a04b; --m2: #748ffc; } }
.plot text { fill: var(--ink); }
.plot .faint { fill: var(--faint); }
.plot .grid { stroke: var(--grid); }
.plot .line { fill: none; stroke-width: 2; stroke-linejoin: round; }
.plot .s0 { stroke: var(--m0); } .plot .s1 { stroke: var(--m1); } .plot .s2 { stroke: var(--m2); }
.plot .f0 { fill: var(--m0); } .plot .f1 { fill: var(--m1); } .plot .f2 { fill: var(--m2); }
"""


@dataclass(frozen=True)
class _Area:
    """Where the axes lie, and how shares from 0 to 1 become pixels."""

    left: float = _LEFT
    top: float = _TOP
    width: float = WIDTH_PX - _LEFT - _RIGHT
    height: float = HEIGHT_PX - _TOP - _BOTTOM

    def x(self, share: float) -> float:
        return round(self.left + share * self.width, 1)

    def y(self, share: float) -> float:
        return round(self.top + (1 - share) * self.height, 1)


def plots_of(evaluation: Evaluation) -> dict[str, str]:
    """All plots of an evaluation as SVG text, by the name of a file without suffix."""
    plots: dict[str, str] = {}
    for iou in sorted({curve["iou"] for curve in evaluation["curves"]}):
        curves = [curve for curve in evaluation["curves"] if curve["iou"] == iou]
        plots[f"precision-recall-iou-{iou:g}"] = precision_recall_plot(curves, confidence=evaluation["confidence"])
    calibration = evaluation["calibration"]
    if calibration["probability"]["labels"]:
        plots[f"reliability-iou-{calibration['iou']:g}"] = reliability_plot(calibration)
    bins = (("distance", evaluation["by_distance"]), ("visible-share", evaluation["by_visible_share"]))
    for name, rows in bins:
        for iou in sorted({row["iou"] for row in rows}):
            at_iou = [row for row in rows if row["iou"] == iou]
            plots[f"recall-by-{name}-iou-{iou:g}"] = recall_plot(at_iou, unit="m" if name == "distance" else "")
    return plots


def precision_recall_plot(curves: Sequence[Curve], *, confidence: float) -> str:
    """A line for each method as the threshold falls from 1 to 0, and a dot where it is ``confidence``."""
    area = _Area()
    parts = [*_frame(area), *_legend()]
    parts += [_text(area.x(share), area.y(0) + 18, f"{share:g}", anchor="middle", faint=True) for share in _SHARES]
    parts.append(_text(area.x(0.5), HEIGHT_PX - 12, "recall", anchor="middle"))
    for curve in curves:
        number = METHODS.index(curve["method"])
        points = [
            (area.x(recall), area.y(precision), threshold)
            for threshold, precision, recall in zip(
                curve["threshold"], curve["precision"], curve["recall"], strict=True
            )
            if recall > 0
        ]
        if not points:
            continue
        line = " ".join(f"{x:g},{y:g}" for x, y, _ in points)
        parts.append(f'<polyline class="line s{number}" points="{line}"/>')
        x, y, threshold = min(points, key=lambda point: abs(point[2] - confidence))
        title = f"{curve['method']} at confidence {threshold:g}"
        parts.append(f'<circle class="f{number}" cx="{x:g}" cy="{y:g}" r="4.5"><title>{escape(title)}</title></circle>')
    return _svg(f"Precision by recall at IoU {curves[0]['iou']:g}", "precision", parts)


def recall_plot(rows: Sequence[BinRow], *, unit: str) -> str:
    """A bar for each method in each bin, and how many objects the bin has."""
    area = _Area()
    parts = [*_frame(area), *_legend()]
    starts = sorted({row["start"] for row in rows})
    group = 1 / len(starts)
    for row in rows:
        number, place = METHODS.index(row["method"]), starts.index(row["start"])
        left, count = place * group, row["tp"] + row["fn"]
        middle = area.x(left + group / 2)
        name = f"{row['start']:g}–{row['stop']:g} {unit}".strip()
        if number == 0:
            parts.append(_text(middle, area.y(0) + 18, name, anchor="middle"))
            parts.append(_text(middle, area.y(0) + 34, f"{count:,}", anchor="middle", faint=True))
        if row["recall"] is None:
            continue
        width = area.width * group * 0.24
        x = area.x(left + group * (0.14 + 0.24 * number))
        height = area.y(0) - area.y(row["recall"])
        title = f"{row['method']}, {name}: {row['tp']} of {count} found"
        parts.append(
            f'<rect class="f{number}" x="{x:g}" y="{area.y(row["recall"]):g}" width="{width - 1:g}" '
            f'height="{height:g}"><title>{escape(title)}</title></rect>'
        )
    return _svg(f"Recall at IoU {rows[0]['iou']:g}", "recall", parts)


def reliability_plot(calibration: Calibration) -> str:
    """What labels said of themselves against the share of them that is right; on the diagonal both agree. Below each
    step of probability stands how many labels it has."""
    area = _Area()
    names = (("confidence", "paper's confidence"), ("probability", "probability"))
    diagonal = f'x1="{area.x(0):g}" y1="{area.y(0):g}" x2="{area.x(1):g}" y2="{area.y(1):g}"'
    parts = [*_frame(area), f'<line class="grid" {diagonal}/>']
    parts += [_text(area.x(share), area.y(0) + 18, f"{share:g}", anchor="middle", faint=True) for share in _SHARES]
    parts.append(_text(area.x(0.5), HEIGHT_PX - 4, "said", anchor="middle"))
    for place, (key, name) in enumerate(names):
        found: Reliability = calibration["probability"] if key == "probability" else calibration["confidence"]
        number = place + 1
        x = WIDTH_PX - _RIGHT - 240.0 + 140 * place
        parts.append(f'<rect class="f{number}" x="{x:g}" y="8" width="10" height="10"/>{_text(x + 14, 17, name)}')
        points = [
            (area.x(one["predicted"]), area.y(one["observed"]), one)
            for one in found["bins"]
            if one["predicted"] is not None and one["observed"] is not None
        ]
        line = " ".join(f"{x:g},{y:g}" for x, y, _ in points)
        parts.append(f'<polyline class="line s{number}" points="{line}"/>')
        for x, y, one in points:
            title = f"{name} {one['predicted']:.2f}: {one['observed']:.2f} of {one['labels']:,} labels are right"
            parts.append(
                f'<circle class="f{number}" cx="{x:g}" cy="{y:g}" r="4"><title>{escape(title)}</title></circle>'
            )
    for one in calibration["probability"]["bins"]:
        middle = area.x((one["start"] + one["stop"]) / 2)
        parts.append(_text(middle, area.y(0) + 34, f"{one['labels']:,}", anchor="middle", faint=True))
    return _svg(f"How well labels know whether they are right, IoU {calibration['iou']:g}", "right", parts)


def _svg(title: str, vertical: str, parts: Iterable[str]) -> str:
    body = "\n".join(parts)
    return (
        f'<svg class="plot" xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH_PX} {HEIGHT_PX}" role="img">\n'
        f"<title>{escape(title)}</title>\n<style>{_STYLE}</style>\n"
        f"{_text(4, 16, vertical)}\n{body}\n</svg>\n"
    )


def _frame(area: _Area) -> Iterable[str]:
    for share in _SHARES:
        y = area.y(share)
        yield f'<line class="grid" x1="{area.x(0):g}" y1="{y:g}" x2="{area.x(1):g}" y2="{y:g}"/>'
        yield _text(area.left - 8, y + 4, f"{share:g}", anchor="end", faint=True)


def _legend() -> Iterable[str]:
    x = WIDTH_PX - _RIGHT - 360.0
    for number, method in enumerate(METHODS):
        yield f'<rect class="f{number}" x="{x:g}" y="8" width="10" height="10" rx="2"/>'
        yield _text(x + 15, 17, method)
        x += 130


def _text(x: float, y: float, text: str, *, anchor: str = "start", faint: bool = False) -> str:
    kind = ' class="faint"' if faint else ""
    return f'<text x="{x:g}" y="{y:g}" text-anchor="{anchor}"{kind}>{escape(text)}</text>'
