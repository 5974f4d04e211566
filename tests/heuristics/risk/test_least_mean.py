from uncertain_graphs import WORKED, graph_of, named

import waybound as wb
from waybound.formulations.risk.uncertain_path import UncertainPath


def test_at_one_half_it_is_optimal_and_says_so():
    solution = wb.solve(UncertainPath(graph_of(WORKED), 0.5), heuristic="least-mean")
    assert (solution.objective, solution.certificate.guarantee.ratio) == (150.0, 1.0)


def test_elsewhere_it_guarantees_nothing():
    solution = wb.solve(UncertainPath(graph_of(WORKED), 1e-6), heuristic="least-mean")
    assert named(solution.problem.graph, solution.answer) == "S-A-G"
    assert solution.certificate.guarantee is None
