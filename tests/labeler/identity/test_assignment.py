import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from labeler.identity.assignment import Forbidden, Tie, assign, connected_parts


def forbid(*pairs: tuple[int, int]) -> Forbidden:
    forbidden = Forbidden()
    for pair in pairs:
        forbidden.add(*pair)
    return forbidden


@pytest.mark.parametrize(
    ("ties", "apart", "must_link", "expected"),
    [
        ([(1, 2, 3.0)], [], [], {1: 1, 2: 1, 3: 3}),  # strong enough
        ([(1, 2, 1.9)], [], [], {1: 1, 2: 2, 3: 3}),  # too weak to join without a person
        ([(1, 2, 3.0)], [(1, 2)], [], {1: 1, 2: 2, 3: 3}),  # forbidden, however strong
        # 1-2 and 2-3 look good, but 1-3 can't be: the stronger one holds.
        ([(1, 2, 3.0), (2, 3, 4.0)], [(1, 3)], [], {1: 1, 2: 2, 3: 2}),
        # Two weak ties to a group do not add up to a strong one.
        ([(1, 2, 5.0), (1, 3, 1.2), (2, 3, 1.2)], [], [], {1: 1, 2: 1, 3: 3}),
        # One strong tie to a group is enough, if nothing speaks against it.
        ([(1, 2, 5.0), (1, 3, 2.5), (2, 3, 0.5)], [], [], {1: 1, 2: 1, 3: 1}),
        # A good tie is outweighed by what speaks against it: 3 - 4 < 2.
        ([(1, 2, 5.0), (1, 3, 3.0), (2, 3, -4.0)], [], [], {1: 1, 2: 1, 3: 3}),
        ([], [], [(2, 3)], {1: 1, 2: 2, 3: 2}),  # a person's word needs no tie
        ([(1, 2, -9.0)], [], [(1, 2)], {1: 1, 2: 1, 3: 3}),  # and wins over the machine's
        ([], [(2, 3)], [(2, 3)], {1: 1, 2: 2, 3: 3}),  # but not over two tracks in one image
    ],
)
def test_groups(
    ties: list[tuple[int, int, float]],
    apart: list[tuple[int, int]],
    must_link: list[tuple[int, int]],
    expected: dict[int, int],
):
    found = assign([1, 2, 3], [Tie(*tie) for tie in ties], forbid(*apart), must_link=must_link, join_log_odds=2.0)
    assert found == expected


def test_a_track_moves_to_the_group_where_it_fits_better():
    # 1-2 are joined first (4.0), then 3 to them (3.9 - 1.5). Now 2 is tied to its group by 4.0 - 1.5, and to 4, which
    # can't be one with 1, by 3.0: it goes there.
    ties = [Tie(1, 2, 4.0), Tie(1, 3, 3.9), Tie(2, 3, -1.5), Tie(2, 4, 3.0)]
    assert assign([1, 2, 3, 4], ties, forbid((1, 4)), join_log_odds=2.0) == {1: 1, 3: 1, 2: 2, 4: 2}


def test_groups_that_no_link_holds_together_are_split():
    assert connected_parts({1: 1, 2: 1, 3: 1, 4: 4}, [(1, 3), (3, 4)]) == {1: 1, 2: 2, 3: 1, 4: 4}


@given(
    ties=st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9), st.floats(-5, 5)), max_size=40),
    apart=st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), max_size=15),
)
def test_no_group_holds_two_that_are_forbidden(ties: list[tuple[int, int, float]], apart: list[tuple[int, int]]):
    pairs = {(min(a, b), max(a, b)): odds for a, b, odds in ties if a != b}
    forbidden = forbid(*[(a, b) for a, b in apart if a != b])
    found = assign(range(10), [Tie(a, b, odds) for (a, b), odds in pairs.items()], forbidden, join_log_odds=math.log(9))
    assert not [(a, b) for a, b in apart if a != b and found[a] == found[b]]
    assert all(found[group] == group <= track for track, group in found.items())
