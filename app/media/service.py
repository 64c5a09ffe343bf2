"""Images of a drive as JPEG."""

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, cast

import cv2
import numpy as np
from numpy.typing import NDArray

from app.db.session import Session
from app.drives import repository
from app.errors import InvalidRequest, NotFound
from app.settings import Settings

JPEG_QUALITY = 90
JPEG_SUFFIXES = (".jpg", ".jpeg")


class Crop(NamedTuple):
    """A window of an image in pixels."""

    x: int
    y: int
    width: int
    height: int


@dataclass(frozen=True)
class StoredImage:
    """An image file of a drive, and what of it is wanted: a part, and how wide at most."""

    path: Path
    max_width: int | None
    crop: Crop | None
    etag: str

    def read_jpeg(self) -> bytes:
        """The image as JPEG: as recorded where that will do. NotFound where the file is gone or damaged."""
        try:
            content = self.path.read_bytes()
        except OSError as error:
            raise NotFound(f"The image {self.path} can't be read: {error.strerror or error}.") from error
        is_jpeg = self.path.suffix.lower() in JPEG_SUFFIXES
        if is_jpeg and self.max_width is None and self.crop is None:
            return content
        image = (
            cast("NDArray[np.uint8] | None", cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_COLOR))
            if content
            else None
        )
        if image is None:
            raise NotFound(f"The image {self.path} is damaged and can't be shown.")
        if self.crop is not None:
            return _to_jpeg(_cut(image, self.crop, self.path), self.max_width)
        if is_jpeg and (self.max_width is None or image.shape[1] <= self.max_width):
            return content
        return _to_jpeg(image, self.max_width)


def find_image(
    session: Session,
    settings: Settings,
    drive_id: int,
    frame_index: int,
    camera: str,
    *,
    max_width: int | None,
    crop: Crop | None = None,
) -> StoredImage:
    """The image of a camera in a frame, by what the store knows of it."""
    stored = repository.find_image(session, drive_id, frame_index, camera)
    if stored is None:
        raise NotFound(f"Drive {drive_id} has no image of camera {camera!r} in frame {frame_index}.")
    path = settings.workspace / stored.drive_path / stored.image_path
    try:
        file = path.stat()
    except OSError as error:
        raise NotFound(f"The image {path} is no longer there. Was the drive's folder moved?") from error
    version = f"{path}|{file.st_mtime_ns}|{file.st_size}|{max_width}|{crop}"
    return StoredImage(path, max_width, crop, etag=f'"{hashlib.sha256(version.encode()).hexdigest()[:32]}"')


def parse_crop(words: str | None) -> Crop | None:
    """``x,y,width,height`` in whole pixels."""
    return None if words is None else Crop(*(int(number) for number in words.split(",")))


def _cut(image: NDArray[np.uint8], crop: Crop, path: Path) -> NDArray[np.uint8]:
    """The part of an image that lies in the window; InvalidRequest where none does."""
    part = image[crop.y : crop.y + crop.height, crop.x : crop.x + crop.width]
    if part.size == 0:
        height, width = image.shape[:2]
        raise InvalidRequest(
            f"The window {crop.x},{crop.y},{crop.width},{crop.height} holds nothing of {path.name}, which is {width} x "
            f"{height} pixels."
        )
    return part


def _to_jpeg(image: NDArray[np.uint8], max_width: int | None) -> bytes:
    height, width = image.shape[:2]
    if max_width is not None and width > max_width:
        size = (max_width, max(1, round(height * max_width / width)))
        image = cast("NDArray[np.uint8]", cv2.resize(image, size, interpolation=cv2.INTER_AREA))
    _, encoded = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    return encoded.tobytes()
