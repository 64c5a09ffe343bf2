"""Images of a drive as JPEG."""

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import cv2
import numpy as np
from numpy.typing import NDArray

from app.db.session import Session
from app.drives import repository
from app.errors import NotFound
from app.settings import Settings

JPEG_QUALITY = 90
JPEG_SUFFIXES = (".jpg", ".jpeg")


@dataclass(frozen=True)
class StoredImage:
    """An image file of a drive, and how wide it is wanted at most."""

    path: Path
    max_width: int | None
    etag: str

    def read_jpeg(self) -> bytes:
        """The image as JPEG: as recorded where that will do. NotFound where the file is gone or damaged."""
        try:
            content = self.path.read_bytes()
        except OSError as error:
            raise NotFound(f"The image {self.path} can't be read: {error.strerror or error}.") from error
        is_jpeg = self.path.suffix.lower() in JPEG_SUFFIXES
        if is_jpeg and self.max_width is None:
            return content
        image = (
            cast("NDArray[np.uint8] | None", cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_COLOR))
            if content
            else None
        )
        if image is None:
            raise NotFound(f"The image {self.path} is damaged and can't be shown.")
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
    version = f"{path}|{file.st_mtime_ns}|{file.st_size}|{max_width}"
    return StoredImage(path, max_width, etag=f'"{hashlib.sha256(version.encode()).hexdigest()[:32]}"')


def _to_jpeg(image: NDArray[np.uint8], max_width: int | None) -> bytes:
    height, width = image.shape[:2]
    if max_width is not None and width > max_width:
        size = (max_width, max(1, round(height * max_width / width)))
        image = cast("NDArray[np.uint8]", cv2.resize(image, size, interpolation=cv2.INTER_AREA))
    _, encoded = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    return encoded.tobytes()
