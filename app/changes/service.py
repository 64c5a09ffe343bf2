"""The values of :class:`app.changes.schemas.LabelChange`: what a decision reached, and nothing of the rest of a drive.

They are plain, as those of the lists are: a page waits for them, and models of hundreds of labels take most of it.
"""

from collections.abc import Collection, Sequence
from typing import Any

from app.db.session import Session
from app.identities.linking import Relinked
from app.identities.service import values_of_identities
from app.merges import repository as merges_repository
from app.merges.impact import Impact
from app.merges.values import merge_values
from app.tracks import repository as tracks_repository
from app.tracks.models import LabellingRow, TrackRow
from app.tracks.service import observations_of_tracks, track_values

MOST_OBSERVATIONS = 20_000
"""More come faster as the page shows them, in blocks of frames."""


def change_values(
    session: Session, labelling: LabellingRow, relinked: Relinked, *, revision: int, beside: Collection[int] = ()
) -> dict[str, Any]:
    """What ``relinked`` changed. ``beside`` are tracks of which merges are told though nothing reached them."""
    reached = tracks_repository.tracks_of_identities(session, labelling.id, relinked.identity_ids)
    told = reached or tracks_repository.tracks_of_same_identities(session, labelling.id, beside)
    return {
        "revision": revision,
        "changed_label_count": relinked.changed_label_count,
        "identity_ids": relinked.identity_ids,
        "identities": values_of_identities(session, labelling, relinked.identity_ids, reached),
        "gone_identity_ids": relinked.gone_identity_ids,
        "tracks": track_values(session, labelling, reached),
        "merges": _merges(session, labelling, told, relinked.joined),
        "changed_track_ids": sorted(relinked.changed_tracks),
        "observations": _observations(session, labelling, relinked, reached),
    }


def _merges(
    session: Session, labelling: LabellingRow, told: Sequence[TrackRow], joined: Sequence[tuple[int, int]]
) -> list[dict[str, Any]]:
    rows = merges_repository.merges_of_tracks(session, labelling.id, [track.track_id for track in told])
    tracks = tracks_repository.tracks_of_same_identities(
        session, labelling.id, {track for row in rows for track in row.tracks}
    )
    cameras = tracks_repository.camera_names(session, labelling.drive_id)
    camera_of = {track.track_id: cameras[track.camera_id] for track in tracks}
    accepted = merges_repository.accepted_pairs(session, labelling.id, camera_of)
    impact = Impact(tracks, [*joined, *accepted])
    return [merge_values(row, impact, camera_of) for row in rows]


def _observations(
    session: Session, labelling: LabellingRow, relinked: Relinked, reached: Sequence[TrackRow]
) -> list[dict[str, Any]] | None:
    changed = [track for track in reached if track.track_id in relinked.changed_tracks]
    if sum(track.observation_count for track in changed) > MOST_OBSERVATIONS:
        return None
    return observations_of_tracks(session, labelling, [track.track_id for track in changed])
