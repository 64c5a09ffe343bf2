"""Facts about the identities of a drive, for the page."""

import math
from dataclasses import asdict

from app.db.session import Session
from app.drives.service import require_drive
from app.motion import repository
from app.motion.facts import FactsCache
from app.motion.schemas import FailedCheck, IdentityFacts, ObservationDistance
from app.tracks import repository as tracks_repository


def list_facts(session: Session, cache: FactsCache, drive_id: int) -> list[IdentityFacts]:
    """Facts of every identity in order of id; none before the drive is labelled."""
    require_drive(session, drive_id)
    labelling = tracks_repository.current_labelling(session, drive_id)
    if labelling is None:
        return []
    return [
        IdentityFacts(
            identity_id=identity_id,
            nearest_m=facts.nearest_m,
            farthest_m=facts.farthest_m,
            purity=facts.purity,
            failed=[FailedCheck(**asdict(failure)) for failure in facts.failed],
        )
        for identity_id, facts in sorted(cache.facts_of(session, labelling).items())
    ]


def list_distances(session: Session, drive_id: int, observation_ids: list[int]) -> list[ObservationDistance]:
    """Distances from the car, of those observations that the drive's labels have."""
    require_drive(session, drive_id)
    labelling = tracks_repository.current_labelling(session, drive_id)
    if labelling is None:
        return []
    return [
        ObservationDistance(observation_id=row.observation_id, distance_m=_distance_m(row.x_m, row.y_m))
        for row in repository.places_of_observations(session, labelling.id, observation_ids)
    ]


def _distance_m(x_m: float | None, y_m: float | None) -> float | None:
    return None if x_m is None or y_m is None else round(math.hypot(x_m, y_m), 1)
