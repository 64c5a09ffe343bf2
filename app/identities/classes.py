"""Classes that people gave to objects: two objects of different ones are not made one without saying which is right."""

from collections.abc import Iterable

from app.db.session import Session
from app.errors import ClassesDiffer
from app.identities import repository
from app.tracks import repository as tracks_repository


def require_one_class(session: Session, labelling_id: int, track_ids: Iterable[int]) -> None:
    """ClassesDiffer where people gave different classes to the identities of some tracks."""
    tracks = tracks_repository.tracks_with(session, labelling_id, track_ids)
    identities = repository.find(session, labelling_id, {track.identity_id for track in tracks})
    given = [row for row in identities if row.class_by_person]
    if len({row.class_id for row in given}) < 2:
        return
    names = tracks_repository.find_labelling(session, labelling_id).class_names
    said = " and ".join(f"object {row.identity_id} is {names[row.class_id]}" for row in given)
    raise ClassesDiffer(f"People said that {said}, so they can't be one object. Give both the same class first.")
