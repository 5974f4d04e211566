"""Objectives in order of priority through every form and solver: the optimum of each level, the bound of each level, and what is left
where a search ends between two of them."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from small_routing import small, varied
from truth.routing import best_values

import waybound as wb
from waybound import LatestReturn, LongestRoute, Program, Routes, RoutingProblem, Sites, Travel, UnsupportedError, VehicleType
from waybound.formulations.routing.objective import Composable, Makespan, Objective, Penalties, Reward, TotalCost, TotalDuration, Vehicles
from waybound.solvers.backend import BACKENDS, Control, LevelClaim, Options, RawResult
from waybound.solvers.backends.highs import Highs
from waybound.solving.search import Searched

SOLVERS = ("highs", "cpsat", "mathopt", "scip", "pulp", "cvxpy")
GOALS: dict[str, Composable] = {
    "several-loads": Reward().then(Makespan()), "shifts": LatestReturn().then(Vehicles()), "groups": Penalties().then(LatestReturn()),
    "overtime": Vehicles().then(TotalCost()), "vehicle-speeds": Makespan().then(TotalCost()).then(LongestRoute()),
    "committed-vehicles": (TotalCost() - Reward()).then(Makespan()), "pickups": TotalDuration().then(Reward()),
}  # fmt: skip


@pytest.mark.share(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("feature", ["vehicles", "reward-then-cost"])
def test_every_solver_reaches_the_optimum_of_each_level(feature: str, solver: str) -> None:
    problem = small(feature, 1, "exact")
    found = wb.solve(problem, solver, bound_time=0.0, time_limit=20.0)
    assert (found.status, found.bound_kind, found.faults) == ("optimal", "claimed", ())
    assert found.objective == pytest.approx(best_values(problem))
    assert found.bound == pytest.approx(found.objective)
    assert found.gap == pytest.approx(0.0, abs=1e-9)
    assert [link.name for link in found.chain][-1] == "levels-of-priority"


@pytest.mark.parametrize("feature", GOALS)
def test_every_form_reaches_the_optimum_of_each_level(feature: str) -> None:
    problem = replace(varied(feature, 3, 3), objective=Objective.of(GOALS[feature]))
    best, forms = best_values(problem), problem.forms()
    assert {"three-index", "set-partitioning"} <= set(forms)
    for form in forms:
        try:
            found = wb.solve(problem, "cpsat" if form == "circuit" else "highs", form=form, bound_time=0.0, time_limit=20.0)
        except UnsupportedError as refusal:
            assert form == "circuit" and "counted in steps" in str(refusal)
            continue
        assert found.status == ("infeasible" if best is None else "optimal"), form
        assert found.objective == (None if best is None else pytest.approx(best)), form


@pytest.mark.parametrize("scale", [2.0**-20, 1.0, 2.0**20])
def test_levels_are_held_at_any_scale(scale: float) -> None:
    problem = small("vehicles", 0, "exact")
    travel = Travel("euclidean", scale * problem.travel.coordinates)  # type: ignore[operator]
    scaled = replace(problem, travel=travel, objective=TotalCost().then(LongestRoute()))
    found = wb.solve(scaled, "highs", bound_time=0.0)
    assert found.status == "optimal"
    assert found.objective == pytest.approx(best_values(scaled), rel=1e-9)


def test_reward_before_makespan_is_no_weighted_sum() -> None:
    """The printed weight gives up reward for makespan, and cannot tell a visit from none."""
    places = Sites.of("oab", reward=[0, 10, 9])
    travel = Travel("euclidean", np.array([(0, 0), (5, 0), (-0.5, 0)]))
    asked: dict[str, Any] = {"vehicles": 1, "max_duration": 10.0}
    printed = wb.solve(wb.makespan_orienteering(places, travel, weight="printed", **asked), "highs", bound_time=0.0)
    assert printed.objective == pytest.approx(8.1)
    assert wb.solve(wb.makespan_orienteering(places, travel, **asked), "highs", bound_time=0.0).objective == pytest.approx([10, 10])
    tie = wb.makespan_orienteering(Sites.of("oa", reward=[0, 4]), Travel("euclidean", np.array([(0, 0), (5.0, 0)])), **asked)
    assert wb.solve(tie, "highs", bound_time=0.0).objective == pytest.approx([4, 10])


def test_later_levels_without_evidence_are_claimed_and_the_certificate_keeps_to_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("waybound.solving.levels.bounded", lambda *asked, **named: Searched(RawResult("unknown"), False, 0.0))
    found = wb.solve(small("vehicles", 1, "exact"), "highs", bound_time=60.0)
    assert found.status == "optimal"
    first: float = found.objective[0]  # type: ignore[index]
    assert found.certificate.bound == pytest.approx(first, rel=1e-9) and found.bound[0] == pytest.approx(first, rel=1e-9)  # type: ignore[index]
    assert found.bound_kind == "claimed"
    assert found.bound_source == f"{found.certificate.bound_source}, then highs ({found.form})"
    assert found.certificate.gap is None


class Between(Highs):
    """Closes the first level, and is asked to end as it begins the second."""

    name = "between"

    def search(self, program: Program, options: Options, control: Control) -> RawResult:
        if program.rows[-1].name == "level1":
            control._outer._outer.stop()  # type: ignore[attr-defined]
            return RawResult("unknown", "interrupt")
        return super().search(program, options, control)


def test_an_end_between_levels_leaves_what_was_reached(registered: Any) -> None:
    registered(BACKENDS, "between", Between)
    problem = small("vehicles", 1, "exact")
    found = wb.solve(problem, "between", bound_time=0.0)
    assert (found.status, found.limit) == ("feasible", "interrupt")
    assert found.objective[0] == found.bound[0] == best_values(problem)[0]  # type: ignore[index]
    assert found.bound[1] is None  # type: ignore[index]
    assert found.gap is None or found.gap == 0.0


def test_an_answer_that_beats_the_bound_of_a_later_level_is_told(registered: Any) -> None:
    problem = small("vehicles", 1, "exact")
    truth = wb.solve(problem, "highs", bound_time=0.0)

    class Lying(Highs):
        name = "lying"

        def run(self, program: Program, options: Options, control: Control) -> RawResult:
            said = super().run(program, options, control)
            return replace(said, further=tuple(LevelClaim(1.1 * level.objective, 1.1 * level.objective) for level in said.further))

    registered(BACKENDS, "lying", Lying)
    found = wb.solve(problem, "lying", bound_time=0.0)
    assert found.objective == truth.objective
    assert found.status == "feasible"
    assert "at level 2" in found.faults[0]


def test_a_start_that_is_better_at_a_later_level_wins() -> None:
    line = np.array([(0.0, 0), (1, 0), (2, 0), (-1, 0)])
    problem = RoutingProblem(Sites.of(range(4)), Travel("euclidean", line), (VehicleType(2),), Vehicles().then(TotalCost()))
    worse, better = Routes.of([[1, 3, 2]]), Routes.of([[1, 2, 3]])
    for start in (worse, better):
        assert wb.solve(problem, "highs", start=start, bound_time=0.0).objective == [1.0, 6.0]


def test_a_relaxation_bounds_the_first_level_alone() -> None:
    found = wb.solve(small("vehicles", 1, "exact"), "highs", form="two-index-time-flow", relax=True, bound_time=0.0)
    assert found.bound is not None
    assert found.answer is None or found.status != "optimal"


def test_files_and_models_of_one_objective_refuse_several(tmp_path: Any) -> None:
    made = small("vehicles", 1, "exact").compile("two-index-mtz")
    assert [level.sense for level in made.program.further] == ["min"]
    for hand_over in (made.to_highs, made.to_pulp, made.to_cvxpy, made.to_mathopt, lambda: made.write(tmp_path / "m.mps")):
        with pytest.raises(UnsupportedError, match="levels of priority"):
            hand_over()
    with pytest.raises(UnsupportedError, match=r"^a bare program .* levels of priority"):
        wb.solve(made.program)
    assert wb.solve(made, "highs", bound_time=0.0).objective == wb.solve(made.problem, "highs", bound_time=0.0).objective  # type: ignore[arg-type]
    assert made.program.first_level().to_highs().getNumCol() == made.program.num_variables
