"""The values of :class:`app.merges.schemas.Merge`, plain: there are thousands, and models take most of the time."""

from collections.abc import Mapping
from typing import Any

from app.merges.impact import Impact
from app.merges.models import MergeRow
from app.merges.priority import priority
from app.merges.repository import StoredMerge


def merge_values(row: MergeRow | StoredMerge, impact: Impact, camera_of: Mapping[int, str]) -> dict[str, Any]:
    """``camera_of`` gives the names of the tracks' cameras; ``impact`` knows all tracks of their identities."""
    label_count = impact.label_count(row)
    track_a, track_b = row.tracks
    evidence = {name: value for name, value in row.evidence.items() if name != "plot"}
    return {
        "id": row.id,
        "track_a": track_a,
        "track_b": track_b,
        "camera_a": camera_of[track_a],
        "camera_b": camera_of[track_b],
        "score": row.score,
        "probability": row.score if evidence.get("calibrated") else None,
        "state": row.state,
        "decided_by": row.decided_by,
        "shared_frames": row.shared_frames,
        "agreeing_frames": row.agreeing_frames,
        "mean_distance_m": row.mean_distance_m,
        "mean_bev_iou": row.mean_bev_iou,
        "reason": row.reason,
        "best_frames": row.best_frames,
        "evidence": evidence or None,
        "label_count": label_count,
        "priority": priority(label_count, row.score),
        "identity_a": impact.identity_of(track_a),
        "identity_b": impact.identity_of(track_b),
    }
