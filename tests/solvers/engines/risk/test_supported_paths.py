import numpy as np
import pytest
from uncertain_graphs import WORKED, all_paths, graph_of, named, random_graph

import waybound as wb
from waybound import UncertainPath, UnsupportedError
from waybound.formulations.stop import NEVER, Stop
from waybound.solvers.backend import BACKENDS, Control, Options
from waybound.solvers.engines.risk.supported_paths import shortest_path, supported_paths


@pytest.mark.parametrize("whole", [False, True])
def test_its_best_is_that_of_all_paths(whole):
    rng = np.random.default_rng(11)
    for _ in range(60):
        problem = UncertainPath(random_graph(rng, int(rng.integers(2, 8)), whole=whole), float(rng.uniform(1e-9, 0.5)))
        result = supported_paths(problem, NEVER)
        best = min(problem.value(*moments) for moments in all_paths(problem.graph).values())
        assert result.complete
        assert problem.evaluate(result.best.path).feasible
        assert problem.evaluate(result.best.path).values[0] == pytest.approx(best, rel=1e-12, abs=1e-12)


def test_the_answer_changes_with_the_risk():
    g = graph_of(WORKED)
    result = {risk: named(g, supported_paths(UncertainPath(g, risk), NEVER).best.path) for risk in (0.5, 0.05, 1e-6, 1e-12)}
    assert result == {0.5: "S-A-G", 0.05: "S-A-G", 1e-6: "S-B-C-D-G", 1e-12: "S-B-C-D-E-G"}


def test_edges_of_no_cost_are_edges():
    g = graph_of([("S", "a", 0, 0), ("a", "G", 0, 0), ("S", "G", 1, 0)])
    assert named(g, shortest_path(g, (1.0, 0.0)).path) == "S-a-G"
    assert supported_paths(UncertainPath(g, 0.1), NEVER).best.least == 0.0


def test_cut_short_it_says_so_and_what_it_has_holds():
    problem = UncertainPath(graph_of(WORKED), 1e-6)
    stop = Stop()
    stop.ask()
    result = supported_paths(problem, stop)
    assert not result.complete
    assert problem.evaluate(result.best.path).feasible


def test_it_proves_its_optimum():
    solution = wb.solve(UncertainPath(graph_of(WORKED), 1e-6))
    assert (solution.solver, solution.status, solution.bound_kind) == ("supported-paths", "optimal", "verified")
    assert solution.gap == pytest.approx(0.0, abs=1e-9)
    assert named(solution.problem.graph, solution.answer) == "S-B-C-D-G"
    assert solution.certificate.bound == pytest.approx(solution.objective)


def test_both_engines_agree():
    rng = np.random.default_rng(9)
    for _ in range(5):
        problem = UncertainPath(random_graph(rng, 25, 0.2), float(rng.uniform(1e-6, 0.5)))
        values = [wb.solve(problem, solver, bound_time=0).objective for solver in ("supported-paths", "non-dominated-paths")]
        assert values[0] == pytest.approx(values[1], rel=1e-12)


def test_asked_to_stop_it_hands_over_what_it_has():
    control = Control()
    control.stop()
    raw = BACKENDS["supported-paths"]().run(UncertainPath(graph_of(WORKED), 1e-6), Options(), control)
    assert (raw.status, raw.limit, raw.bound) == ("feasible", "interrupt", None)
    assert raw.evidence


def test_other_families_are_refused():
    with pytest.raises(UnsupportedError, match="routing problems"):
        BACKENDS["supported-paths"]().run(wb.read("demo-tiny"), Options(), Control())
