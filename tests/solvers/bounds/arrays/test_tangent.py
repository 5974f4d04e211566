import numpy as np
import pytest
from programs import INF, program

import waybound as wb
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.stop import Stop
from waybound.formulations.tolerance import VECTOR
from waybound.formulations.verified_bounds import verified_bound
from waybound.reports.battery.kinds import KINDS
from waybound.reports.battery.truth import truth
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.arrays.tangent import tangent_bound


@pytest.mark.parametrize("seed", range(30))
def test_the_optimum_is_proved_or_that_there_is_none(seed: int) -> None:
    problem = KINDS["squares"](np.random.default_rng([seed, 23]))
    known, proof = truth(problem), tangent_bound(problem, Stop(20.0))  # type: ignore[arg-type]
    assert proof is not None
    bound, sign = verified_bound(problem, proof), 1.0 if problem.sense == "min" else -1.0
    if known.value is None:
        assert bound == sign * INF
    else:
        best = float(known.value)
        size = max(abs(best), float(np.abs(problem.program.cost).max()))  # type: ignore[attr-defined]
        assert bound == pytest.approx(best, abs=VECTOR * size)
        assert sign * bound <= sign * best + 1e-9 * size


def test_solve_shows_a_convex_optimum_as_verified() -> None:
    given = program([-4.0, -6.0], [[1.0, 1.0]], -INF, 3.0, 0.0, INF, quadratic=[[2, 0], [0, 2]])
    solution = wb.solve(given, "highs")
    assert (solution.status, solution.bound_kind) == ("optimal", "verified")
    assert solution.objective == pytest.approx(-11.0)


def test_what_is_not_convex_and_what_has_no_time_gets_no_evidence() -> None:
    bent = ArrayProblem(program([0.0, 0.0], [[1.0, 1.0]], -INF, 3.0, 0.0, 1.0, quadratic=[[0, 1], [1, 0]]))
    assert tangent_bound(bent, Stop(60.0)) is None
    assert tangent_bound(bent, Stop(0.0)) is None


def test_it_applies_to_quadratic_programs() -> None:
    missing = BOUNDS["tangent"].missing
    assert missing(ArrayProblem(program([1.0], [[1.0]], 0, 1, quadratic=[[1.0]]))) == frozenset()
    assert missing(ArrayProblem(program([1.0], [[1.0]], 0, 1))) == {"a linear objective, or cones"}
    assert missing(wb.generate("random", seed=1, customers=4)) == {"routing problems"}
