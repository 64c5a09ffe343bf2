"""Images over HTTP."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from app.db.session import Store
from app.drives.models import ImageRow
from tests.app.browser import Browser


def _decode(content: bytes) -> np.ndarray:
    image = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_COLOR)
    assert image is not None
    return image


def test_a_jpeg_comes_as_it_was_recorded(client: Browser, drive_id: int, three_camera_drive: Path) -> None:
    answer = client.get(f"/api/drives/{drive_id}/frames/3/images/left")
    file = three_camera_drive / "sensors" / "cameras" / "left" / "1700000000300000000.jpg"
    assert answer.content == file.read_bytes()
    assert answer.headers["content-type"] == "image/jpeg"
    assert answer.headers["cache-control"] == "private, max-age=31536000, immutable"
    assert abs(float(_decode(answer.content).mean()) - 40) < 3  # frame 3, camera 1


def test_an_image_that_the_browser_has_is_not_sent_again(client: Browser, drive_id: int) -> None:
    url = f"/api/drives/{drive_id}/frames/0/images/front"
    etag = client.get(url).headers["etag"]
    again = client.get(url, headers={"if-none-match": etag})
    assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", etag)
    assert client.get(url, params={"max_width": 48}).headers["etag"] != etag
    assert client.get(f"/api/drives/{drive_id}/frames/1/images/front").headers["etag"] != etag


@pytest.mark.parametrize(
    ("max_width", "size"),
    [
        (48, (32, 48)),  # half of 96 x 64
        (200, (64, 96)),  # never enlarged
    ],
)
def test_images_are_shrunk(client: Browser, drive_id: int, max_width: int, size: tuple[int, int]) -> None:
    answer = client.get(f"/api/drives/{drive_id}/frames/2/images/right", params={"max_width": max_width})
    assert _decode(answer.content).shape[:2] == size


def test_a_part_is_cut_out(client: Browser, drive_id: int) -> None:
    url = f"/api/drives/{drive_id}/frames/2/images/right"
    whole = client.get(url)
    part = client.get(url, params={"crop": "10,20,30,16"})
    assert _decode(part.content).shape[:2] == (16, 30)
    assert part.headers["etag"] != whole.headers["etag"]
    # what sticks out of 96 x 64 is left away; shrunk after it was cut
    assert _decode(client.get(url, params={"crop": "80,0,100,100"}).content).shape[:2] == (64, 16)
    assert _decode(client.get(url, params={"crop": "0,0,64,32", "max_width": 32}).content).shape[:2] == (16, 32)


@pytest.mark.parametrize(
    ("crop", "words"),
    [
        ("96,0,10,10", "holds nothing"),  # beside the image
        ("0,0,0,10", "holds nothing"),  # no width
        ("-1,0,10,10", "not valid"),
        ("1,2,3", "not valid"),
    ],
)
def test_a_part_that_is_none_is_refused(client: Browser, drive_id: int, crop: str, words: str) -> None:
    answer = client.get(f"/api/drives/{drive_id}/frames/2/images/right", params={"crop": crop})
    assert answer.status_code == 422
    assert words in answer.json()["detail"]["message"]


def test_a_png_comes_as_jpeg(store: Store, client: Browser, drive_id: int, tmp_path: Path) -> None:
    png = tmp_path / "image.png"
    cv2.imwrite(str(png), np.full((20, 30, 3), 77, np.uint8))
    with store.write() as session:
        session.query(ImageRow).filter_by(drive_id=drive_id, frame_index=0).update({"path": str(png)})
    answer = client.get(f"/api/drives/{drive_id}/frames/0/images/front")
    assert answer.content.startswith(b"\xff\xd8\xff")
    assert _decode(answer.content).shape == (20, 30, 3)


def test_a_damaged_image_is_named(store: Store, client: Browser, drive_id: int, tmp_path: Path) -> None:
    for content in (b"", b"no image"):
        (tmp_path / "image.png").write_bytes(content)
        with store.write() as session:
            session.query(ImageRow).filter_by(drive_id=drive_id).update({"path": str(tmp_path / "image.png")})
        answer = client.get(f"/api/drives/{drive_id}/frames/0/images/front")
        assert answer.status_code == 404
        assert "image.png is damaged" in answer.json()["detail"]["message"]


@pytest.mark.parametrize(
    "path",
    [
        "frames/6/images/front",  # the drive ends at 5
        "frames/0/images/rear",  # no such camera
        "frames/0/images/..%2F..%2Fcalibration",  # no way out
        "frames/-1/images/front",
    ],
)
def test_images_that_are_not_there(client: Browser, drive_id: int, path: str) -> None:
    assert client.get(f"/api/drives/{drive_id}/{path}").status_code == 404
