import copy
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from coded import coded
from small_routing import WHOLE_FAMILY, few, plane, varied
from truth.routing import best_values

import waybound as wb
from waybound import CheckFailedError, Evidence, InputError, Objective, Penalties, Reward, Sites, TotalCost, Vehicles
from waybound.formulations.certificate import certify, check_certificate
from waybound.formulations.levels import best_level_bound, with_levels
from waybound.solvers.bounds.routing.spanning_tree import spanning_tree_bound
from waybound.solvers.bounds.routing.vehicles_needed import vehicles_needed


@pytest.mark.share(2)
@pytest.mark.parametrize("feature", WHOLE_FAMILY)
def test_the_problem_of_the_next_level_keeps_every_answer_that_is_as_good_before(feature: str) -> None:
    goals = (Vehicles().then(TotalCost()), TotalCost().then(Vehicles()), Reward().then(TotalCost()), Penalties().then(TotalCost()))
    for seed, goal in enumerate(goals, start=1):
        drawn = varied(feature, seed, few(feature))
        problem = replace(drawn, objective=Objective.of(goal), sites=_penalised(drawn.sites))
        best = best_values(problem)
        if best is None:
            continue
        given = problem.given([float(best[0])])
        assert given is not None and given.senses == problem.senses[1:]
        left = best_values(given)
        assert left is not None and left[0] <= best[1] + 1e-9


def _penalised(sites: Sites) -> Sites:
    free = ~sites.depot & ~sites.required
    free[[site for group in sites.groups for site in group.sites]] = False
    return replace(sites, penalty=np.where(free, 3.0, 0.0))


def test_there_is_no_next_level_after_the_last() -> None:
    problem = replace(plane(1, 4, 10.0), objective=Objective.of(Vehicles().then(TotalCost())))
    assert problem.given([2.0, 30.0]) is None and problem.given([]) is None
    assert wb.read("cover-30").given([1.0]) is None


def test_sites_without_whom_rewards_or_penalties_are_out_of_reach_are_required() -> None:
    plain = plane(1, 4, 100.0).sites
    sites = replace(plain, reward=np.array([0, 5, 3, 3, 1.0]), penalty=np.array([0, 5, 3, 3, 1.0]), required=np.zeros(5, dtype=bool))
    for goal, most in ((Reward().then(TotalCost()), 12.0), (Penalties().then(TotalCost()), 0.0)):
        problem = replace(plane(1, 4, 100.0), sites=sites, objective=Objective.of(goal))
        for lost, needed in ((0.0, [1, 1, 1, 1]), (1.0, [1, 1, 1, 0]), (3.0, [1, 0, 0, 0]), (5.0, [0, 0, 0, 0])):
            given = problem.given([abs(most - lost)])
            assert given is not None and given.sites.required[1:].tolist() == needed
    solution = wb.solve(replace(problem, objective=Objective.of(Reward().then(TotalCost()))), "highs", bound_time=10.0)
    assert solution.certificate.bound == solution.objective[0] == 12.0
    assert solution.certificate.levels[0].bound == pytest.approx(solution.objective[1])


def test_only_levels_of_vehicles_alone_limit_the_fleet() -> None:
    problem = plane(1, 4, 10.0)
    for goal, counts in (
        (Vehicles().then(TotalCost()), [3]),
        ((2.0 * Vehicles()).then(TotalCost()), [1]),
        ((Vehicles() + TotalCost()).then(TotalCost()), [None]),
        (Reward().then(TotalCost()), [None]),
    ):
        given = replace(problem, objective=Objective.of(goal)).given([3.0])
        assert [v.count for v in given.fleet] == counts


@pytest.fixture(scope="module")
def solved() -> tuple[Any, Any, Any]:
    """A problem of two levels, the evaluation of an optimum, and its certificate with a bound of each level."""
    problem = replace(plane(1, 4, 10.0), objective=Objective.of(Vehicles().then(TotalCost())))
    evaluation = wb.solve(problem, "cpsat", bound_time=0.0).evaluation
    first, second = vehicles_needed(problem), spanning_tree_bound(problem.given(evaluation.values[:1]))
    found = best_level_bound(problem, evaluation.values[:1], evaluation, [second])
    return problem, evaluation, with_levels(certify(problem, evaluation, [first]), evaluation, [found])


def test_a_bound_of_the_second_level_is_verified_and_gives_the_gap(solved: Any) -> None:
    _, evaluation, certificate = solved
    (level,) = certificate.levels
    assert 0 < level.bound <= evaluation.values[1] + 1e-9 and level.given == evaluation.values[:1]
    assert certificate.gap == pytest.approx((evaluation.values[1] - level.bound) / evaluation.values[1])
    assert "then" in repr(certificate)


def test_a_certificate_file_holds_the_levels_and_is_verified_again(solved: Any) -> None:
    problem, evaluation, certificate = solved
    data = certificate.to_json(with_evidence=True)
    assert check_certificate(problem, data, evaluation).levels[0].bound == certificate.levels[0].bound
    assert check_certificate(problem, data, None).levels[0].given == evaluation.values[:1]
    assert "evidence" not in certificate.to_json()["levels"][0]


@pytest.mark.parametrize(
    ("change", "fault", "told"),
    [
        (lambda level: level.update(bound=level["bound"] * 1.01), CheckFailedError, "its evidence proves"),
        (lambda level: level.update(given=[level["given"][0] + 1]), CheckFailedError, "the answer is worth"),
        (lambda level: level.update(given=[]), InputError, "malformed"),
        (lambda level: level.update(given="x"), InputError, "malformed"),
        (lambda level: level.update(bound="x"), InputError, "not a finite number"),
        (lambda level: level.pop("evidence"), InputError, "malformed"),
        (lambda level: level.update(evidence=3), InputError, "malformed"),
        (lambda level: level["evidence"].update(data={}), InputError, "evidence lacks"),
    ],
)
def test_what_a_file_states_beyond_its_evidence_is_refused(solved: Any, change: Any, fault: type[Exception], told: str) -> None:
    problem, evaluation, certificate = solved
    data = copy.deepcopy(certificate.to_json(with_evidence=True))
    change(data["levels"][0])
    with pytest.raises(fault, match=told):
        check_certificate(problem, data, evaluation)


def test_more_levels_than_the_problem_has_are_refused(solved: Any) -> None:
    problem, evaluation, certificate = solved
    data = certificate.to_json(with_evidence=True)
    with pytest.raises(InputError, check=coded("malformed")):
        check_certificate(problem, {**data, "levels": data["levels"] * 2}, evaluation)


def test_a_bound_that_contradicts_the_answer_is_an_error(solved: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    problem, evaluation, _ = solved
    lie = Evidence("lie", "a lie", 0.0, {})
    monkeypatch.setattr("waybound.formulations.levels.verified_bound", lambda problem, evidence: 1e9)
    with pytest.raises(CheckFailedError, match="one of the two checks is wrong"):
        best_level_bound(problem, evaluation.values[:1], evaluation, [lie])


def test_evidence_that_fails_is_told_and_costs_the_others_nothing(solved: Any) -> None:
    problem, evaluation, certificate = solved
    notes: list[str] = []
    found = best_level_bound(
        problem, evaluation.values[:1], evaluation, [Evidence("no-such", "nothing", 0.0, {}), certificate.levels[0].evidence], notes
    )
    assert found is not None and found.bound == certificate.levels[0].bound and "nothing is no bound of level 2" in notes[0]


def test_bounds_without_an_answer_are_given_the_bounds_before() -> None:
    problem = replace(plane(1, 4, 10.0), objective=Objective.of(Vehicles().then(TotalCost())))
    made = wb.bound(problem, bound_time=60.0)
    (level,) = made.levels
    best = best_values(problem)
    assert level.given == (made.bound,) == (best[0],) and 0.0 < level.bound <= best[1] + 1e-9
    told = repr(made)
    assert f"then {level.source}" in told and f"level 2: of solutions that are worth {made.bound:g} before it" in told


def test_a_certificate_of_bounds_alone_says_nothing_of_answers_that_are_worse_before(solved: Any) -> None:
    problem, evaluation, certificate = solved
    alone = replace(certify(problem, None, certificate.evidence), levels=certificate.levels).to_json(with_evidence=True)
    assert check_certificate(problem, alone, evaluation).levels == certificate.levels
    worse = problem.evaluate(wb.Routes.of([[k] for k in problem.customers.tolist()]))
    assert worse.feasible and worse.values[0] > certificate.levels[0].given[0]
    assert check_certificate(problem, alone, worse).levels == ()
    alone["levels"][0]["bound"] *= 1.01
    with pytest.raises(CheckFailedError, match="its evidence proves"):
        check_certificate(problem, alone, worse)


def test_that_no_answer_meets_the_bound_before_is_told_without_one(solved: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    problem, *_ = solved
    monkeypatch.setattr("waybound.formulations.levels.verified_bound", lambda problem, evidence: float("inf"))
    notes: list[str] = []
    assert best_level_bound(problem, (1.0,), None, [Evidence("some", "some proof", 0.0, {})], notes) is None
    assert notes == ["no solution is worth 1 before level 2: some proof"]


def test_what_counts_as_equal_at_one_level_is_counted_by_all_its_terms() -> None:
    sites = wb.Sites.of("oab", required=[False, True, False], penalty=[0, 1e12, 1])
    travel = wb.Travel("EXPLICIT", matrix=np.abs(np.subtract.outer([0.0, 1.0, 5.0], [0.0, 1.0, 5.0])))
    problem = wb.RoutingProblem(sites, travel, (wb.VehicleType(1),), Objective.of(Penalties().then(TotalCost())))
    level = best_level_bound(problem, (0.0,), None, [Evidence("customer-sets", "some", math.nan, {})])
    left_out = problem.evaluate(wb.Routes.of([(1,)]))
    assert level is not None and level.bound <= left_out.values[1]  # its penalty of 1 is nothing beside 1e12
