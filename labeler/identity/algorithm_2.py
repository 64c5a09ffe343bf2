"""The baseline, the paper's Algorithm 2: tracks whose 3D boxes are at the same place are merged, the best first.

The score of a merge is how similar the boxes of two tracks are where they are at the same place, times the share of the
frames with boxes of both in which they are, times how much so many frames can be trusted.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from labeler.identity.config import Algorithm2Config
from labeler.identity.linking import IdentityGraph
from labeler.identity.same_place import Evidence, PairEvidence
from labeler.identity.types import MergeEvidence, MergeKind, MergeProposal, Merges, MergeState, MultiCameraFrame

_FRAMES_HALF_SURE = 0.25


@dataclass(frozen=True)
class _Candidate:
    track_a: int
    track_b: int
    score: float
    shared_frames: int
    evidence: PairEvidence


def merge_at_same_place(
    frames: Iterable[MultiCameraFrame], config: Algorithm2Config, *, class_groups: Sequence[int]
) -> Merges:
    """Compare the 3D boxes of all pairs of cameras frame by frame, and decide which tracks are one object.

    ``frames`` are read once, in order of time, and not kept. ``class_groups[class_id]`` is a number; only tracks of
    one number are merged. Raises ValueError when an observation has a class without a number.

    Source: the paper's Algorithm 2, with a score and a rule where it has an equality.
    """
    evidence = Evidence(config, class_groups)
    for frame in frames:
        evidence.add(frame)
    return decide_merges(evidence, config)


def decide_merges(evidence: Evidence, config: Algorithm2Config) -> Merges:
    """Merges of tracks of one class group, best first: made, proposed to a person, or rejected by a better one."""
    graph = IdentityGraph(evidence.cameras, evidence.shared_frames)
    made: list[MergeProposal] = []
    proposals: list[MergeProposal] = []
    for candidate in _candidates(evidence, config):
        proposal = _decide(candidate, evidence, graph, made, config)
        proposals.append(proposal)
        if proposal.state is MergeState.ACCEPTED:
            graph.join(proposal.track_a, proposal.track_b)
            made.append(proposal)
    return Merges(tuple(proposals), graph.identities())


def _candidates(evidence: Evidence, config: Algorithm2Config) -> list[_Candidate]:
    """The pairs worth a decision, by descending score."""
    candidates: list[_Candidate] = []
    for (track_a, track_b), pair in evidence.pairs.items():
        if evidence.group_of(track_a) != evidence.group_of(track_b):
            continue
        shared = evidence.frames_with_both(track_a, track_b)
        trust = shared / (shared + _FRAMES_HALF_SURE)
        score = pair.similarity_sum / shared * trust
        if score >= config.propose_score:
            candidates.append(_Candidate(track_a, track_b, score, shared, pair))
    return sorted(candidates, key=lambda candidate: (-candidate.score, candidate.track_a, candidate.track_b))


def _decide(
    candidate: _Candidate,
    evidence: Evidence,
    graph: IdentityGraph,
    made: list[MergeProposal],
    config: Algorithm2Config,
) -> MergeProposal:
    pair, track_a, track_b = candidate.evidence, candidate.track_a, candidate.track_b
    seen = f"boxes at the same place in {pair.agreeing_frames} of {candidate.shared_frames} shared frames"
    forbidden = graph.conflict(track_a, track_b)
    if forbidden is not None:
        state = MergeState.REJECTED
        reason = f"{seen}, but {_why_forbidden(forbidden, candidate, evidence, made)}"
    elif candidate.score >= config.accept_score and pair.agreeing_frames >= config.min_agreeing_frames:
        state, reason = MergeState.ACCEPTED, seen
    else:
        state, reason = MergeState.PROPOSED, f"{seen}; too unsure to merge without a person"
    return MergeProposal(
        track_a=track_a,
        camera_a=evidence.cameras[track_a],
        track_b=track_b,
        camera_b=evidence.cameras[track_b],
        score=candidate.score,
        state=state,
        shared_frames=candidate.shared_frames,
        agreeing_frames=pair.agreeing_frames,
        mean_distance_m=pair.distance_sum_m / pair.agreeing_frames,
        mean_bev_iou=pair.bev_iou_sum / pair.agreeing_frames,
        best_frames=tuple(frame for _, frame in pair.best),
        reason=reason,
        evidence=MergeEvidence(MergeKind.OVERLAP, calibrated=False),
    )


def _why_forbidden(
    forbidden: tuple[int, int], candidate: _Candidate, evidence: Evidence, made: list[MergeProposal]
) -> str:
    """Which tracks forbid a merge, and the better merges that tie them to the tracks that were to be merged."""
    first, second = forbidden
    clash = f"tracks {first} and {second} share a frame of {evidence.cameras[first]}"
    ties = [*_ties(candidate.track_a, first, made), *_ties(candidate.track_b, second, made)]
    better = [f"{merge.track_a} with {merge.track_b} (score {merge.score:.2f})" for merge in ties]
    return f"{clash}; better merges came first: {', '.join(better)}" if better else clash


def _ties(track: int, other: int, made: list[MergeProposal]) -> list[MergeProposal]:
    """The fewest merges that lead from one track to another of the same identity."""
    way_to: dict[int, list[MergeProposal]] = {track: []}
    reached = [track]
    for here in reached:  # grows while it is walked along
        if here == other:
            break
        for merge in made:
            for end, next_end in ((merge.track_a, merge.track_b), (merge.track_b, merge.track_a)):
                if end == here and next_end not in way_to:
                    way_to[next_end] = [*way_to[here], merge]
                    reached.append(next_end)
    return way_to[other]
