"""Which tracks form an identity, decided over all pairs at once: correlation clustering under the cannot-link rule.

Every pair has log odds of being one object. Wanted are groups of tracks that are tied well inside, and in which no two
tracks are forbidden to be one. Greedy edge contraction finds good ones: the two groups that are tied most are joined,
the ties of the joined group are put together, and so on. How much two groups are tied is the best log odds between
their tracks, and all that speaks against it: pairs that look alike for one reason (parked cars in a row) do not add up
to a proof, but each pair that can't be is an objection. Then single tracks move to another group, or out of theirs,
where they are tied more.

Source: Keuper et al., Efficient decomposition of image and mesh graphs by lifted multicuts, ICCV 2015 (GAEC); the time
is O(E log E) for E pairs, and the moves are bounded.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

_MOVE_ROUNDS = 4
_MIN_GAIN = 1e-9


@dataclass(frozen=True)
class Tie:
    """Log odds that two tracks are one object."""

    track_a: int
    track_b: int
    log_odds: float


@dataclass(frozen=True)
class Strength:
    """How two groups are tied: the best log odds above 0, and the sum of those below."""

    best: float = 0.0
    against: float = 0.0

    @property
    def total(self) -> float:
        return self.best + self.against

    def and_also(self, other: Strength) -> Strength:
        """Both together."""
        return Strength(max(self.best, other.best), self.against + other.against)

    @staticmethod
    def of(log_odds: float) -> Strength:
        return Strength(max(log_odds, 0.0), min(log_odds, 0.0))


class Forbidden:
    """Which tracks can never be one object; symmetric."""

    def __init__(self) -> None:
        self._of: dict[int, set[int]] = {}

    def add(self, track_a: int, track_b: int) -> None:
        self._of.setdefault(track_a, set()).add(track_b)
        self._of.setdefault(track_b, set()).add(track_a)

    def __call__(self, track_a: int, track_b: int) -> bool:
        return track_b in self._of.get(track_a, ())

    def of(self, track: int) -> set[int]:
        """All tracks that can't be one with this one."""
        return self._of.get(track, set())


def assign(
    tracks: Iterable[int],
    ties: Sequence[Tie],
    forbidden: Forbidden,
    *,
    must_link: Sequence[tuple[int, int]] = (),
    join_log_odds: float,
) -> dict[int, int]:
    """The smallest track of the group of each track.

    Groups are joined while they are tied by at least ``join_log_odds``. ``must_link`` pairs are
    joined before all else, unless they are forbidden. Ties of the same strength go by the tracks' numbers.
    """
    groups = _Groups(sorted(tracks), ties, forbidden)
    for track_a, track_b in must_link:
        groups.join_if_allowed(track_a, track_b)
    groups.contract(join_log_odds)
    fixed = {track for pair in must_link for track in pair}
    return _moved(groups.group_of(), ties, forbidden, fixed, join_log_odds)


class _Groups:
    """Groups by their smallest track, and how they are tied."""

    def __init__(self, tracks: Sequence[int], ties: Sequence[Tie], forbidden: Forbidden) -> None:
        self._members = {track: {track} for track in tracks}
        self._banned = {track: set(forbidden.of(track)) for track in tracks}
        self._ties: dict[int, dict[int, Strength]] = {track: {} for track in tracks}
        self._root = {track: track for track in tracks}
        for tie in ties:
            for a, b in ((tie.track_a, tie.track_b), (tie.track_b, tie.track_a)):
                self._ties[a][b] = self._ties[a].get(b, Strength()).and_also(Strength.of(tie.log_odds))

    def group_of(self) -> dict[int, int]:
        return {track: group for group, members in self._members.items() for track in members}

    def join_if_allowed(self, track_a: int, track_b: int) -> None:
        a, b = self._root[track_a], self._root[track_b]
        if a != b and self._allowed(a, b):
            self._join(min(a, b), max(a, b))

    def contract(self, join_log_odds: float) -> None:
        """Join the pair of groups that are tied most, again and again."""
        heap = [
            (-strength.total, a, b)
            for a, ties in self._ties.items()
            for b, strength in ties.items()
            if a < b and strength.total >= join_log_odds
        ]
        heapq.heapify(heap)
        while heap:
            total, a, b = heapq.heappop(heap)
            strength = self._ties.get(a, {}).get(b)
            if strength is None or strength.total != -total or not self._allowed(a, b):
                continue  # one of them has changed since, or they must stay apart
            self._join(a, b)
            for other, new in self._ties[a].items():
                if new.total >= join_log_odds:
                    heapq.heappush(heap, (-new.total, min(a, other), max(a, other)))

    def _allowed(self, a: int, b: int) -> bool:
        small, large = (a, b) if len(self._members[a]) <= len(self._members[b]) else (b, a)
        return self._banned[large].isdisjoint(self._members[small])

    def _join(self, kept: int, gone: int) -> None:
        moved = self._members.pop(gone)
        self._members[kept] |= moved
        self._banned[kept] |= self._banned.pop(gone)
        for track in moved:
            self._root[track] = kept
        for other, strength in self._ties.pop(gone).items():
            del self._ties[other][gone]
            if other != kept:
                new = self._ties[kept].get(other, Strength()).and_also(strength)
                self._ties[kept][other] = self._ties[other][kept] = new


def _moved(
    group_of: dict[int, int],
    ties: Sequence[Tie],
    forbidden: Forbidden,
    fixed: set[int],
    join_log_odds: float,
) -> dict[int, int]:
    """Single tracks moved to where they fit better; groups named by their smallest track."""
    neighbours: dict[int, list[tuple[int, float]]] = {}
    for tie in ties:
        neighbours.setdefault(tie.track_a, []).append((tie.track_b, tie.log_odds))
        neighbours.setdefault(tie.track_b, []).append((tie.track_a, tie.log_odds))
    members: dict[int, set[int]] = {}
    for track, group in group_of.items():
        members.setdefault(group, set()).add(track)
    spare = max(group_of, default=0) + 1
    for _ in range(_MOVE_ROUNDS):
        changed = False
        for track in sorted(neighbours):
            if track in fixed:
                continue
            own = group_of[track]
            strengths: dict[int, Strength] = {}
            for other, log_odds in neighbours[track]:
                group = group_of[other]
                strengths[group] = strengths.get(group, Strength()).and_also(Strength.of(log_odds))
            pull = {group: strength.total for group, strength in strengths.items()}
            best, gain = own, _MIN_GAIN
            stay = pull.pop(own, 0.0)
            if len(members[own]) > 1 and -stay > gain:
                best, gain = spare, -stay
            for group, total in sorted(pull.items()):
                if total >= join_log_odds and total - stay > gain and members[group].isdisjoint(forbidden.of(track)):
                    best, gain = group, total - stay
            if best != own:
                members[own].discard(track)
                members.setdefault(best, set()).add(track)
                group_of[track] = best
                spare += best == spare
                changed = True
        if not changed:
            break
    return {track: min(group) for group in members.values() for track in group}


def connected_parts(group_of: Mapping[int, int], links: Iterable[tuple[int, int]]) -> dict[int, int]:
    """Groups, split where ``links`` inside of them don't hold them together: the smallest track of each part."""
    root = {track: track for track in group_of}

    def find(track: int) -> int:
        while root[track] != track:
            root[track] = root[root[track]]
            track = root[track]
        return track

    for a, b in links:
        if group_of[a] == group_of[b]:
            first, second = sorted((find(a), find(b)))
            root[second] = first
    return {track: find(track) for track in group_of}
