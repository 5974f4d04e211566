import math

import numpy as np
import pytest
from uncertain_graphs import WORKED, all_paths, graph_of, random_graph

from waybound import InputError, UncertainPath
from waybound.formulations.evidence import CHECKERS
from waybound.formulations.stop import NEVER
from waybound.solvers.engines.risk.supported_paths import supported_paths

check = CHECKERS["path-potentials"]


def optimum(problem):
    return min(problem.value(*moments) for moments in all_paths(problem.graph).values())


@pytest.mark.parametrize("whole", [False, True])
def test_no_evidence_passes_the_optimum_and_that_of_the_search_meets_it(whole):
    rng = np.random.default_rng(3)
    for _ in range(60):
        problem = UncertainPath(random_graph(rng, int(rng.integers(2, 7)), whole=whole), float(rng.choice([0.5, 0.3, 0.01, 1e-6])))
        best = optimum(problem)
        data = supported_paths(problem, NEVER).evidence(problem).data
        assert check(problem, data) == pytest.approx(best, rel=1e-12, abs=1e-12)
        assert check(problem, data) <= best
        wild = {
            "weights": [(rng.uniform(0, 2, 2) * (rng.random(2) < 0.8)).tolist() for _ in data["weights"]],
            "potentials": [(np.array(p) * rng.uniform(0, 3) + rng.normal(0, 2, len(p))).tolist() for p in data["potentials"]],
        }
        mixed = {key: data[key] + wild[key] for key in data}
        assert check(problem, wild) <= best
        assert check(problem, mixed) <= best
        assert check(problem, mixed) >= check(problem, data) * (1.0 - 1e-12)  # what else it holds costs nothing


@pytest.mark.parametrize("scale", [2.0**-40, 1.0, 2.0**40])
def test_units_do_not_matter(scale):
    problem = UncertainPath(graph_of([(a, b, m * scale, v * scale * scale) for a, b, m, v in WORKED]), 0.05)
    evidence = supported_paths(problem, NEVER).evidence(problem)
    assert check(problem, evidence.data) == pytest.approx(optimum(UncertainPath(graph_of(WORKED), 0.05)) * scale, rel=1e-13)


def test_nothing_proves_no_more_than_that_costs_are_not_negative():
    problem = UncertainPath(graph_of(WORKED), 0.05)
    zeros, size = [0.0] * 7, problem.graph.num_vertices
    for data in (
        {"weights": [], "potentials": []},
        {"weights": [[1.0, 1.0]], "potentials": [zeros]},
        {"weights": [[-1.0, 0.0]], "potentials": [zeros]},
        {"weights": [[1.0, 0.0]], "potentials": [[1e308] * (size - 1) + [-1e308]]},
        {"weights": [[1e-320, 1.0]], "potentials": [list(range(size))]},
        {"weights": [[1e300, 1e300]], "potentials": [[-1e300, *[1e300] * (size - 1)]]},
    ):
        assert 0.0 <= check(problem, data) <= optimum(problem)
        assert math.isfinite(check(problem, data))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({}, "evidence needs lists weights and potentials of one length"),
        ({"weights": [[1, 0]], "potentials": []}, "evidence needs lists"),
        ({"weights": [[1]], "potentials": [[0] * 7]}, "'weights' has the wrong length; expected 2"),
        ({"weights": [[1, 0]], "potentials": [[0] * 6]}, "'potentials' has the wrong length; expected 7"),
        ({"weights": [[1, math.inf]], "potentials": [[0] * 7]}, "weights"),
        ({"weights": [[1, 0]] * 10_001, "potentials": [[0] * 7] * 10_001}, "too many weights"),
    ],
)
def test_evidence_of_another_shape_is_refused(data, message):
    with pytest.raises(InputError, match=message):
        check(UncertainPath(graph_of(WORKED), 0.05), data)
