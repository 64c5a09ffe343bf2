"""What an edit is about, looked up by the numbers that the page knows."""

from collections.abc import Iterable

from app.db.session import Session
from app.drives.models import CameraRow, DriveRow
from app.drives.repository import cameras_of
from app.edits import track_repository
from app.edits.types import Place
from app.errors import InvalidRequest, NotFound
from app.identities import repository as identities_repository
from app.identities.models import IdentityRow
from app.tracks import repository as tracks_repository
from app.tracks.models import LabellingRow, TrackRow


class Subjects:
    """Identities, tracks and cameras of a drive's current labelling."""

    def __init__(self, session: Session, drive: DriveRow, labelling: LabellingRow) -> None:
        self._session = session
        self.drive = drive
        self.labelling = labelling
        self._cameras = {camera.id: camera for camera in cameras_of(session, [drive.id])[drive.id]}

    def identities(self, identity_ids: Iterable[int]) -> list[IdentityRow]:
        """The identities, each once, in the order named; NotFound."""
        ids = list(dict.fromkeys(identity_ids))
        found = {row.identity_id: row for row in identities_repository.find(self._session, self.labelling.id, ids)}
        gone = [str(one) for one in ids if one not in found]
        if gone:
            raise NotFound(
                f"There is no object {', '.join(gone)} any more: it was joined with another one, or deleted. Look "
                "again."
            )
        return [found[one] for one in ids]

    def tracks(self, track_ids: Iterable[int]) -> list[TrackRow]:
        """The tracks, each once, in order of id; NotFound."""
        ids = set(track_ids)
        found = tracks_repository.tracks_with(self._session, self.labelling.id, ids)
        gone = sorted(ids - {track.track_id for track in found})
        if gone:
            raise NotFound(f"There is no track {', '.join(map(str, gone))} any more. Look again.")
        return found

    def tracks_of(self, identity_ids: Iterable[int]) -> list[TrackRow]:
        """All tracks of some identities, in order of id."""
        return list(tracks_repository.tracks_of_identities(self._session, self.labelling.id, identity_ids))

    def best_place(self, identity_id: int) -> Place:
        """The best observation of an identity: the one that another labelling most likely has too."""
        (identity,) = self.identities([identity_id])
        (track,) = self.tracks([identity.donor_track_id])
        return Place(track.tracked_id, identity.donor_frame_index)

    def camera_of(self, track: TrackRow) -> str:
        return self._cameras[track.camera_id].name

    def camera(self, name: str) -> CameraRow:
        """The camera of that name; NotFound."""
        for camera in self._cameras.values():
            if camera.name == name:
                return camera
        raise NotFound(f"Drive {self.drive.name} has no camera {name}.")

    def require_class(self, class_name: str) -> None:
        """InvalidRequest where the labels have no such class."""
        if class_name not in self.labelling.class_names:
            raise InvalidRequest(
                f"There is no class {class_name}. The model has: {', '.join(self.labelling.class_names)}."
            )

    def require_box(self, track: TrackRow, frame_index: int) -> None:
        """NotFound where a track has no box in a frame."""
        if not self.has_box(track, frame_index):
            raise NotFound(f"Track {track.track_id} has no box in frame {frame_index} any more. Look again.")

    def has_box(self, track: TrackRow, frame_index: int) -> bool:
        """Whether a track has a box in a frame."""
        boxes = track_repository.boxes_of(self._session, self.labelling.id, track.tracked_id)
        return any(box.frame_index == frame_index and box.track_id == track.track_id for box in boxes)
