"""Naming the places of an edit by boxes, so that they can be found in another labelling of the drive.

A place on a track of the machine is named by the nearest box of that track; one on a track that a person made by the
edit that made it.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from app.db.session import Session
from app.drives import repository as drives_repository
from app.edits import repository
from app.edits import track_repository as tracks
from app.edits.types import Effect, EffectKind, Place
from app.reviews.schemas import TrackAnchor
from app.tracks import repository as tracks_repository
from app.tracks.models import LabellingRow
from labeler.geometry.boxes_2d import iou_matrix

MIN_IOU = 0.5


def to_payload(session: Session, labelling: LabellingRow, effect: Effect, *, review_id: int) -> dict[str, Any]:
    """An effect of a labelling in the form that outlives it."""
    return {
        "kind": effect.kind,
        "place": _name(session, labelling, effect.place, review_id=review_id),
        "other": effect.other and _name(session, labelling, effect.other, review_id=review_id),
        "until_frame": effect.until_frame,
        "value": dict(effect.value),
    }


def _name(session: Session, labelling: LabellingRow, place: Place, *, review_id: int) -> dict[str, Any]:
    box = tracks.nearest_machine_box(session, labelling.id, place.tracked_id, place.frame_index)
    if box is None:
        made_by = repository.maker_of(session, labelling.id, place.tracked_id)
        return {"frame_index": place.frame_index, "drawn_by": review_id if made_by is None else made_by}
    camera_id = tracks.pieces_of(session, labelling.id, [place.tracked_id])[0].camera_id
    [time_ns] = drives_repository.image_times_ns(session, labelling.drive_id, [(box.frame_index, camera_id)])
    anchor = TrackAnchor(
        camera=tracks_repository.camera_names(session, labelling.drive_id)[camera_id],
        frame_index=box.frame_index,
        timestamp_ns=str(time_ns),
        box=box.box,
    )
    return {"frame_index": place.frame_index, "anchor": anchor.model_dump(mode="json")}


class TrackIds:
    """Ids for tracks that edits make; none is ever given twice in a labelling."""

    def __init__(self, session: Session, labelling_id: int) -> None:
        self._session = session
        self._labelling_id = labelling_id
        self._last = repository.last_track_id(session, labelling_id)

    def next(self) -> int:
        self._last += 1
        return self._last

    def of_cut(self, place: Place) -> int:
        """The id of the track that begins at a place: always the same, though the cut be undone and made again."""
        known = repository.made_track_id(self._session, self._labelling_id, place)
        return self.next() if known is None else known


class EffectFinder:
    """Finds the effects of edits in a labelling."""

    def __init__(self, session: Session, labelling: LabellingRow) -> None:
        self._session = session
        self._labelling = labelling
        names = tracks_repository.camera_names(session, labelling.drive_id)
        self._camera_ids = {name: camera_id for camera_id, name in names.items()}
        self._made_by: dict[int, int] = {}
        self._ids = TrackIds(session, labelling.id)

    def find(self, payload: Mapping[str, Any], *, review_id: int) -> Effect | None:
        """An effect in terms of this labelling; None where the labelling has not what it is about."""
        kind = EffectKind(payload["kind"])
        if payload["value"].get("class_name", self._labelling.class_names[0]) not in self._labelling.class_names:
            return None
        if kind is EffectKind.NEW:
            self._made_by[review_id] = self._ids.next()
        place = self._find(payload["place"])
        other = payload["other"] and self._find(payload["other"])
        if place is None or (payload["other"] and other is None):
            return None
        made = self._ids.of_cut(place) if kind is EffectKind.CUT else None
        return Effect(
            kind,
            place,
            other=other or None,
            until_frame=payload["until_frame"],
            made_track_id=made,
            value=payload["value"],
        )

    def _find(self, name: Mapping[str, Any]) -> Place | None:
        if "drawn_by" in name:
            tracked = self._made_by.get(name["drawn_by"])
            if tracked is None:
                tracked = repository.track_made_by(self._session, self._labelling.id, name["drawn_by"])
        else:
            tracked = self._find_tracked(TrackAnchor.model_validate(name["anchor"]))
        return None if tracked is None else Place(tracked, name["frame_index"])

    def _find_tracked(self, anchor: TrackAnchor) -> int | None:
        """The track as tracked whose box overlaps the anchor's most, and by at least half."""
        camera_id = self._camera_ids.get(anchor.camera)
        if camera_id is None:
            return None
        boxes = tracks.machine_boxes_in_image(self._session, self._labelling.id, camera_id, anchor.frame_index)
        if not boxes:
            return None
        overlaps = iou_matrix(np.array([anchor.box]), np.array([box[1:] for box in boxes], np.float64))[0]
        best = int(np.argmax(overlaps))
        return boxes[best].tracked_id if overlaps[best] >= MIN_IOU else None
