import math

import numpy as np
import pytest
import risky_cases as cases

from waybound import RiskyGraph, RiskyPath
from waybound.formulations.stop import NEVER, Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.risk.occupancy import OccupancyGrid
from waybound.instances.risk.tether import Tether
from waybound.instances.risk.traverse_elements import FunctionRisk, TetherRisk, TravelledRisk
from waybound.solvers.engines.risk.risky_path_steps.least_hazard import least_hazard


@pytest.mark.parametrize("seed", range(5))
def test_the_best_of_all_paths_is_found_and_proved(seed):
    problem = cases.random_map(np.random.default_rng(seed), muddy=True, objective="hazard")
    result = least_hazard(problem, problem.graph.goals, NEVER)
    assert problem.evaluate(result.path).values[0] == pytest.approx(result.hazard) == pytest.approx(cases.best(problem))
    assert verified_bound(problem, result.evidence()) == pytest.approx(result.hazard)


def test_tethers_ways_and_functions_are_remembered():
    occupied = np.zeros((4, 4), dtype=bool)
    occupied[1:3, 1:3] = True
    grid = OccupancyGrid(occupied)
    tail, head = grid.arcs(4)
    n = len(grid.cells)
    tether = TetherRisk(Tether((0.5, 3.5), grid.boxes, 0.5), 0.02, 0.2)
    own = FunctionRisk(lambda path: 0.05 * (grid.state((3, 0)) in path), "own")
    for elements in ((tether,), (TravelledRisk(0.1, 2.0), tether), (own, tether)):
        graph = RiskyGraph(n, tail, head, elements, grid.state((0, 0)), True, (grid.state((3, 3)),), positions=grid.positions)
        problem = RiskyPath(graph, "hazard")
        result = least_hazard(problem, problem.graph.goals, NEVER)
        assert result.hazard == pytest.approx(cases.best(problem)) == pytest.approx(problem.evaluate(result.path).values[0])


def test_states_are_guarded_only_where_a_walk_would_repeat_them():
    assert least_hazard(cases.ring(), cases.ring().graph.goals, NEVER).labels == 0
    problem = cases.loop()
    result = least_hazard(problem, problem.graph.goals, NEVER)
    assert (result.hazard, result.guarded) == (pytest.approx(12), {1})


def test_limits():
    problem = cases.mud_costs()
    goals = problem.graph.goals
    cut = least_hazard(problem, goals, NEVER, labels=2)
    assert (cut.path, cut.limit) == (None, "iterations") and cut.hazard <= 5
    none = least_hazard(problem, goals, NEVER, most=3.0)
    assert none.path is None and none.limit == "none" and none.hazard >= 3.0
    assert least_hazard(problem, (problem.graph.start,), NEVER).path == (0,)
    apart = RiskyPath(cases.graph([(0, 1)], cases.mud_costs().graph.elements[1:], states=7, goals=(6,)))
    assert least_hazard(apart, (6,), Stop(10.0)).hazard == math.inf
