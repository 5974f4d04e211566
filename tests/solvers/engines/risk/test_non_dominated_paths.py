import math

import numpy as np
import pytest
from coded import coded
from uncertain_graphs import CROSSED, WORKED, all_paths, graph_of, named, random_graph

import waybound as wb
from waybound import UncertainPath, UnsupportedError, UsageError
from waybound.formulations.stop import Stop
from waybound.instances.generating import generate
from waybound.solvers.backend import BACKENDS, Control, Options
from waybound.solvers.engines.risk.non_dominated_paths import DOMINANCE, non_dominated_paths

Moments = tuple[float, float]

RULES = {
    "strict": lambda a, b: a[0] < b[0] and a[1] < b[1],
    "pareto": lambda a, b: a[0] <= b[0] and a[1] <= b[1] and a != b,
    "weak": lambda a, b: a[0] <= b[0] and a[1] <= b[1] and a != b,
}


def by_enumeration(graph, dominance):
    """Moments of the paths that no other dominates, ascending; of equal ones one under ``weak``."""
    every = list(all_paths(graph).values())
    left = [b for b in every if not any(RULES[dominance](a, b) for a in every)]
    return sorted(set(left) if dominance == "weak" else left)


def moments(found):
    return sorted(zip(found.means.tolist(), found.variances.tolist(), strict=True))


@pytest.mark.parametrize("dominance", DOMINANCE)
def test_sets_of_whole_moments_are_those_of_enumeration(dominance):
    rng = np.random.default_rng(5)
    for _ in range(80):
        g = random_graph(rng, int(rng.integers(2, 8)), whole=True)
        result = non_dominated_paths(g, dominance)
        assert moments(result) == by_enumeration(g, dominance)
        every = all_paths(g)
        assert [every[path] for path in result.paths] == list(zip(result.means, result.variances, strict=True))
        assert len(set(result.paths)) == len(result.paths)


def test_sets_of_continuous_moments_are_one_whatever_the_rule():
    rng = np.random.default_rng(6)
    for _ in range(30):
        g = random_graph(rng, int(rng.integers(2, 8)))
        for dominance in DOMINANCE:
            assert np.allclose(moments(non_dominated_paths(g, dominance)), by_enumeration(g, "weak"))


def test_the_reference_cases():
    g = graph_of(CROSSED)
    assert {rule: len(non_dominated_paths(g, rule).paths) for rule in DOMINANCE} == {"strict": 3, "pareto": 3, "weak": 2}
    assert named(g, non_dominated_paths(g).paths[0]) == "S-a-G"
    more = graph_of([*CROSSED, ("S", "G", 5, 4)])
    assert {rule: len(non_dominated_paths(more, rule).paths) for rule in DOMINANCE} == {"strict": 4, "pareto": 3, "weak": 2}
    worked = graph_of(WORKED)
    assert [named(worked, p) for p in non_dominated_paths(worked).paths] == ["S-A-G", "S-B-C-G", "S-B-G", "S-B-C-D-G", "S-B-C-D-E-G"]


def test_without_variances_one_path_is_left_that_of_the_least_mean():
    g = random_graph(np.random.default_rng(2), 30)
    plain = g.seen_from(g.start, g.mean, np.zeros(g.num_edges))
    result = non_dominated_paths(plain)
    assert len(result.paths) == 1
    assert result.means[0] == pytest.approx(g.costs_to(g.goal, g.mean)[g.start])


def test_without_variances_nothing_is_strictly_dominated():
    g = graph_of([(a, b, m, 0) for a, b, m, _ in WORKED])
    assert len(non_dominated_paths(g, "strict").paths) == len(all_paths(g)) == 5


def test_roadmaps_have_about_twenty_paths():
    sizes = []
    for seed in range(20):
        result = non_dominated_paths(generate("prm-graph", seed))
        sizes.append(len(result.paths))
        assert (np.diff(result.means) > 0).all()
        assert (np.diff(result.variances) < 0).all()
    assert 15 < np.mean(sizes) < 28


def test_cut_short_it_says_so():
    stop = Stop()
    stop.ask()
    result = non_dominated_paths(generate("prm-graph", 1), "weak", stop)
    assert not result.complete
    assert math.isfinite(result.labels)


def test_an_unknown_rule_is_refused():
    with pytest.raises(UsageError, match="dominance must be one of weak, pareto, strict", check=coded("unknown-name")):
        non_dominated_paths(graph_of(WORKED), "total")


def test_its_optimum_is_verified_by_potentials():
    solution = wb.solve(UncertainPath(graph_of(WORKED), 0.05), "non-dominated-paths")
    assert (solution.status, solution.bound_kind) == ("optimal", "verified")
    assert named(solution.problem.graph, solution.answer) == "S-A-G"


def test_without_bounds_it_is_its_own_word():
    solution = wb.solve(UncertainPath(graph_of(WORKED), 0.05), "non-dominated-paths", bound_time=0)
    assert (solution.status, solution.bound_kind) == ("optimal", "claimed")


def test_asked_to_stop_it_hands_over_what_it_has():
    control = Control()
    control.stop()
    raw = BACKENDS["non-dominated-paths"]().run(UncertainPath(generate("prm-graph", 1)), Options(), control)
    assert (raw.status, raw.limit, raw.bound) == ("feasible", "interrupt", None)


def test_other_families_are_refused():
    with pytest.raises(UnsupportedError):
        BACKENDS["non-dominated-paths"]().run(wb.read("demo-tiny"), Options(), Control())
