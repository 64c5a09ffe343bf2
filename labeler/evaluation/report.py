"""One HTML file with the table and the plots of an evaluation: it holds all it shows, runs no code, loads nothing."""

from __future__ import annotations

import os
import uuid
from collections.abc import Iterable
from html import escape
from pathlib import Path

from labeler.evaluation.plots import plots_of
from labeler.evaluation.types import Evaluation, EvaluationError, Row

_STYLE = """
:root { color-scheme: light dark; --ink: #23262f; --faint: #6b7182; --page: #f7f8fa; --card: #fff; --line: #e3e6ec; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e4e7ee; --faint: #9aa1b0; --page: #101217; --card: #16191f; --line: #2c303b; } }
body { margin: 0; background: var(--page); color: var(--ink); font: 15px/1.5 system-ui, sans-serif; }
main { max-width: 1180px; margin: 0 auto; padding: 32px 24px 64px; }
h1 { font-size: 24px; margin: 0 0 4px; } h2 { font-size: 17px; margin: 36px 0 10px; }
p { margin: 0 0 10px; max-width: 76ch; } .faint { color: var(--faint); }
.card { background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: 14px; overflow-x: auto; }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(420px, 1fr)); gap: 14px; }
figure { margin: 0; } figcaption { font-weight: 600; margin-bottom: 6px; } svg { width: 100%; height: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { padding: 5px 10px; text-align: right; border-bottom: 1px solid var(--line); white-space: nowrap; }
th:first-child, td:first-child, th.left, td.left { text-align: left; } th { font-weight: 600; color: var(--faint); }
tr:last-child td { border-bottom: 0; } tr.best td { font-weight: 600; }
dl { display: flex; flex-wrap: wrap; gap: 8px 36px; margin: 0; } dt { color: var(--faint); }
dd { margin: 0; font-size: 20px; }
"""
_CAPTIONS = {
    "precision-recall": "Precision and recall as the threshold moves",
    "recall-by-distance": "Recall by distance",
    "recall-by-visible-share": "Recall by visible share",
    "reliability": "What labels say of themselves, and what is so",
}


def write_report(path: Path, evaluation: Evaluation) -> None:
    """Write the report to ``path``; it appears whole or not at all. EvaluationError when it can't be written."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.{uuid.uuid4().hex[:8]}.tmp")
    try:
        temporary.write_text(report_html(evaluation), encoding="utf-8")
        temporary.replace(path)
    except OSError as error:
        raise EvaluationError(f"The report can't be written to {path}: {error.strerror or error}.") from error
    finally:
        temporary.unlink(missing_ok=True)


def report_html(evaluation: Evaluation) -> str:
    """The report as HTML text."""
    name = escape(evaluation["drive"])
    plots = plots_of(evaluation)
    figures = "\n".join(
        f'<figure class="card"><figcaption>{_caption(plot)}</figcaption>\n{svg}</figure>' for plot, svg in plots.items()
    )
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Evaluation of {name}</title>
<style>{_STYLE}</style>
</head>
<body>
<main>
<h1>Evaluation of {name}</h1>
<p class="faint">{_settings(evaluation)}</p>
<h2>Labels</h2>
<div class="card">{_table(evaluation["rows"])}</div>
<h2>Identities over all cameras</h2>
<div class="card">{_numbers(evaluation)}</div>
<h2>How likely labels are right</h2>
<div class="card">{_calibration(evaluation)}</div>
<h2>Plots</h2>
<p class="faint">Whole boxes, all cameras. The dots are at the confidence of the table. Below each bin stands how many
true objects it has.</p>
<div class="plots">
{figures}
</div>
<h2>How it is counted</h2>
<p>In each image labels choose one after the other, the surest first; each takes the free true object that it overlaps
most, if by at least the IoU. A label with an object is a true positive (TP), one without is a false positive (FP), an
object without a label is a false negative (FN). Truth that is too far, hardly visible or marked as not to care about is
neither hit nor miss, and labels that fall on it are not counted.</p>
<p>{_methods(evaluation)}</p>
<p>The expected error is the mean distance between what labels say of themselves and the share of them that is right, in
ten steps, each weighted by its labels (expected calibration error; multi-camera labels of any confidence).</p>
</main>
</body>
</html>
"""


def _caption(plot: str) -> str:
    kind, _, iou = plot.rpartition("-iou-")
    return f"{_CAPTIONS[kind]}, IoU {iou}"


def _settings(evaluation: Evaluation) -> str:
    classes = {"aware": "classes compared", "agnostic": "classes not compared"}[evaluation["classes"]]
    return (
        f"Vehicles; labels with a confidence of at least {evaluation['confidence']:g}; truth within "
        f"{evaluation['max_distance_m']:g} m: {evaluation['truth_count']:,} boxes count, "
        f"{evaluation['dont_care_count']:,} don't; {classes}."
    )


def _methods(evaluation: Evaluation) -> str:
    alone = (
        "the detector's boxes as they are"
        if evaluation["without_tracking_from"] == "detections"
        else "the detector's boxes that are in a track (the others were not kept)"
    )
    return (
        f"Without tracking: {alone}. Single-camera: each track has the label of its best box. Multi-camera: each "
        "object has the label of its best box in any camera."
    )


def _table(rows: Iterable[Row]) -> str:
    cells = "\n".join(
        f"<tr{_best(row)}><td>{row['method']}</td><td class=left>{row['cameras']}</td>"
        f"<td class=left>{row['truth']}</td><td>{row['iou']:g}</td><td>{_share(row['precision'])}</td>"
        f"<td>{_share(row['recall'])}</td><td>{row['tp']:,}</td><td>{row['fp']:,}</td><td>{row['fn']:,}</td></tr>"
        for row in rows
    )
    return (
        "<table>\n<thead><tr><th>Method</th><th class=left>Cameras</th><th class=left>Truth</th><th>IoU</th>"
        "<th>Precision</th><th>Recall</th><th>TP</th><th>FP</th><th>FN</th></tr></thead>\n"
        f"<tbody>\n{cells}\n</tbody>\n</table>"
    )


def _best(row: Row) -> str:
    return " class=best" if row["method"] == "multi-camera" and row["cameras"] == "all" else ""


def _numbers(evaluation: Evaluation) -> str:
    tracking, merges = evaluation["tracking"], evaluation["merges"]
    numbers = {
        "HOTA": _share(tracking["hota"]),
        "IDF1": _share(tracking["idf1"]),
        "MOTA": _share(tracking["mota"]),
        "Identity switches": f"{tracking['id_switches']:,}",
        "Merges right": f"{merges['right']:,}",
        "Merges missed": f"{merges['missed']:,}",
        "Merges wrong": f"{merges['wrong']:,}",
    }
    return f"<dl>{''.join(f'<div><dt>{name}</dt><dd>{number}</dd></div>' for name, number in numbers.items())}</dl>"


def _calibration(evaluation: Evaluation) -> str:
    calibration = evaluation["calibration"]
    numbers = {
        "Expected error of the probability": _share(calibration["probability"]["expected_error"]),
        "Of the paper's confidence": _share(calibration["confidence"]["expected_error"]),
        "Labels with a probability": f"{calibration['probability']['labels']:,}",
    }
    return f"<dl>{''.join(f'<div><dt>{name}</dt><dd>{number}</dd></div>' for name, number in numbers.items())}</dl>"


def _share(value: float | None) -> str:
    return "–" if value is None else f"{value:.3f}"
