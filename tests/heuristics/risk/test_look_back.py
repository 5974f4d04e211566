import numpy as np
import pytest
import risky_cases as cases

import waybound as wb
from waybound import RiskyPath, UsageError
from waybound.formulations.stop import NEVER, Stop, Stopped
from waybound.heuristics.risk.look_back import exact_for, least_risky_paths, look_back, without_loops
from waybound.instances.risk.elements import LocaleRisk


def test_the_start_has_its_own_risk_and_unreachable_states_have_no_label():
    result = look_back(cases.table_3_1(), 2, NEVER)
    assert result[0] == (pytest.approx(-np.log(0.99)), (0,)) and len(result) == 12


def test_more_states_never_cost_more_on_the_way_to_exactness():
    problem = cases.mud_costs()
    result = {steps: look_back(problem, steps, NEVER)[6][0] for steps in (1, 2, 3, 7)}
    assert result == pytest.approx({1: 13, 2: 13, 3: 5, 7: 5})


@pytest.mark.parametrize("seed", range(3))
def test_hazards_are_those_of_the_walks_found(seed):
    problem = cases.random_map(np.random.default_rng(seed), muddy=True)
    for steps in (1, 2, 3):
        for hazard, walk in look_back(problem, steps, NEVER, revisits=False).values():
            assert hazard == pytest.approx(-np.log1p(-problem.evaluate(walk).quantities["risk"]))


def test_ties_go_to_the_fewest_moves():
    assert len(look_back(cases.lattice(3, 3, 8), 2, NEVER)[8][1]) == 3


def test_loops_are_left_out_first_to_last():
    assert without_loops((0, 1, 2, 3, 1, 4)) == (0, 1, 4)
    assert without_loops((0, 1, 2, 1, 3, 0, 5)) == (0, 5)
    assert without_loops((0, 1)) == (0, 1)


def test_it_ends_when_asked_to():
    with pytest.raises(Stopped):
        look_back(cases.lattice(12, 12, 8), 3, Stop(0.0))


@pytest.mark.parametrize("seed", range(3))
def test_guaranteed_where_risks_look_back_no_farther_than_it_does(seed):
    problem = cases.random_map(np.random.default_rng(seed))
    solution = wb.solve(problem, heuristic="look-back")
    assert solution.objective == pytest.approx(cases.best(problem))
    assert solution.certificate.guarantee.ratio == 1.0 and solution.status == "optimal"
    assert wb.solve(problem, heuristic="look-back", steps=1, bound_time=0).certificate.guarantee is None


def test_one_step_is_exact_for_places():
    assert wb.solve(cases.lattice(3, 3), heuristic="look-back", steps=1).certificate.guarantee.ratio == 1.0


def test_loops_are_repaired_by_the_better_of_two_ways():
    for problem in (cases.loop(), cases.refusal()):
        paths, looped = least_risky_paths(problem, 2, NEVER)
        assert looped and all(len(set(path)) == len(path) for path in paths.values())


def test_what_makes_it_exact():
    assert (
        exact_for(cases.ring(), 2)
        and not exact_for(cases.ring(), 1)
        and not exact_for(cases.mud(), 3)
        and exact_for(cases.lattice(2, 2), 1)
    )


def test_no_goal_is_told_and_steps_are_checked():
    apart = RiskyPath(cases.graph([(0, 1)], [LocaleRisk([0, 0, 0])], states=3, goals=(2,)))
    assert wb.solve(apart, heuristic="look-back").status == "infeasible"
    with pytest.raises(UsageError, match="steps must be a whole number from 1 to 8"):
        wb.solve(cases.ring(), heuristic="look-back", steps=9)
