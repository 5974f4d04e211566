"""Which solver and which form are taken where none is named, and what is said where none fits."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from programs import program
from sata_cases import CASES

import waybound as wb
from waybound.formulations.forms import FORMS, nearest_form
from waybound.formulations.programs.program import CONES, INTEGERS, LINEAR, QUADRATIC
from waybound.formulations.routing.objective import (
    TERMS,
    Composable,
    LatestReturn,
    LongestRoute,
    Makespan,
    Objective,
    Reward,
    TotalCost,
    Vehicles,
)
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.sata.bottleneck_sata import BottleneckSATA
from waybound.formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from waybound.heuristics.heuristic import HEURISTICS
from waybound.instances.errors import UnsupportedError, UsageError
from waybound.instances.routing.features import FEATURES, UNASKED
from waybound.instances.routing.instance import Energy, Sites, VehicleType
from waybound.instances.routing.travel import Travel
from waybound.solvers.backend import BACKENDS, Engine
from waybound.solvers.program_backend import ProgramBackend, takers
from waybound.solving.listing import missing_features

S3 = CASES["S3"].graph


def test_the_features_that_a_form_declares_are_those_of_its_program() -> None:
    problems = [
        BottleneckSATA(S3), BottleneckSATA(S3, fractional=True), WinnerTakesAllSATA(S3),
        wb.MaxMinLP(np.eye(2), np.eye(2)), wb.MaxMinLP(np.eye(2), np.eye(2), sense="min"),
    ]  # fmt: skip
    for problem in problems:
        for form in problem.forms():
            assert FORMS[form].makes(problem) == problem.compile(form).program.features()


def test_a_linear_form_is_taken_where_none_is_named() -> None:
    solution = wb.solve(WinnerTakesAllSATA(S3), bound_time=0)
    assert (solution.solver, solution.form) == ("highs", "facility-location")


def test_the_form_decides_which_solver_is_taken() -> None:
    assert wb.solve(WinnerTakesAllSATA(S3), form="product", bound_time=0).objective == 31.0
    assert wb.solve(BottleneckSATA(S3), form="max-min", bound_time=0).solver == "highs"


@pytest.mark.slow
def test_a_relaxation_is_solved_as_a_linear_program() -> None:
    assert wb.solve(WinnerTakesAllSATA(S3), relax=True, bound_time=0).solver == "highs"
    assert wb.solve(BottleneckSATA(S3), "cvxpy:CLARABEL", relax=True, bound_time=0).bound == pytest.approx(10.0, abs=1e-6)


def test_a_compiled_program_finds_a_solver_of_its_kind() -> None:
    made = wb.solve(WinnerTakesAllSATA(S3).compile("product"), bound_time=0)
    assert (made.solver, [link.name for link in made.chain]) == ("highs", ["product", "linear-products"])
    miqp = program([0, 0], [[1, 1]], -math.inf, 2, 0, 1, integer=[0, 1], sense="max", quadratic=[[0, 1], [1, 0]])
    assert wb.solve(miqp, bound_time=0).objective == pytest.approx(1.0)
    wide = program([0, 0], [[1, 1]], -math.inf, 5, 0, 3, integer=[0, 1], sense="max", quadratic=[[0, 1], [1, 0]])
    made = wb.solve(wide, bound_time=0)  # neither is binary, so that there is no linear form
    assert made.solver in ("scip", "mathopt")
    assert made.objective == pytest.approx(6.0)


def test_a_solver_that_lacks_the_kind_is_listed_with_what_it_lacks() -> None:
    fractional = BottleneckSATA(S3, fractional=True)
    assert missing_features("cpsat", fractional) == (frozenset({"LP programs"}), ())
    assert missing_features("cpsat", BottleneckSATA(S3)) == (frozenset(), ("max-min",))
    forms = ("facility-location", "strong-linearisation", "weak-linearisation")
    assert missing_features("highs", WinnerTakesAllSATA(S3)) == (frozenset(), (*forms, "product"))
    assert missing_features("cpsat", WinnerTakesAllSATA(S3)) == (frozenset(), (*forms, "product"))


def test_a_solver_that_lacks_the_kind_refuses_and_names_others() -> None:
    with pytest.raises(UnsupportedError, match=r"cpsat cannot take this problem: it does not handle LP programs; can take it: .*highs"):
        wb.solve(BottleneckSATA(S3, fractional=True), "cpsat")
    with pytest.raises(
        UnsupportedError, match=r"mathopt:glop cannot take this problem: it does not handle MIQP programs; can take it: .*cpsat"
    ):
        wb.solve(WinnerTakesAllSATA(S3), "mathopt:glop", form="product")


def test_takers_are_installed_and_take_what_they_say() -> None:
    for features in (LINEAR, INTEGERS, QUADRATIC, INTEGERS | QUADRATIC, *({cone} for cone in CONES), CONES, CONES | QUADRATIC):
        assert takers(frozenset(features))
        for name in takers(frozenset(features)):
            base, _, variant = name.partition(":")
            backend = BACKENDS[base](variant) if variant else BACKENDS[base]()
            assert isinstance(backend, ProgramBackend)
            assert backend.able(frozenset(features))
    assert "highs" not in takers(LINEAR, "highs")
    assert takers(CONES | INTEGERS) == []


def asking(objective: Composable, **fleet: Any) -> RoutingProblem:
    xy = np.random.default_rng(1).uniform(0, 9, (4, 2))
    return RoutingProblem(Sites.of(range(4), demand=1), Travel("euclidean", xy), (VehicleType(2, 20.0, **fleet),), Objective.of(objective))


@pytest.mark.parametrize("objective", [Reward() + LongestRoute(), Reward() + 2 * LongestRoute()])
def test_a_refusal_names_what_the_nearest_form_lacks_and_nothing_that_forms_have(objective: Composable) -> None:
    """The longest route cannot be made longer by a linear program."""
    problem = asking(objective)
    for solver in ("highs", "cpsat", "pyvrp"):
        assert missing_features(solver, problem) == ({"objective:longest-route"}, ())
        with pytest.raises(
            UnsupportedError, match=rf"^{solver} cannot take this problem: it does not handle objective:longest-route; no installed"
        ):
            wb.solve(problem, solver)
    with pytest.raises(
        UnsupportedError, match=r"^no form can take this problem: the nearest, two-index-.*, does not handle objective:longest-route$"
    ):
        problem.compile()


def test_the_nearest_form_is_the_one_that_lacks_fewest() -> None:
    problem = replace(asking(Reward().then(Vehicles() - Makespan())), fleet=(VehicleType(2), VehicleType(1, name="other")))
    assert FORMS["two-index-mtz"].missing(problem) == {"heterogeneous-fleet", "objective:makespan"}
    assert nearest_form(problem) == ("three-index", {"objective:makespan"})


def test_the_nearest_solver_is_of_the_family_and_lacks_fewest() -> None:
    charged: dict[str, Any] = {"energy": Energy(99.0, charge="windows"), "committed": True}
    assert missing_features("pyvrp", asking(LongestRoute(), **charged))[0] == {"energy:windows", "committed-vehicles"}
    assert missing_features("saddle", asking(LongestRoute()))[0] == {"routing problems"}
    with pytest.raises(
        UnsupportedError, match=r"^no installed solver can take this problem: the nearest, ortools, does not handle objective:1"
    ):
        wb.solve(asking(Reward() + LongestRoute(), **charged))


@pytest.mark.slow
def test_where_no_solver_takes_a_problem_the_heuristic_that_opens_it_does_and_others_are_named() -> None:
    problem = asking(TotalCost(), max_duration=60.0)
    many = Sites.of(range(31), demand=1)
    xy = np.random.default_rng(1).uniform(0, 9, (31, 2))
    spread = Travel("euclidean", xy, variances=np.ones((31, 31)) - np.eye(31))
    asked = replace(problem, sites=many, travel=spread, team_risk=0.05)
    assert wb.solve(asked, time_limit=0.5, bound_time=0).solver == "safety-margins"
    with pytest.raises(UsageError, match=r"no form of \S+ is exact; name one of three-index-\S+, three-index-\S+$"):
        wb.solve(asked, start=[[k] for k in range(1, 31)])
    refusal = UnsupportedError("no installed solver", frozenset({"team-risk"}), ["safety-margins"], nearest="ortools")
    assert str(refusal).endswith("does not handle team-risk; heuristics that can: safety-margins")


def test_where_no_form_takes_a_problem_the_engines_that_do_are_named() -> None:
    xy = np.random.default_rng(1).uniform(0, 9, (13, 2))
    sites = Sites.of(range(13), windows={1: [(0, 20), (30, 50)]})
    problem = RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(2, max_duration=90.0),), LatestReturn())
    with pytest.raises(
        UnsupportedError, match=r"^highs cannot take this problem: it does not handle several-windows; can take it: ortools"
    ):
        wb.solve(problem, "highs")


@pytest.mark.parametrize("solver", ["highs", "cpsat", "mathopt", "scip", "pulp", "cvxpy"])
def test_objectives_in_order_of_priority_are_taken_by_whoever_takes_a_form_of_each_level(solver: str) -> None:
    asked = asking(Vehicles().then(TotalCost()))
    forms = tuple(form for form in asked.forms() if form != "circuit" or solver == "cpsat")
    assert missing_features(solver, asked) == (frozenset(), forms)
    assert missing_features(solver, asking(TotalCost())) == (frozenset(), forms)


def test_all_that_forms_engines_and_heuristics_for_routing_declare_is_in_the_vocabulary_of_the_data() -> None:
    declared = set().union(
        *(form.features for form in FORMS.values() if form.family == "routing"),
        *(b.features for b in BACKENDS.values() if issubclass(b, Engine) and b.family == "routing"),
        *(h.features for h in HEURISTICS.values() if h.families == ("routing",)),
    )
    of_objectives = {*(f"objective:{name}" for name in TERMS), "objective:weights", "objective:priorities"}
    assert declared <= FEATURES.keys() | of_objectives
    assert FEATURES.keys() - UNASKED <= declared


def test_who_knows_circuits_is_given_them_where_it_can_count_them() -> None:
    assert wb.solve(asking(TotalCost()), "cpsat", bound_time=0.0).form == "circuit"
    assert wb.solve(asking(TotalCost()), "highs", bound_time=0.0).form == "two-index-load-flow"
    xy = np.array([(0, 0), (3, 4), (6, 8)], dtype=float)
    sites = Sites.of(range(3), ready=[0, 7, 30])
    waiting = RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(2),), Objective.of(Makespan()))
    assert wb.solve(waiting, "cpsat", bound_time=0.0).form == "set-partitioning"
