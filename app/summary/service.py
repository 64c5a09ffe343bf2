"""A drive's labels in numbers."""

from collections import Counter

from app.db.session import Session
from app.drives.service import require_drive
from app.summary import repository
from app.summary.schemas import LabelHistogram
from app.tracks import repository as tracks_repository
from app.tracks.schemas import LabelSource

DISTANCE_EDGES_M = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0)
SOURCES = [source.value for source in LabelSource]


def histogram(session: Session, drive_id: int) -> LabelHistogram:
    """Labels of a drive by class, source, score and distance; empty before it is labelled."""
    drive = require_drive(session, drive_id)
    labelling = tracks_repository.current_labelling(session, drive_id)
    labels: Counter[tuple[int, int, int | None, int | None]] = Counter()
    own: Counter[tuple[int, int | None]] = Counter()
    if labelling is not None:
        for row in repository.count_labels(session, labelling.id, DISTANCE_EDGES_M):
            source = SOURCES.index(row.source)
            labels[row.class_id, source, row.score_bin, row.distance_bin] += row.labels
            own[source, row.own_score_bin] += row.labels
    places, own_places = list(labels), list(own)
    return LabelHistogram(
        class_names=labelling.class_names if labelling else [],
        distance_edges_m=list(DISTANCE_EDGES_M),
        sources=SOURCES,
        class_id=[place[0] for place in places],
        source=[place[1] for place in places],
        score_bin=[place[2] for place in places],
        distance_bin=[place[3] for place in places],
        count=list(labels.values()),
        own_source=[place[0] for place in own_places],
        own_score_bin=[place[1] for place in own_places],
        own_count=list(own.values()),
        revision=drive.revision,
    )
