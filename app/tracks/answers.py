"""Answers that hold until a drive's labels change: the browser keeps them, and only asks whether they still hold.

The tag names the labelling and the drive's revision, both of which every change of labels raises; so that nothing is
worked out again for a page that is loaded anew.
"""

import hashlib
from collections.abc import Callable

from fastapi import Request
from fastapi.responses import Response

from app import __version__
from app.db.session import Session
from app.drives import repository as drives_repository
from app.errors import NotFound
from app.tracks import repository


def answer_for_labels(request: Request, session: Session, drive_id: int, make: Callable[[], bytes]) -> Response:
    """What ``make`` gives, as JSON; 304 without a body where the browser has it already. NotFound without a drive."""
    tag = _tag(session, drive_id)
    headers = {"Cache-Control": "no-cache"} | ({"ETag": tag} if tag else {})
    known = [one.strip() for one in request.headers.get("if-none-match", "").split(",")]
    if tag is not None and tag in known:
        return Response(status_code=304, headers=headers)
    return Response(make(), media_type="application/json", headers=headers)


def _tag(session: Session, drive_id: int) -> str | None:
    """None before the drive is labelled."""
    drive = drives_repository.find(session, drive_id)
    if drive is None:
        raise NotFound(f"There is no drive {drive_id}. It may have been deleted.")
    labelling = repository.current_labelling(session, drive_id)
    if labelling is None:
        return None
    # Another workspace on the same port may have the same numbers, but it was labelled at another time.
    parts = (__version__, labelling.key, labelling.created_at.isoformat(), labelling.id, drive.revision)
    return f'W/"{hashlib.sha256(repr(parts).encode()).hexdigest()[:24]}"'
