import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from labeler.evaluation.plots import plots_of, precision_recall_plot, recall_plot, reliability_plot
from labeler.evaluation.reliability import ReliabilityCounts
from labeler.evaluation.report import report_html, write_report
from labeler.evaluation.types import IOUS, METHODS, BinRow, Calibration, Curve, Evaluation, EvaluationError, Row

SVG = "{http://www.w3.org/2000/svg}"


def bins(*recalls: float | None, iou: float = 0.5) -> list[BinRow]:
    """A bin of 20 m for each recall, each with four objects, or none where the recall is None; all methods alike."""
    return [
        BinRow(
            method=method,
            iou=iou,
            start=20.0 * number,
            stop=20.0 * (number + 1),
            recall=recall,
            tp=0 if recall is None else int(4 * recall),
            fn=0 if recall is None else 4 - int(4 * recall),
        )
        for method in METHODS
        for number, recall in enumerate(recalls)
    ]


def curve(method: str, iou: float = 0.5) -> Curve:
    return Curve(
        method=method,
        iou=iou,
        average_precision=0.5,
        threshold=[1.0, 0.8, 0.0],
        precision=[1.0, 0.5, 0.25],
        recall=[0.0, 0.5, 1.0],
    )


def calibration(probability: list[float], is_right: list[bool]) -> Calibration:
    """Labels of that probability; the confidence says .5 of all."""
    by_probability, by_confidence = ReliabilityCounts(), ReliabilityCounts()
    by_probability.add(np.array(probability), np.array(is_right, np.bool_))
    by_confidence.add(np.full(len(is_right), 0.5), np.array(is_right, np.bool_))
    return Calibration(iou=0.5, probability=by_probability.reliability(), confidence=by_confidence.reliability())


def evaluation(**given: Any) -> Evaluation:
    whole: dict[str, Any] = {
        "drive": "made <drive> & more",
        "confidence": 0.8,
        "max_distance_m": 80.0,
        "min_visible_pixels": 30,
        "classes": "aware",
        "without_tracking_from": "detections",
        "truth_count": 1234,
        "dont_care_count": 5,
        "rows": [
            Row(
                method=method,
                cameras="all",
                truth="whole",
                iou=0.5,
                precision=None if method == METHODS[0] else 0.875,
                recall=0.5,
                tp=7,
                fp=1,
                fn=7,
            )
            for method in METHODS
        ],
        "by_distance": [row for iou in IOUS for row in bins(1.0, 0.5, iou=iou)],
        "by_visible_share": [],
        "curves": [curve(method, iou) for method in METHODS for iou in IOUS],
        "tracking": {"hota": 0.5, "deta": 0.6, "assa": 0.4, "idf1": None, "mota": -0.25, "id_switches": 1500},
        "merges": {"right": 3, "wrong": 1, "missed": 2},
        "calibration": calibration([0.25, 0.95], [True, True]),
    }
    return Evaluation(**(whole | given))


def test_bars_are_as_high_as_the_recall():
    bars = [
        bar
        for bar in ElementTree.fromstring(recall_plot(bins(1.0, 0.5, None), unit="m")).iter(f"{SVG}rect")
        if bar.get("rx") is None  # those of the legend are round
    ]
    assert len(bars) == 2 * 3  # none where there are no objects
    heights = [float(bar.get("height", "nan")) for bar in bars[:2]]
    assert heights[0] == pytest.approx(2 * heights[1], abs=0.2)
    assert bars[1].findtext(f"{SVG}title") == "without-tracking, 20–40 m: 2 of 4 found"


def test_a_line_for_each_method_and_a_dot_at_the_confidence():
    plot = ElementTree.fromstring(precision_recall_plot([curve(method) for method in METHODS], confidence=0.8))
    lines = [line.get("points", "").split() for line in plot.iter(f"{SVG}polyline")]
    assert [len(line) for line in lines] == [2, 2, 2]  # at threshold 1 nothing is found: no point
    dots = [f"{dot.get('cx')},{dot.get('cy')}" for dot in plot.iter(f"{SVG}circle")]
    assert dots == [line[0] for line in lines]


def test_a_method_that_finds_nothing_has_no_line():
    nothing = curve("multi-camera")
    nothing["recall"] = [0.0, 0.0, 0.0]
    plot = ElementTree.fromstring(precision_recall_plot([nothing], confidence=0.8))
    assert list(plot.iter(f"{SVG}polyline")) == []


def test_which_plots_there_are():
    assert list(plots_of(evaluation())) == [
        "precision-recall-iou-0.25",
        "precision-recall-iou-0.5",
        "reliability-iou-0.5",
        "recall-by-distance-iou-0.25",
        "recall-by-distance-iou-0.5",
    ]
    assert "recall-by-visible-share-iou-0.5" in plots_of(evaluation(by_visible_share=bins(0.5)))
    assert "reliability-iou-0.5" not in plots_of(evaluation(calibration=calibration([], [])))


def test_labels_that_say_what_is_so_lie_on_the_diagonal():
    """Four labels said .75 and three are right; the confidence says .5 of all of them."""
    plot = ElementTree.fromstring(reliability_plot(calibration([0.75] * 4, [True, True, True, False])))
    confidence, probability = plot.iter(f"{SVG}circle")
    (diagonal,) = (line for line in plot.iter(f"{SVG}line") if line.get("y1") != line.get("y2"))
    x1, y1, x2, y2 = (float(diagonal.get(name, "nan")) for name in ("x1", "y1", "x2", "y2"))

    def above(dot: ElementTree.Element) -> float:
        x, y = float(dot.get("cx", "nan")), float(dot.get("cy", "nan"))
        return (y1 - y) / (y1 - y2) - (x - x1) / (x2 - x1)

    assert above(probability) == pytest.approx(0, abs=0.005)
    assert above(confidence) == pytest.approx(0.25, abs=0.005)
    assert probability.findtext(f"{SVG}title") == "probability 0.75: 0.75 of 4 labels are right"


def test_the_report_shows_the_table():
    html = report_html(evaluation())
    cells = re.findall(r"<td[^>]*>([^<]*)</td>", html)
    assert cells[:9] == ["without-tracking", "all", "whole", "0.5", "–", "0.500", "7", "1", "7"]
    assert cells[18:23] == ["multi-camera", "all", "whole", "0.5", "0.875"]
    assert "made &lt;drive&gt; &amp; more" in html
    assert "1,234 boxes count" in html
    assert re.findall(r"<dt>([^<]*)</dt><dd>([^<]*)</dd>", html) == [
        ("HOTA", "0.500"),
        ("IDF1", "–"),
        ("MOTA", "-0.250"),
        ("Identity switches", "1,500"),
        ("Merges right", "3"),
        ("Merges missed", "2"),
        ("Merges wrong", "1"),
        ("Expected error of the probability", "0.400"),  # (.75 + .05) / 2
        ("Of the paper's confidence", "0.500"),
        ("Labels with a probability", "2"),
    ]


def test_the_report_says_what_stands_for_the_detections():
    assert "the detector's boxes as they are" in report_html(evaluation())
    assert "that are in a track" in report_html(evaluation(without_tracking_from="observations"))


def test_the_report_loads_nothing_and_runs_nothing():
    html = report_html(evaluation()).replace('xmlns="http://www.w3.org/2000/svg"', "")
    assert not re.search(r"https?:|src=|href=|url\(|@import|<script|<link", html)
    assert "prefers-color-scheme: dark" in html


def test_the_report_appears_whole_or_not_at_all(tmp_path: Path):
    path = tmp_path / "report.html"
    write_report(path, evaluation())
    assert path.read_text("utf-8") == report_html(evaluation())
    with pytest.raises(EvaluationError, match="can't be written"):
        write_report(tmp_path / "no folder" / "report.html", evaluation())
    assert [file.name for file in tmp_path.iterdir()] == ["report.html"]
