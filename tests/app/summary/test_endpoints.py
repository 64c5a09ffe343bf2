"""Counts of labels over HTTP."""

from collections import Counter
from typing import Any

from app.db.session import Store
from tests.app.browser import Browser
from tests.app.conftest import Page


def _labels(histogram: dict[str, Any]) -> Counter[tuple[str, str, int | None, int | None]]:
    """Labels by class, source, score bin and distance bin."""
    columns = ("class_id", "source", "score_bin", "distance_bin", "count")
    found: Counter[tuple[str, str, int | None, int | None]] = Counter()
    for class_id, source, score_bin, distance_bin, count in zip(*(histogram[name] for name in columns), strict=True):
        place = (histogram["class_names"][class_id], histogram["sources"][source], score_bin, distance_bin)
        found[place] += count
    return found


def test_labels_are_counted_by_class_source_score_and_distance(page: Page) -> None:
    histogram = page.get("histogram")
    assert histogram["distance_edges_m"][:2] == [0.0, 10.0]
    # identity 1 holds tracks 1 (6 boxes, its best .9 in frame 2, 12 m away in all but the filled-in frame) and 2 (4)
    assert _labels(histogram) == {
        ("car", "auto", 90, 1): 1,
        ("car", "propagated", 90, 1): 4,
        ("car", "propagated", 90, None): 1 + 4,
        ("car", "auto", 70, None): 1,  # track 3
        ("car", "propagated", 70, None): 3,
        ("truck", "auto", 50, None): 1,  # track 4
        ("truck", "propagated", 50, None): 2,
        ("cone", "auto", 30, None): 1,  # track 5
        ("cone", "propagated", 30, None): 1,
    }


def test_what_the_detector_said_is_counted_beside(page: Page) -> None:
    histogram = page.get("histogram")
    own: Counter[int | None] = Counter()
    for score_bin, count in zip(histogram["own_score_bin"], histogram["own_count"], strict=True):
        own[score_bin] += count
    # of tracks 1 to 5 in turn; the box that was filled in has none. .29 * 100 must not be 28.
    scores = [40, 50, 90, None, 60, 50, 30, 40, 60, 50, 50, 60, 70, 20, 40, 50, 30, 30, 20]
    assert own == Counter(scores)


def test_counts_follow_decisions(page: Page) -> None:
    before = page.get("histogram")
    page.decide("accept", 3, 4)  # the three labels of 4 become car .7
    after = page.get("histogram")
    assert after["revision"] > before["revision"]
    assert _labels(after)["car", "propagated", 70, None] == 6
    assert sum(after["count"]) == sum(before["count"]) == 19


def test_a_drive_without_labels_has_none(client: Browser, store: Store, drive_id: int) -> None:
    histogram = client.get(f"/api/drives/{drive_id}/histogram").json()
    assert (histogram["count"], histogram["class_names"]) == ([], [])
