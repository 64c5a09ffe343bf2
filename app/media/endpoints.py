"""Images for the browser."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import Response

from app.db.session import ReadSession
from app.dependencies import AppSettings
from app.media import service
from app.media.service import parse_crop

router = APIRouter(prefix="/api/drives/{drive_id}", tags=["media"])


@router.get(
    "/frames/{frame_index}/images/{camera}",
    response_class=Response,
    responses={200: {"content": {"image/jpeg": {}}, "description": "The image as JPEG."}},
)
def get_image(
    drive_id: int,
    frame_index: int,
    camera: str,
    request: Request,
    session: ReadSession,
    settings: AppSettings,
    max_width: Annotated[int | None, Query(ge=16, le=16384, description="Shrink wider images to this width.")] = None,
    crop: Annotated[
        str | None,
        Query(pattern=r"^\d{1,5},\d{1,5},\d{1,5},\d{1,5}$", description="Cut out x,y,width,height (original pixels)."),
    ] = None,
) -> Response:
    """The image of one camera in one frame, or a part of it."""
    image = service.find_image(
        session, settings, drive_id, frame_index, camera, max_width=max_width, crop=parse_crop(crop)
    )
    headers = {"ETag": image.etag, "Cache-Control": "private, max-age=31536000, immutable"}
    if request.headers.get("if-none-match") == image.etag:
        return Response(status_code=304, headers=headers)
    return Response(image.read_jpeg(), media_type="image/jpeg", headers=headers)
