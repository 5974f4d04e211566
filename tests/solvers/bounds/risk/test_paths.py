import pytest
import risky_cases as cases
from uncertain_graphs import WORKED, graph_of

import waybound as wb
from waybound.formulations.risk.uncertain_path import UncertainPath
from waybound.formulations.stop import NEVER, Stop
from waybound.solvers.bounds import BOUNDS


def test_it_is_the_optimum_where_the_walk_is_a_path_and_below_it_elsewhere():
    for problem, value in ((cases.ring(), 0.393469), (cases.loop(), 5.0), (cases.mud_costs(), 4.0), (cases.two_ways(), 27.272727)):
        assert BOUNDS["move-potentials"].compute(problem, NEVER, None).value == pytest.approx(value, abs=5e-7)


def test_it_takes_this_family_alone_and_stops():
    assert BOUNDS["move-potentials"].missing(wb.read("demo-c25")) == {"routing problems"}
    assert BOUNDS["move-potentials"].compute(cases.ring(), Stop(0.0), None) is None


@pytest.mark.parametrize(("make", "best", "guarded"), [(cases.loop, 12, [1]), (cases.refusal, 6, [1]), (cases.mud_costs, 5, [])])
def test_it_guards_what_walks_would_repeat_and_closes_the_gap(make, best, guarded):
    evidence = BOUNDS["guarded-walks"].evidence(make(), NEVER, None, None)
    assert evidence.value == pytest.approx(best) and evidence.data["guarded"] == guarded


def test_it_proves_the_value_of_a_best_path():
    problem = cases.two_ways()
    for target in (None, 27.0, cases.best(problem)):
        assert BOUNDS["all-paths"].evidence(problem, NEVER, None, target).value == pytest.approx(cases.best(problem))


def test_it_bounds_heuristics():
    problem = UncertainPath(graph_of(WORKED), 1e-6)
    best = wb.solve(problem).objective
    solution = wb.solve(problem, heuristic="least-mean")
    assert solution.objective > best
    assert solution.bound == pytest.approx(best)
    assert (solution.bound_kind, solution.status) == ("verified", "feasible")


def test_the_bound_alone():
    assert wb.bound(UncertainPath(graph_of(WORKED), 0.5)).bound == pytest.approx(150.0)


@pytest.mark.parametrize(
    ("name", "problem", "missing"),
    [
        ("guarded-walks", cases.two_ways(), "objective:reward-per-risk"),
        ("all-paths", cases.ring(), "objective:risk"),
        ("path-potentials", wb.read("demo-tiny"), "routing problems"),
    ],
)
def test_what_is_not_its_business_is_named(name, problem, missing):
    assert BOUNDS[name].missing(problem) == {missing}
