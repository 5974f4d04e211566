"""Look-back: labels of the last states."""

from __future__ import annotations

import numpy as np
import pytest
import risky_cases as cases

from waybound.formulations.stop import NEVER, Stop, Stopped
from waybound.solvers.engines.risk.risky_path_steps.look_back import look_back, without_loops


def test_the_start_has_its_own_risk_and_unreachable_states_have_no_label():
    problem = cases.table_3_1()
    found = look_back(problem, 2, NEVER)
    assert found[0] == (pytest.approx(-np.log(0.99)), (0,)) and len(found) == 12


def test_more_states_never_cost_more_on_the_way_to_exactness():
    problem = cases.mud_costs()
    found = {steps: look_back(problem, steps, NEVER)[6][0] for steps in (1, 2, 3, 7)}
    assert found == pytest.approx({1: 13, 2: 13, 3: 5, 7: 5})


@pytest.mark.parametrize("seed", range(3))
def test_hazards_are_those_of_the_walks_found(seed):
    problem = cases.random_map(np.random.default_rng(seed), muddy=True)
    for steps in (1, 2, 3):
        for hazard, walk in look_back(problem, steps, NEVER, revisits=False).values():
            assert hazard == pytest.approx(-np.log1p(-problem.evaluate(walk).quantities["risk"]))


def test_ties_go_to_the_fewest_moves():
    problem = cases.lattice(3, 3, 8)
    assert len(look_back(problem, 2, NEVER)[8][1]) == 3


def test_loops_are_left_out_first_to_last():
    assert without_loops((0, 1, 2, 3, 1, 4)) == (0, 1, 4)
    assert without_loops((0, 1, 2, 1, 3, 0, 5)) == (0, 5)
    assert without_loops((0, 1)) == (0, 1)


def test_it_ends_when_asked_to():
    with pytest.raises(Stopped):
        look_back(cases.lattice(12, 12, 8), 3, Stop(0.0))
