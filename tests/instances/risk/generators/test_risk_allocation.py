import math

import numpy as np
import pytest
from file_cases import check_refused

from waybound.instances.errors import UsageError
from waybound.instances.generating import generate


def test_the_sea_floor_is_the_fixed_one_for_seed_1() -> None:
    made = generate("risk-allocation", 1)
    step = np.arange(1, 21)
    assert -made.chance.limits == pytest.approx(6 * np.sin(step / 3.2) + 0.25 * step)
    spread = np.zeros((2, 2))
    a, w = np.array([[1.0, 1.0], [0.0, 1.0]]), np.diag([0.15, 0.02]) ** 2
    for _ in range(20):
        spread = a @ spread @ a.T + w
    assert made.quantities.covariance[-2:, -2:] == pytest.approx(spread)
    assert made.risk.total == 0.05 and set(made.upper) == {0.9}


def test_the_corridor_is_the_fixed_one_for_seed_1() -> None:
    made = generate("risk-allocation", 1, family="corridor")
    low = 2.4 * np.sin(math.pi * np.arange(1, 21) / 20) - 0.5
    assert made.chance.limits.reshape(20, 2) == pytest.approx(np.c_[-low, low + 1.1])
    assert made.constraint_lower.tolist() == [10.0, 0.0]
    assert (made.risk.total, len(made.decision_names)) == (0.001, 40)


def test_other_seeds_and_settings_are_other_problems() -> None:
    one, same, two = (generate("risk-allocation", seed, family="corridor", steps=5) for seed in (2, 2, 3))
    assert one.digest() == same.digest() != two.digest()
    assert len(generate("risk-allocation", 1, family="corridor", steps=5, constraints=4).chance.limits) == 20
    boxes = generate("risk-allocation", 1, family="obstacles", steps=5, obstacles=3)
    assert (len(boxes.chance.names), len(boxes.chance.limits)) == (15, 60)
    assert generate("risk-allocation", 1, risk="joint", total=0.2).risk.kind == "joint"


def test_three_constraints_a_step_are_refused() -> None:
    check_refused(UsageError, "2 or 4", generate, "risk-allocation", 1, family="corridor", constraints=3)
