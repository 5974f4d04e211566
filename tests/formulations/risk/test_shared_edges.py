import math

import numpy as np
import pytest
from coded import coded
from scipy.stats import multivariate_normal
from uncertain_graphs import CROSSED, WORKED, all_paths, graph_of, named, random_graph

from waybound.formulations.risk.path_sets import PathSet, cheaper_probability
from waybound.formulations.risk.shared_edges import SHIFTS, JointCosts, _by_shift, joint_probabilities, sampled_probabilities
from waybound.instances.errors import InputError, UsageError


def orthant_probability(upper, covariance):
    """P(Z <= upper), and its standard error."""
    shares = _by_shift(upper, covariance)
    return float(shares.mean()), float(shares.std(ddof=1) / math.sqrt(SHIFTS))


def at_start(edges, *first, **options):
    """Joint costs and groups of all paths, by the vertex after the start; ``first`` gives the order of the groups."""
    g = graph_of(edges)
    paths = [p for p in all_paths(g) if named(g, p) not in options.get("without", ())]
    return JointCosts.of_paths(g, paths), [first.index(g.vertex_name(p[1])) for p in paths]


def test_the_diamond_whose_second_stage_cancels():
    edges = [("S", "a", 0, 0), ("S", "b", 0, 0), ("a", "m", 1, 1), ("b", "m", 2, 2), ("m", "c", 1.5, 1), ("m", "d", 1, 3), ("c", "G", 0, 0),
             ("d", "G", 0, 0)]  # fmt: skip
    costs, groups = at_start(edges, "a", "b")
    chance, _ = joint_probabilities(costs.mean, costs.covariance, groups)
    assert chance == pytest.approx([0.718149, 1 - 0.718149], abs=1e-5)
    separate = PathSet.of([(2.5, 2), (2, 4)]), PathSet.of([(3.5, 3), (3, 5)])
    assert cheaper_probability(*separate) == pytest.approx(0.649879, abs=1e-6)


def test_the_worked_example_with_shared_edges():
    costs, groups = at_start(WORKED, "A", "B")
    assert joint_probabilities(costs.mean, costs.covariance, groups)[0][0] == pytest.approx(0.44461, abs=1e-4)
    g = graph_of(WORKED)
    for prefix, cheaper, expected in (("SB", 0, 0.32824), ("SBC", 1, 0.34866)):  # the direct way, the way by D
        k = len(prefix)
        paths = [p[k - 1 :] for p in all_paths(g) if named(g, p).replace("-", "").startswith(prefix)]
        left = JointCosts.of_paths(g, paths)
        direct = [int(g.vertex_name(p[1]) != "G") for p in paths]
        assert joint_probabilities(left.mean, left.covariance, direct)[0][cheaper] == pytest.approx(expected, abs=1e-4)


def test_sets_of_paths_that_share_an_edge_with_each_other():
    costs, groups = at_start(CROSSED, "a", "b", without=("S-a-b-G",))
    exact = joint_probabilities(costs.mean, costs.covariance, groups)[0][0]
    assert exact == pytest.approx(0.68601, abs=2e-4)
    drawn, error = sampled_probabilities(costs, groups, 200_000, np.random.default_rng(1))
    assert abs(drawn[0] - exact) <= 4 * error[0]
    assert cheaper_probability(PathSet.of([(3, 5)]), PathSet.of([(5, 3), (5, 3)])) == pytest.approx(0.651216, abs=1e-6)


@pytest.mark.slow
def test_random_graphs_agree_with_sampling_and_overlap_is_overrated_by_independence():
    for seed in range(3):
        g = random_graph(np.random.default_rng(seed), 5, 0.6)
        paths = list(all_paths(g))[:12]
        heads = sorted({p[1] for p in paths})
        groups = [heads.index(p[1]) for p in paths]
        costs = JointCosts.of_paths(g, paths)
        chance, error = joint_probabilities(costs.mean, costs.covariance, groups)
        drawn, spread = sampled_probabilities(costs, groups, 100_000, np.random.default_rng(seed))
        assert chance.sum() == pytest.approx(1.0, abs=1e-3)
        assert (np.abs(chance - drawn) <= 4 * spread + 4 * error + 1e-6).all()


def test_observed_costs_are_no_longer_random():
    g = graph_of(WORKED)
    observed = np.full(g.num_edges, np.nan)
    observed[g.edges_of((g.start, g.vertex_numbers["B"]))] = 47.0
    costs = JointCosts.of_paths(g, [p for p in all_paths(g) if p[1] == g.vertex_numbers["B"]], observed)
    assert sorted(costs.mean) == [148.0, 149.0, 150.0, 151.0]
    assert sorted(costs.covariance.diagonal()) == [6.0, 7.0, 9.0, 11.0]


def test_the_two_directions_of_an_edge_are_one_random_cost():
    edges = [("S", "a", 1, 2), ("S", "b", 1, 3), ("a", "b", 1, 5), ("b", "a", 1, 5), ("a", "G", 1, 1), ("b", "G", 1, 1)]
    ways = [(0, 1, 2, 3), (0, 2, 1, 3)]
    own, shared = (JointCosts.of_paths(graph_of(edges, variable=v), ways) for v in (None, [0, 1, 2, 2, 3, 4]))
    assert (own.covariance[0, 1], shared.covariance[0, 1]) == (0.0, 5.0)
    assert (own.covariance.diagonal() == shared.covariance.diagonal()).all()


def test_paths_of_the_same_cost_share():
    same = np.array([[1.0, 1.0], [1.0, 1.0]])
    assert joint_probabilities([3, 3], same, [0, 1])[0].tolist() == [0.5, 0.5]
    assert joint_probabilities([3, 4], same, [0, 1])[0].tolist() == [1.0, 0.0]
    chance, _ = sampled_probabilities(JointCosts(np.array([3.0, 3.0]), np.ones((2, 1)), np.ones(1)), [0, 1], 100, np.random.default_rng(1))
    assert chance.tolist() == [0.5, 0.5]


@pytest.mark.parametrize("size", [2, 3, 6, 10])
def test_orthants_agree_with_scipy(size):
    rng = np.random.default_rng(size)
    root = rng.normal(size=(size, size))
    covariance, upper = root @ root.T, rng.normal(size=size)
    p, error = orthant_probability(upper, covariance)
    assert p == pytest.approx(multivariate_normal(cov=covariance).cdf(upper), abs=max(1e-4, 4 * error))


def test_orthants_of_singular_covariances():
    rho = 0.3
    assert orthant_probability(np.zeros(2), np.array([[1, rho], [rho, 1]]))[0] == pytest.approx(
        0.25 + math.asin(rho) / (2 * math.pi), abs=1e-5
    )
    line = np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])  # x, -x, y
    assert orthant_probability(np.array([1.0, 1.0, 0.0]), line)[0] == pytest.approx(0.5 * math.erf(1 / math.sqrt(2)), abs=2e-4)
    assert orthant_probability(np.zeros(0), np.zeros((0, 0))) == (1.0, 0.0)


def test_too_many_paths_and_edges_that_do_not_exist_are_refused():
    with pytest.raises(UsageError, match="61 paths are too many to compare exactly"):
        joint_probabilities(np.zeros(61), np.eye(61), np.zeros(61, int))
    with pytest.raises(InputError, check=coded("unknown-name")):
        JointCosts.of_paths(graph_of(WORKED), [(0, 4)])
