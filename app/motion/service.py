"""Facts about the identities of a drive, for the page."""

from dataclasses import asdict

from app.db.session import Session
from app.drives.service import require_drive
from app.motion.facts import FactsCache
from app.motion.schemas import FailedCheck, IdentityFacts
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
            failed=[FailedCheck(**asdict(failure)) for failure in facts.failed],
        )
        for identity_id, facts in sorted(cache.facts_of(session, labelling).items())
    ]
