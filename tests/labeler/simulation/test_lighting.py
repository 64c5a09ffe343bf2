import numpy as np
import pytest

from labeler.simulation.errors import SimulationError
from labeler.simulation.lighting import lighting_of


def test_seeds_give_every_light_and_the_same_seed_the_same() -> None:
    names = {lighting_of(seed).name for seed in range(40)}

    assert names == {"morning", "noon", "overcast", "evening"}
    assert lighting_of(3) == lighting_of(3)
    assert lighting_of(3) != lighting_of(4)


@pytest.mark.parametrize(
    ("name", "least_deg", "most_deg"),
    [("morning", 24, 36), ("noon", 48, 64), ("overcast", 40, 60), ("evening", 14, 22)],
)
def test_the_sun_stands_where_the_time_of_day_says(name: str, least_deg: float, most_deg: float) -> None:
    for seed in range(10):
        direction = lighting_of(seed, name=name).sun_direction
        assert np.linalg.norm(direction) == pytest.approx(1.0)
        assert least_deg <= np.degrees(np.arcsin(direction[2])) <= most_deg


def test_a_light_that_does_not_exist() -> None:
    with pytest.raises(SimulationError, match="no light called 'dusk'; choose one of evening, morning, noon, overcast"):
        lighting_of(0, name="dusk")
