"""Endless programs are found out, and no others."""

import numpy as np
import pytest
from programs import INF, program

import waybound as wb
from waybound import CheckFailedError, Evidence
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.certificate import certify, check_certificate
from waybound.formulations.solution import status_line
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import proves_unbounded
from waybound.reports.battery.kinds import KINDS
from waybound.reports.battery.truth import truth
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.arrays.endless_ray import endless_ray

ENDLESS = ArrayProblem(program([-3.0, 1.0], [[1.0, -3.0]], 0, 0, 0, INF, integer=[1]))


@pytest.mark.share(2)
@pytest.mark.parametrize("kind", ["mixed-integer", "linear", "unbounded"])
def test_endless_programs_are_proved_to_be_so(kind: str) -> None:
    told = 0
    for seed in range(40):
        problem = KINDS[kind](np.random.default_rng([seed, 17]))
        method = BOUNDS["endless-ray"]
        proof = None if method.missing(problem) else endless_ray(problem, Stop(20.0))  # type: ignore[arg-type]
        assert (proof is not None) is (truth(problem).status == "unbounded")
        if proof is not None:
            told += 1
            assert proves_unbounded(problem, proof)
    assert told >= 2


def test_it_applies_to_linear_programs_with_variables_that_have_no_bound() -> None:
    missing = BOUNDS["endless-ray"].missing
    assert missing(ENDLESS) == frozenset()
    assert missing(ArrayProblem(program([1.0], [[1.0]], 0, 1, 0, 1))) == {"bounds on all that gains"}
    assert missing(ArrayProblem(program([1.0], [[1.0]], 0, INF))) == {"bounds on all that gains"}
    assert missing(ArrayProblem(program([-1.0], [[1.0]], 0, 1, quadratic=[[1.0]]))) == {"a quadratic objective"}
    assert missing(wb.generate("random", seed=1, customers=4)) == {"routing problems"}


def test_no_time_finds_nothing() -> None:
    assert endless_ray(ENDLESS, Stop(0.0)) is None


def test_solve_states_and_certifies_it() -> None:
    solution = wb.solve(ENDLESS, "highs", bound_time=10.0)
    assert (solution.status, solution.answer, solution.bound, solution.certificate.unbounded) == ("unbounded", None, None, True)
    assert status_line(solution).text.startswith("unbounded, verified: ")
    data = solution.certificate.to_json(with_evidence=True)
    assert data["unbounded"] is True
    assert check_certificate(ENDLESS, data, None).unbounded
    assert "there is no best solution, verified" in str(solution.certificate) + repr(solution.certificate)
    data["evidence"][0]["data"]["ray"][0] = 1.0
    with pytest.raises(CheckFailedError, match="no best answer"):
        check_certificate(ENDLESS, data, None)


def test_evidence_of_both_kinds_cannot_be_right() -> None:
    ray = Evidence("endless-ray", "a ray", -INF, {"point": [0.0, 0.0], "ray": [3.0, 1.0]})
    problem = ENDLESS
    assert certify(problem, None, [ray]).unbounded
    bounded = ArrayProblem(program([-3.0], np.zeros((0, 1)), [], [], 0, 5))
    duals = Evidence("lp-dual", "duals", -15.0, {"duals": []})
    assert certify(bounded, None, [duals, Evidence("endless-ray", "a ray", -INF, {"point": [0.0], "ray": [1.0]})]).unbounded is False
