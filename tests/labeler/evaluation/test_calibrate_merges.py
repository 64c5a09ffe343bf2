"""The curves find again what made the pairs, and the table counts what came true."""

from pathlib import Path

import numpy as np
from scipy.special import expit

from labeler.drive import open_truth
from labeler.evaluation.benchmark_merges import track_scene
from labeler.evaluation.calibrate_merges import Sample, fit, reliability, samples_of
from labeler.evaluation.made_observations import Noise, scene_of
from labeler.evaluation.owned_tracks import OwnedTracks, of_scene
from labeler.identity.calibration import Calibration
from labeler.identity.features import FEATURES
from labeler.identity.types import MergeKind
from labeler.tracking import TrackingConfig

SAMPLE = Path(__file__).parents[3] / "labeler" / "simulation" / "sample" / "turn-at-a-crossing"
DISTANCE = [name for name, _ in FEATURES[MergeKind.OVERLAP]].index("distance_m")


def made_up(count: int, log_odds_of_distance: float, seed: int = 0) -> dict[MergeKind, Sample]:
    """Pairs of which only the distance tells whether they are one: 2 + ``log_odds_of_distance`` x metres."""
    rng = np.random.default_rng(seed)
    samples: dict[MergeKind, Sample] = {}
    for kind, names in FEATURES.items():
        values = rng.uniform(0, 1, (count, len(names)))
        values[:, DISTANCE] = rng.uniform(0, 4, count)
        chance = expit(2 + log_odds_of_distance * values[:, DISTANCE])
        samples[kind] = Sample(values, rng.random(count) < chance)
    return samples


def test_the_fitted_probability_is_the_one_that_made_the_pairs() -> None:
    calibration = fit(made_up(6000, -2.0))

    fresh = made_up(6000, -2.0, seed=1)[MergeKind.OVERLAP]
    told = expit(calibration.log_odds(MergeKind.OVERLAP, fresh.values)[0])
    true = expit(2 - 2.0 * fresh.values[:, DISTANCE])
    assert np.abs(told - true).mean() < 0.04


def test_farther_apart_never_speaks_for_one_object_whatever_the_pairs_say() -> None:
    calibration = fit(made_up(2000, +1.0))

    curve = calibration.kinds[MergeKind.OVERLAP].curves[DISTANCE]
    assert (np.diff(curve.log_odds) <= 1e-9).all()


def test_what_was_written_is_read_back() -> None:
    calibration = fit(made_up(500, -1.0))

    again = Calibration.from_json(calibration.to_json())

    values = made_up(50, -1.0, seed=2)[MergeKind.FRAGMENT].values
    before, after = (one.log_odds(MergeKind.FRAGMENT, values)[0] for one in (calibration, again))
    np.testing.assert_allclose(before, after, atol=0.01)


def test_the_table_counts_every_pair_once() -> None:
    samples = made_up(1000, -2.0)
    calibration = fit(samples)

    rows = [row for row in reliability(calibration, samples) if row[0] == MergeKind.HANDOVER.value]

    assert sum(count for _, _, _, count, _ in rows) == 1000
    came_true = sum(count * share for _, _, _, count, share in rows)
    assert round(came_true) == int(samples[MergeKind.HANDOVER].is_one.sum())


def test_tracks_of_which_nobody_knows_whose_they_are_say_nothing() -> None:
    owned = of_scene(track_scene(scene_of(open_truth(SAMPLE), max_frames=25), Noise(1.0, 3), TrackingConfig()))
    unknown = {
        track for track, owner in owned.object_of.items() if owner == min(filter(None, owned.object_of.values()))
    }
    known = {track: owner for track, owner in owned.object_of.items() if track not in unknown}

    before = samples_of(owned)
    after = samples_of(OwnedTracks(owned.frames, known, owned.class_groups, owned.rig))

    assert sum(len(sample.is_one) for sample in before.values()) > 0
    for kind, sample in after.items():
        assert len(sample.is_one) <= len(before[kind].is_one)
        assert sample.is_one.sum() <= before[kind].is_one.sum()
    assert sum(len(one.is_one) for one in after.values()) < sum(len(one.is_one) for one in before.values())
