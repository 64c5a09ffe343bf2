"""Tracks to identities by all evidence at once.

One pass over the frames fills what is kept of tracks and pairs; then candidates are measured, each gets its
probability, and the groups are chosen together (:mod:`labeler.identity.assignment`). Memory grows with tracks and
pairs of tracks, not with frames.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import expit, logit

from labeler.identity.assignment import Forbidden, Tie, assign, connected_parts
from labeler.identity.calibration import Calibration, shipped_calibration
from labeler.identity.config import IdentityConfig
from labeler.identity.constraints import AnchorFinder, Constraints, Decisions, merge_anchors
from labeler.identity.explain import Explainer
from labeler.identity.features import FEATURES, Candidate, gap_candidates, overlap_candidates
from labeler.identity.linking import SharedFrames
from labeler.identity.places import places_of
from labeler.identity.rig import Rig
from labeler.identity.together import PairBook
from labeler.identity.tracks import TrackBook
from labeler.identity.types import Feature, MergeKind, MergeProposal, Merges, MergeState, MultiCameraFrame

_MIN_APART_FRAMES = 3


@dataclass(frozen=True, eq=False)
class Gathered:
    """What one pass over the frames leaves: tracks, pairs, which share a frame, and a person's decisions."""

    tracks: TrackBook
    pairs: PairBook
    shared_frames: SharedFrames
    camera_names: tuple[str, ...]
    constraints: Constraints
    rig: Rig

    def candidates(self, config: IdentityConfig) -> list[Candidate]:
        """The pairs worth a decision; those across time only where it is known where the car was."""
        found = overlap_candidates(self.pairs, self.tracks, self.rig)
        if self.rig.city_SE3_ego is None:
            return found
        return found + gap_candidates(
            self.tracks, self.rig, config,
            camera_names=self.camera_names, impossible=self._seen_together, exclude=self._told_apart,
        )  # fmt: skip

    def _seen_together(self, track_a: int, track_b: int) -> bool:
        key = (min(track_a, track_b), max(track_a, track_b))
        return self.shared_frames(*key) or key in self.pairs.near or key in self.pairs.far_frames

    def _told_apart(self, track_a: int, track_b: int) -> bool:
        """Whether two tracks are two objects, by the frames in which both were seen."""
        return self.shared_frames(track_a, track_b) or self.pairs.mostly_apart(track_a, track_b)


@dataclass(frozen=True, eq=False)
class Weighed:
    """A candidate with its log odds, and what each feature adds to them (K,)."""

    candidate: Candidate
    log_odds: float
    parts: NDArray[np.float64]
    bias: float

    @property
    def pair(self) -> tuple[int, int]:
        return self.candidate.track_a, self.candidate.track_b

    @property
    def probability(self) -> float:
        return float(expit(self.log_odds))

    def features(self) -> tuple[Feature, ...]:
        """What was measured; features that could not be are left out."""
        named = zip(FEATURES[self.candidate.kind], self.candidate.values.tolist(), self.parts.tolist(), strict=True)
        return tuple(
            Feature(name, round(value, 4), unit, round(log_odds, 4))
            for (name, unit), value, log_odds in named
            if np.isfinite(value)
        )


def merge_by_assignment(
    frames: Iterable[MultiCameraFrame],
    config: IdentityConfig,
    *,
    class_groups: Sequence[int],
    rig: Rig,
    colours: Mapping[int, NDArray[np.float32]] | None = None,
    decisions: Decisions | None = None,
    calibration: Calibration | None = None,
) -> Merges:
    """Merge the tracks of a drive. ``frames`` are read once, in order of time, and not kept.

    ``class_groups[class_id]`` is a number; only tracks of one number are merged. Raises ValueError when an observation
    has a class without a number.
    """
    gathered = gather(frames, config, class_groups=class_groups, rig=rig, colours=colours, decisions=decisions)
    weighed = weigh(gathered.candidates(config), calibration or shipped_calibration())
    return _decide(gathered, weighed, config)


def gather(
    frames: Iterable[MultiCameraFrame],
    config: IdentityConfig,
    *,
    class_groups: Sequence[int],
    rig: Rig,
    colours: Mapping[int, NDArray[np.float32]] | None = None,
    decisions: Decisions | None = None,
) -> Gathered:
    """One pass over the frames. ``colours`` are the histograms of tracks, as far as they are known."""
    decisions = decisions or Decisions()
    numbers: dict[str, int] = {}
    tracks = TrackBook(config.motion)
    pairs = PairBook(rig.cameras, numbers, best_frames=config.best_frames)
    shared, finder = SharedFrames(), AnchorFinder(merge_anchors(decisions))
    groups = np.asarray(class_groups, np.int64)
    for frame in frames:
        places = places_of(frame, rig, numbers, groups)
        pose = np.eye(4) if rig.city_SE3_ego is None else rig.city_SE3_ego[frame.frame_index]
        tracks.add(places, rig.seconds(frame.frame_index), pose)
        pairs.add(places)
        for camera, view in frame.views.items():
            shared.add(camera, view.observations.track_id.tolist())
            finder.add(camera, frame.frame_index, view.observations)
    tracks.close(colours or {})
    return Gathered(tracks, pairs, shared, tuple(numbers), Constraints.of(decisions, finder), rig)


def weigh(candidates: Sequence[Candidate], calibration: Calibration) -> list[Weighed]:
    """The candidates with their log odds, the most probable first."""
    weighed: list[Weighed] = []
    for kind in MergeKind:
        of_kind = [candidate for candidate in candidates if candidate.kind is kind]
        if of_kind:
            log_odds, parts = calibration.log_odds(kind, np.stack([candidate.values for candidate in of_kind]))
            bias = calibration.kinds[kind].bias
            weighed += [
                Weighed(candidate, float(log_odds[row]), parts[row], bias) for row, candidate in enumerate(of_kind)
            ]
    return sorted(weighed, key=lambda one: (-one.log_odds, one.pair))


def _decide(gathered: Gathered, weighed: Sequence[Weighed], config: IdentityConfig) -> Merges:
    forbidden = _forbidden(gathered)
    ties = [Tie(*one.pair, one.log_odds) for one in weighed]
    constraints = gathered.constraints
    group_of = assign(
        gathered.tracks.records,
        ties,
        forbidden,
        must_link=constraints.same,
        join_log_odds=float(logit(config.accept_probability)),
    )
    holding = [one.pair for one in weighed if one.probability >= config.propose_probability]
    identity_of = connected_parts(group_of, [*constraints.same, *holding])
    decided = {*constraints.same, *constraints.different}
    members: dict[int, list[int]] = {}
    for track, identity in identity_of.items():
        members.setdefault(identity, []).append(track)
    explainer = Explainer(gathered.tracks, gathered.camera_names, gathered.rig)
    proposals: list[MergeProposal] = []
    for one in weighed:
        if one.probability < config.propose_probability:
            break
        if one.pair in decided:
            state, blocked_by = _own_word(one, config)
        else:
            a, b = (identity_of[track] for track in one.pair)
            state, blocked_by = _state(members[a], members[b], forbidden)
        proposals.append(
            explainer.proposal(
                one.candidate,
                score=one.probability,
                state=state,
                features=one.features(),
                bias=one.bias,
                blocked_by=blocked_by,
            )
        )
    return Merges(tuple(proposals), identity_of)


def _own_word(one: Weighed, config: IdentityConfig) -> tuple[MergeState, None]:
    """What the machine alone says of a pair that a person decided about: the decision may be taken back."""
    return MergeState.ACCEPTED if one.probability >= config.accept_probability else MergeState.PROPOSED, None


def _state(
    members_a: Sequence[int], members_b: Sequence[int], forbidden: Forbidden
) -> tuple[MergeState, tuple[int, int] | None]:
    """What becomes of a pair whose tracks are in identities of these tracks, and which tracks forbid it where it is
    rejected."""
    if members_a == members_b:
        return MergeState.ACCEPTED, None
    for a in members_a:
        for b in members_b:
            if forbidden(a, b):
                return MergeState.REJECTED, (a, b)
    return MergeState.PROPOSED, None


def _forbidden(gathered: Gathered) -> Forbidden:
    """Tracks of one camera that share a frame, tracks that were surely at different places at one time, and those that
    a person told apart."""
    forbidden = Forbidden()
    for pair in gathered.shared_frames.pairs():
        forbidden.add(*pair)
    together = set(gathered.constraints.same)
    for pair, frames in gathered.pairs.far_frames.items():
        if frames >= _MIN_APART_FRAMES and gathered.pairs.mostly_apart(*pair) and pair not in together:
            forbidden.add(*pair)
    for pair in gathered.constraints.different:
        forbidden.add(*pair)
    return forbidden
