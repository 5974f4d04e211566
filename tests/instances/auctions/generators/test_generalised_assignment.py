import numpy as np
import pytest

from waybound.instances.generating import generate


@pytest.mark.parametrize("kind", ["c", "d"])
def test_capacities_are_four_fifths_of_an_even_share(kind: str) -> None:
    made = generate("generalised-assignment", agents=4, jobs=30, costs=kind, seed=2)
    assert made.capacity.tolist() == np.floor(0.8 * made.consumption.sum(axis=1) / 4).tolist()
    assert made.digest() == generate("generalised-assignment", agents=4, jobs=30, costs=kind, seed=2).digest()
    least, most = (10, 50) if kind == "c" else (1, 120)
    assert made.objective == "cost" and made.values.min() >= least and made.values.max() <= most
    assert (np.corrcoef(made.values.ravel(), made.consumption.ravel())[0, 1] < -0.9) == (kind == "d")


def test_bins_of_an_orchard_take_every_robot_the_same() -> None:
    made = generate("generalised-assignment", agents=3, jobs=20, costs="orchard", horizon=40, seed=2)
    assert made.objective == "profit" and (made.values == 1.0).all() and made.capacity.tolist() == [40.0] * 3
    assert (made.consumption == made.consumption[0]).all() and made.consumption.max() <= 9 + 17
