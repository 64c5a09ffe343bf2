"""COCO files: as the format wants them, whole, and readable by COCO's own tool."""

import contextlib
import io
import json
import tracemalloc
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pycocotools.coco import COCO

from labeler.export import DatasetInfo, DonorReference, ExportError, LabelledBox, LabelledImage, find_exporter
from labeler.export.coco import COCO_CATEGORY_IDS, category_ids

INFO = DatasetInfo(
    drive="a drive",
    drive_format="argoverse2",
    model="yolox_nano",
    hindsight_version="0.1.0",
    created_at="2026-01-02T03:04:05+00:00",
    min_score=0.25,
    class_names=("person", "car", "cone", "truck"),
)
DONOR = DonorReference(track_id=9, camera="left", frame_index=4, score=0.9)


def _box(
    xyxy_px: tuple[float, float, float, float] = (10.0, 20.0, 30.5, 60.25),
    *,
    class_id: int = 1,
    donor: DonorReference | None = None,
) -> LabelledBox:
    source = "auto" if donor is None else "propagated"
    return LabelledBox(xyxy_px, class_id, 0.5, track_id=3, identity_id=2, source=source, filled=False, donor=donor)


def _image(frame: int, *boxes: LabelledBox) -> LabelledImage:
    return LabelledImage(f"front/{frame}.jpg", "front", frame, 1_700_000_000_000_000_123 + frame, 100, 80, boxes)


def _write(path: Path, *images: LabelledImage) -> dict[str, Any]:
    find_exporter("coco").write(path, images, info=INFO)
    return json.loads(path.read_text(encoding="utf-8"))


def test_one_annotation_in_full(tmp_path: Path) -> None:
    dataset = _write(tmp_path / "a.json", _image(0, _box(donor=DONOR)))
    assert dataset["annotations"] == [
        {
            "id": 1,
            "image_id": 1,
            "category_id": 3,
            "bbox": [10.0, 20.0, 20.5, 40.25],
            "area": 825.12,  # 20.5 x 40.25 = 825.125, a half rounded to even
            "segmentation": [],
            "iscrowd": 0,
            "score": 0.5,
            "track_id": 3,
            "identity_id": 2,
            "attributes": {
                "source": "propagated",
                "filled": False,
                "donor_camera": "left",
                "donor_frame_index": 4,
                "donor_track_id": 9,
                "donor_score": 0.9,
            },
        }
    ]
    assert dataset["images"][0]["timestamp_ns"] == "1700000000000000123"
    assert dataset["info"]["description"] == "Labels of drive a drive, made by Hindsight"
    assert (dataset["info"]["version"], dataset["info"]["model"], dataset["info"]["min_score"]) == (
        "0.1.0",
        "yolox_nano",
        0.25,
    )


def test_ids_of_cocos_own_classes() -> None:
    # as in COCO's instances_val2017.json
    assert len(COCO_CATEGORY_IDS) == 80
    known = {"person": 1, "car": 3, "truck": 8, "stop sign": 13, "zebra": 24, "backpack": 27, "toothbrush": 90}
    assert {name: COCO_CATEGORY_IDS[name] for name in known} == known


def test_other_classes_get_ids_of_their_own() -> None:
    assert category_ids(("van", "car", "tram")) == {"van": 91, "car": 3, "tram": 92}


@pytest.mark.parametrize(
    ("xyxy_px", "bbox"),
    [
        ((-5.0, 10.0, 20.0, 30.0), [0.0, 10.0, 20.0, 20.0]),  # over the left edge
        ((90.0, 70.0, 130.0, 100.0), [90.0, 70.0, 10.0, 10.0]),  # over the lower right corner
        ((100.0, 10.0, 120.0, 30.0), None),  # outside: it only touches the edge
        ((10.0, 10.0, 10.0, 30.0), None),  # no width
    ],
)
def test_boxes_are_cut_at_the_edges(
    tmp_path: Path, xyxy_px: tuple[float, float, float, float], bbox: list[float] | None
) -> None:
    dataset = _write(tmp_path / "a.json", _image(0, _box(xyxy_px)))
    assert [annotation["bbox"] for annotation in dataset["annotations"]] == ([] if bbox is None else [bbox])


def test_cocos_own_tool_reads_it(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    images = [_image(0, _box(), _box(class_id=2)), _image(1), _image(2, _box(class_id=0, donor=DONOR))]
    summary = find_exporter("coco").write(path, images, info=INFO)
    assert (summary.image_count, summary.label_count) == (3, 3)
    with contextlib.redirect_stdout(io.StringIO()):
        coco = COCO(str(path))
    assert sorted(coco.getImgIds()) == [1, 2, 3]
    assert sorted(coco.getAnnIds()) == [1, 2, 3]
    assert [category["name"] for category in coco.loadCats(coco.getCatIds())] == list(INFO.class_names)
    assert [a["category_id"] for a in coco.loadAnns(coco.getAnnIds(imgIds=[1]))] == [3, 91]
    assert coco.getAnnIds(imgIds=[2]) == []


def test_a_drive_without_images(tmp_path: Path) -> None:
    dataset = _write(tmp_path / "a.json")
    assert (dataset["images"], dataset["annotations"]) == ([], [])


def test_a_file_appears_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_text("the file before")

    def broken() -> Iterator[LabelledImage]:
        yield _image(0, _box())
        raise RuntimeError("the drive broke off")

    with pytest.raises(RuntimeError):
        find_exporter("coco").write(path, broken(), info=INFO)
    assert [file.read_text() for file in tmp_path.iterdir()] == ["the file before"]


def test_a_place_that_can_not_be_written_to(tmp_path: Path) -> None:
    (tmp_path / "folder").write_text("no folder")
    with pytest.raises(ExportError, match="can't be written"):
        find_exporter("coco").write(tmp_path / "folder" / "a.json", [], info=INFO)


def test_memory_holds_a_small_part_of_the_file(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    images = (_image(frame, *[_box(donor=DONOR)] * 20) for frame in range(1000))
    tracemalloc.start()
    find_exporter("coco").write(path, images, info=INFO)
    _, highest = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert highest < path.stat().st_size / 10


def test_names_of_formats() -> None:
    assert find_exporter("COCO").suffix == ".json"
    with pytest.raises(ExportError, match="Known are: coco"):
        find_exporter("yolo")
