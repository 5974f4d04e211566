"""A point and a ray prove an objective endless only where it is."""

import numpy as np
import pytest
from programs import INF, program

from waybound.formulations.arrays.checking.endless_ray import check_endless_ray
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.instances.errors import InputError
from waybound.reports.battery.kinds import KINDS
from waybound.reports.battery.truth import truth

CONE = ArrayProblem(program([-1.0, 0.0, 1.0], [[1, -3, 0], [0, 1, 1]], [0, -INF], [0, INF], [0, 0, -2], INF, integer=[0]))
"""x = 3 y and x whole: (3, 1, 0) leads on for ever."""
AT = [3.0, 1.0, 0.0]


def test_a_point_and_a_ray_prove_it() -> None:
    assert check_endless_ray(CONE, {"point": AT, "ray": [3.0, 1.0, 0.0]})
    assert check_endless_ray(CONE, {"point": AT, "ray": {"at": [0, 1], "values": [1.5, 0.5]}})


@pytest.mark.parametrize(
    "data",
    [
        {"point": AT, "ray": [3.0, 1.0000000001, 0.0]}, {"point": AT, "ray": [0.0, 0.0, 1.0]}, {"point": AT, "ray": [0.0, 0.0, -1.0]},
        {"point": AT, "ray": [-3.0, -1.0, 0.0]}, {"point": AT, "ray": [0.0, 0.0, 0.0]}, {"point": AT, "ray": [3.0, 1.0, 3.0]},
        {"point": [3.0, 2.0, 0.0], "ray": [3.0, 1.0, 0.0]}, {"point": [1.5, 0.5, 0.0], "ray": [3.0, 1.0, 0.0]},
    ],
    ids=["leaves a row", "gets worse", "meets a bound", "meets bounds", "stands", "gains nothing", "point off a row", "point not whole"],
)  # fmt: skip
def test_what_proves_nothing(data: dict[str, object]) -> None:
    assert not check_endless_ray(CONE, data)


@pytest.mark.parametrize(
    ("quadratic", "proved"), [([[0, 0], [0, 0]], True), ([[2, 0], [0, 0]], False), ([[-2, 0], [0, 0]], True), ([[2, 2], [2, 2]], False)]
)
def test_a_quadratic_objective_is_followed_along_the_ray(quadratic: list[list[float]], proved: bool) -> None:
    problem = ArrayProblem(program([-1.0, -1.0], np.zeros((0, 2)), [], [], 0.0, INF, quadratic=quadratic))
    assert check_endless_ray(problem, {"point": [1.0, 1.0], "ray": [1.0, 0.0]}) is proved


def test_products_with_the_point_count() -> None:
    problem = ArrayProblem(program([0.0, 0.0], np.zeros((0, 2)), [], [], [0, -1], [INF, 1], quadratic=[[0, 1], [1, 0]]))
    assert check_endless_ray(problem, {"point": [0.0, -1.0], "ray": [1.0, 0.0]})
    assert not check_endless_ray(problem, {"point": [0.0, 1.0], "ray": [1.0, 0.0]})


@pytest.mark.share(2)
@pytest.mark.parametrize("kind", ["linear", "mixed-integer", "integer", "unbounded"])
def test_no_ray_proves_a_program_endless_that_is_not(kind: str) -> None:
    told = 0
    for seed in range(60):
        rng = np.random.default_rng([seed, 3])
        problem = KINDS[kind](rng)
        p = problem.program  # type: ignore[attr-defined]
        if truth(problem).status == "unbounded":
            continue
        for _ in range(30):
            told += 1
            point = np.clip(rng.integers(-3, 4, p.num_variables), p.lower, p.upper)
            ray = rng.integers(-2, 3, p.num_variables) * (rng.random(p.num_variables) < 0.5)
            assert not check_endless_ray(problem, {"point": point.astype(float).tolist(), "ray": ray.astype(float).tolist()})
    assert told > 100


@pytest.mark.parametrize("data", [{}, {"point": AT}, {"point": AT, "ray": [1.0]}, {"point": AT, "ray": [1.0, "2", 0.0]}])
def test_lists_that_do_not_fit_are_refused(data: dict[str, object]) -> None:
    with pytest.raises(InputError):
        check_endless_ray(CONE, data)
