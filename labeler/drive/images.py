"""Reads recorded images, and refuses those that are not whole.

The JPEG decoder fills up a truncated file with grey and says nothing, which would make a detector see a grey half
world. So the end marker is looked for first: from the back of the file, and behind the start of the scan, because an
embedded thumbnail has an end marker of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import cast

import cv2
import numpy as np
from numpy.typing import NDArray

from labeler.drive.errors import DriveFileError
from labeler.drive.types import Camera, ImageFile

_PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_JPEG_SIGNATURE = b"\xff\xd8\xff"
_JPEG_END = b"\xff\xd9"
_JPEG_NOT_FRAME = frozenset({0xC4, 0xC8, 0xCC})
_JPEG_SCAN = 0xDA
_HEADER_BYTES = 65536


@dataclass(frozen=True)
class _JpegHeader:
    width_px: int
    height_px: int
    scan_offset: int


def read_image(file: ImageFile, camera: Camera | None = None) -> NDArray[np.uint8]:
    """The image as (H, W, 3) uint8 in the order blue, green, red; a grey file gets three equal channels.

    With a ``camera``, the image must have its size. Raises DriveFileError when the file can't be read, is truncated,
    is neither JPEG nor PNG, or has another size."""
    data = _read_bytes(file.path)
    problem = _incomplete(data)
    if problem:
        raise _unusable(file.path, problem)
    try:
        flags = cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION
        image = cast("NDArray[np.uint8] | None", cv2.imdecode(np.frombuffer(data, np.uint8), flags))
    except cv2.error as error:
        raise _unusable(file.path, f"can't be decoded ({str(error).strip()})") from error
    if image is None:
        raise _unusable(file.path, "can't be decoded: its content is damaged")
    if camera is not None and image.shape[:2] != (camera.height_px, camera.width_px):
        height_px, width_px = image.shape[:2]
        expected = f"{camera.width_px} x {camera.height_px}"
        raise _unusable(file.path, f"is {width_px} x {height_px} pixels, but camera {camera.name} has {expected}")
    return image


def image_size(path: Path) -> tuple[int, int]:
    """(width, height) in pixels from the header of a JPEG or PNG file, without decoding it. DriveFileError when the
    file can't be read or has no such header.
    """
    data = _read_bytes(path, _HEADER_BYTES)
    size = _size_in_header(data)
    if size is None and len(data) == _HEADER_BYTES:
        size = _size_in_header(_read_bytes(path))
    if size is None:
        raise _unusable(path, "has no JPEG or PNG header with a size")
    return size


def _read_bytes(path: Path, at_most: int = -1) -> bytes:
    try:
        with path.open("rb") as stream:
            return stream.read(at_most)
    except OSError as error:
        raise _unusable(path, f"can't be read ({error.strerror})") from error


def _unusable(path: Path, problem: str) -> DriveFileError:
    return DriveFileError(f"The image {path} {problem}. It is skipped in its frame.")


def _size_in_header(data: bytes) -> tuple[int, int] | None:
    if data.startswith(_PNG_SIGNATURE) and len(data) >= 24:
        return int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")
    header = _jpeg_header(data)
    return None if header is None else (header.width_px, header.height_px)


def _incomplete(data: bytes) -> str | None:
    """What is wrong with a file as a whole, or None."""
    if not data:
        return "is empty"
    if data.startswith(_PNG_SIGNATURE):
        end = data.rfind(b"IEND")
        return None if 0 <= end <= len(data) - 8 else "is truncated: the PNG end chunk is missing"
    if data.startswith(_JPEG_SIGNATURE):
        header = _jpeg_header(data)
        if header is None:
            return "is truncated or damaged: the JPEG header is not whole"
        return None if data.rfind(_JPEG_END) > header.scan_offset else "is truncated: the JPEG end marker is missing"
    return "is neither JPEG nor PNG"


def _jpeg_header(data: bytes) -> _JpegHeader | None:
    """Walks the segments before the first scan (ITU T.81, annex B); None when the data ends before."""
    if not data.startswith(_JPEG_SIGNATURE):
        return None
    offset, size = 2, None
    while offset + 4 <= len(data):
        if data[offset] != 0xFF:
            return None
        marker = data[offset + 1]
        if marker == 0xFF:  # a fill byte
            offset += 1
            continue
        if marker == _JPEG_SCAN:
            return None if size is None else _JpegHeader(size[0], size[1], offset)
        if 0xC0 <= marker <= 0xCF and marker not in _JPEG_NOT_FRAME and offset + 9 <= len(data):
            height_px = int.from_bytes(data[offset + 5 : offset + 7], "big")
            size = int.from_bytes(data[offset + 7 : offset + 9], "big"), height_px
        length = int.from_bytes(data[offset + 2 : offset + 4], "big")
        offset += 2 + max(length, 2)
    return None
