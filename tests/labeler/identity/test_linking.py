from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from labeler.identity import CannotLinkError, IdentityGraph, SharedFrames, components

# Tracks 1 and 2 stand in one frame of the front camera; so do 5 and 6 in the left one.
CAMERAS = {1: "front", 2: "front", 3: "front", 5: "left", 6: "left", 9: "rear"}
SHARING = {(1, 2), (5, 6)}


def graph() -> IdentityGraph:
    return IdentityGraph(CAMERAS, lambda a, b: (min(a, b), max(a, b)) in SHARING)


def test_an_identity_is_named_after_its_smallest_track():
    merged = graph()
    assert merged.join(9, 5) == 5
    assert merged.join(5, 3) == 3
    assert merged.members(9) == (3, 5, 9)
    assert merged.identities() == {1: 1, 2: 2, 3: 3, 5: 3, 6: 6, 9: 3}


@pytest.mark.parametrize(
    ("before", "merge", "conflict"),
    [
        ([], (1, 2), (1, 2)),  # two tracks of one frame
        ([], (1, 3), None),  # one camera, but never in one frame: a track that was lost and found again
        ([], (1, 5), None),  # two cameras
        ([(1, 5)], (2, 5), (2, 1)),  # 5 is already the same as 1, which stands beside 2
        ([(1, 9), (2, 5)], (5, 9), (2, 1)),  # by way of both sides; the first named belongs to the first asked for
        ([(1, 9), (9, 5)], (1, 5), None),  # they are one identity already
    ],
)
def test_conflict_names_the_tracks_that_forbid_a_merge(
    before: list[tuple[int, int]], merge: tuple[int, int], conflict: tuple[int, int] | None
):
    merged = graph()
    for pair in before:
        merged.join(*pair)
    assert merged.conflict(*merge) == conflict


def test_a_forbidden_merge_is_refused_and_changes_nothing():
    merged = graph()
    merged.join(1, 5)
    with pytest.raises(CannotLinkError, match="tracks 2 and 1 stand in the same frame of camera front") as caught:
        merged.join(2, 5)
    assert (caught.value.track_a, caught.value.track_b, caught.value.camera) == (2, 1, "front")
    assert merged.identity_of(2) == 2


def test_components_join_pairs_without_a_rule():
    assert components([1, 2, 3, 4], [(4, 2), (2, 3)]) == {1: 1, 2: 2, 3: 2, 4: 2}


def test_shared_frames_knows_tracks_that_interleave_with_gaps():
    shared = SharedFrames()
    for tracks in ([1, 2], [1], [1, 3], [2], [3]):
        shared.add("front", tracks)
    assert shared(1, 2)
    assert shared(3, 1)
    assert not shared(2, 3)  # their spans of frames overlap, but no frame holds both


@given(
    cameras=st.lists(st.sampled_from("abc"), min_size=2, max_size=12),
    frames=st.lists(st.sets(st.integers(0, 11), max_size=6), max_size=10),
    merges=st.lists(st.tuples(st.integers(0, 11), st.integers(0, 11)), max_size=30),
)
def test_no_identity_ever_holds_two_tracks_of_one_frame_of_one_camera(
    cameras: list[str], frames: list[set[int]], merges: list[tuple[int, int]]
):
    of_track = dict(enumerate(cameras))
    shared, truly_shared = SharedFrames(), set[tuple[int, int]]()
    for frame in frames:
        for camera in "abc":
            present = sorted(track for track in frame if of_track.get(track) == camera)
            shared.add(camera, present)
            truly_shared.update(combinations(present, 2))
    merged = IdentityGraph(of_track, shared)
    for a, b in merges:
        if a in of_track and b in of_track:
            forbidden = merged.conflict(a, b)
            if forbidden is None:
                assert merged.join(a, b) == merged.identity_of(a) == merged.identity_of(b)
            else:
                assert tuple(sorted(forbidden)) in truly_shared
    identities = merged.identities()
    assert not [pair for pair in truly_shared if identities[pair[0]] == identities[pair[1]]]
    assert all(identities[track] == min(merged.members(track)) for track in of_track)
