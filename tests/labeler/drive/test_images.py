"""Images: whole ones are read as BGR, and each way to be broken is told."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from labeler.drive.errors import DriveFileError
from labeler.drive.images import image_size, read_image
from labeler.drive.types import Camera, ImageFile

WriteImage = Callable[..., Path]
_THUMBNAIL = b"\xff\xd8\xff\xdb\x00\x02thumbnail\xff\xd9"


def _file(path: Path) -> ImageFile:
    return ImageFile("front", 0, path)


def _with_thumbnail(jpeg: bytes) -> bytes:
    """With a segment (APP1) that holds a JPEG of its own, as cameras write it."""
    return jpeg[:2] + b"\xff\xe1" + (len(_THUMBNAIL) + 2).to_bytes(2, "big") + _THUMBNAIL + jpeg[2:]


@pytest.mark.parametrize("suffix", [".jpg", ".png"])
@pytest.mark.parametrize("grey", [False, True])
def test_reads_colour_and_grey_as_bgr(tmp_path: Path, write_image: WriteImage, suffix: str, *, grey: bool) -> None:
    image = read_image(_file(write_image(tmp_path / f"a{suffix}", 32, 16, grey=grey)))
    assert image.shape == (16, 32, 3)
    assert image.dtype == np.uint8
    if grey:
        assert (image[..., 0] == image[..., 2]).all()


def test_channels_are_blue_green_red(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    blue = np.zeros((2, 2, 3), dtype=np.uint8)
    blue[..., 0] = 200
    path.write_bytes(cv2.imencode(".png", blue)[1].tobytes())
    assert read_image(_file(path))[0, 0].tolist() == [200, 0, 0]


@pytest.mark.parametrize(
    "change",
    [
        lambda data: data,  # as written
        lambda data: data + bytes(500),  # padded with zeros, as some recorders do
        lambda data: data + b"\n",  # a line end behind
        _with_thumbnail,  # an end marker of its own in the header
        lambda data: data[:2] + b"\xff" + data[2:],  # a fill byte before a marker
    ],
)
def test_reads_whole_jpegs(tmp_path: Path, write_image: WriteImage, change: Callable[[bytes], bytes]) -> None:
    path = write_image(tmp_path / "a.jpg", 32, 16)
    path.write_bytes(change(path.read_bytes()))
    assert read_image(_file(path)).shape == (16, 32, 3)


@pytest.mark.parametrize(
    ("suffix", "change", "message"),
    [
        (".jpg", lambda data: data[: len(data) // 2], "end marker is missing"),  # cut in the middle
        (".jpg", lambda data: data[:-2], "end marker is missing"),  # cut at the very end
        (".jpg", lambda data: data[: len(data) // 2] + bytes(len(data) // 2), "end marker"),  # cut, then zeros
        (".jpg", lambda data: _with_thumbnail(data)[:-9], "end marker"),  # the thumbnail's marker does not count
        (".jpg", lambda data: data[:40], "header is not whole"),
        (".jpg", lambda data: data[:2] + b"\xff\xe0\x00\x04ab?" + data[2:], "header is not whole"),  # no marker there
        (".png", lambda data: data[: len(data) // 2], "end chunk is missing"),
        (".png", lambda data: data[:-4], "end chunk is missing"),  # the check sum of the end is missing
        (".png", lambda data: data[:60] + b"????" + data[64:], "damaged"),  # wrong bytes inside
        (".jpg", lambda _: b"", "is empty"),
        (".jpg", lambda _: b"GIF89a" + bytes(50), "neither JPEG nor PNG"),
    ],
)
def test_refuses_broken_images(
    tmp_path: Path, write_image: WriteImage, suffix: str, change: Callable[[bytes], bytes], message: str
) -> None:
    path = write_image(tmp_path / f"broken{suffix}", 32, 16)
    path.write_bytes(change(path.read_bytes()))
    with pytest.raises(DriveFileError, match=message) as raised:
        read_image(_file(path))
    assert str(path) in str(raised.value)
    assert "skipped" in str(raised.value)


def test_refuses_a_file_that_is_gone(tmp_path: Path) -> None:
    with pytest.raises(DriveFileError, match="can't be read"):
        read_image(_file(tmp_path / "gone.jpg"))


def test_refuses_an_image_of_another_size_than_its_camera(tmp_path: Path, write_image: WriteImage) -> None:
    file = _file(write_image(tmp_path / "a.jpg", 32, 16))
    assert read_image(file, Camera("front", 32, 16, None)).shape == (16, 32, 3)
    with pytest.raises(DriveFileError, match="is 32 x 16 pixels, but camera front has 16 x 32"):
        read_image(file, Camera("front", 16, 32, None))


@pytest.mark.parametrize("suffix", [".jpg", ".jpeg", ".png"])
def test_size_comes_from_the_header_alone(tmp_path: Path, write_image: WriteImage, suffix: str) -> None:
    path = write_image(tmp_path / f"a{suffix}", 48, 20)
    data = path.read_bytes()
    path.write_bytes(data[: len(data) * 3 // 4])
    assert image_size(path) == (48, 20)


def test_size_is_found_behind_a_long_header(tmp_path: Path, write_image: WriteImage) -> None:
    path = write_image(tmp_path / "a.jpg", 48, 20)
    segment = b"\xff\xe2" + (60_002).to_bytes(2, "big") + bytes(60_000)
    data = path.read_bytes()
    path.write_bytes(data[:2] + segment * 3 + data[2:])
    assert image_size(path) == (48, 20)
    assert read_image(_file(path)).shape == (20, 48, 3)


def test_size_of_what_is_no_image(tmp_path: Path) -> None:
    path = tmp_path / "a.jpg"
    path.write_text("no image")
    with pytest.raises(DriveFileError, match="no JPEG or PNG header"):
        image_size(path)
