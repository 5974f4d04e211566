"""Guarantees on instances that hypothesis makes, and shrinks where one is broken: the failing test prints the instance as a file."""

import math

import numpy as np
import pytest
from draws import draws
from hypothesis import given, note, settings, strategies as st
from ratio_strategies import assignments, bottlenecks, selections

from waybound.formulations.evidence import Guarantee
from waybound.formulations.sata.bottleneck_sata import BottleneckSATA
from waybound.formulations.sata.selections import Selection
from waybound.heuristics.heuristic import Outcome
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.reports.ratios.judged_runs import judge, run_heuristic
from waybound.reports.ratios.optimum import optimum
from waybound.reports.studies.sata.local import degrees
from waybound.reports.studies.sata.selections import SHARES, greedy_ratio
from waybound.reports.studies.violations import instance_text

SHORT = settings(max_examples=draws(80))

THREE = ("cardinality", "partition", "knapsack")
GROUPED = st.one_of(selections("cardinality", "partition"), assignments())


def hold(problem, name, expected, **options):
    """Judge one run; every fault is a failure."""
    run = judge(problem, optimum(problem), run_heuristic(problem, name, options, 1), expected)
    if run.faults:
        note(instance_text(problem, f"{name} {options}"))
    assert not run.faults


def continuous_ratio(steps):
    return 1.0 / (1.0 - (1.0 + 1.0 / steps) ** -steps)


def local_ratio(problem, h, eps):
    delta_r, delta_t = degrees(problem)
    return delta_r * (1 + eps) * (1 + 1 / h) * (1 - 1 / delta_t)


@st.composite
def ordered(draw):
    """A problem under a partition matroid, and an order of its groups."""
    problem = draw(st.one_of(selections("partition"), assignments()))
    return problem, draw(st.permutations(range(len(problem.constraint.limits))))


CLAIMS = {
    "greedy": (GROUPED, lambda p: hold(p, "greedy", greedy_ratio(p))),
    "lazy-greedy": (GROUPED, lambda p: hold(p, "lazy-greedy", greedy_ratio(p))),
    "sequential-greedy": (ordered(), lambda drawn: hold(drawn[0], "sequential-greedy", 2.0, order=list(drawn[1]))),
    "continuous-greedy": (
        st.tuples(GROUPED, st.integers(1, 12)),
        lambda drawn: hold(drawn[0], "continuous-greedy", continuous_ratio(drawn[1]), steps=drawn[1]),
    ),
    "knapsack-greedy": (
        st.tuples(selections("knapsack"), st.integers(0, 3)),
        lambda drawn: hold(drawn[0], "knapsack-greedy", 1.0 / SHARES[drawn[1]], enumerate=drawn[1]),
    ),
    "brute-force": (st.one_of(selections(*THREE), assignments()), lambda p: hold(p, "brute-force", 1.0)),
    "local": (
        st.tuples(bottlenecks(), st.integers(1, 6), st.sampled_from([1e-4, 0.1, 1.0]), st.booleans()),
        lambda d: hold(d[0], "local", local_ratio(d[0], d[1], d[2]), h=d[1], eps=d[2], normalise=d[3], ball=d[3]),
    ),
    "local by steps": (
        st.tuples(bottlenecks(), st.integers(1, 4)),
        lambda drawn: hold(drawn[0], "local", (1.0, math.inf), h=drawn[1], search="step", ball=False),
    ),
}


@pytest.mark.share(2)
@pytest.mark.parametrize("examples", [draws(80), pytest.param(draws(3000), marks=pytest.mark.long)], ids=["some", "many"])
@pytest.mark.parametrize("name", CLAIMS)
def test_the_guarantee_holds_on_drawn_instances(name, examples):
    strategy, claim = CLAIMS[name]
    settings(max_examples=examples)(given(strategy)(claim))()


@SHORT
@given(GROUPED)
def test_lazy_greedy_has_the_value_of_greedy(problem):
    values = [problem.evaluate(run_heuristic(problem, name, {}, 1).answer).values[0] for name in ("greedy", "lazy-greedy")]
    note(instance_text(problem))
    assert values[0] == pytest.approx(values[1], rel=1e-12, abs=1e-12)


@SHORT
@given(bottlenecks())
def test_shares_are_worth_at_least_as_much_as_whole_actions(problem):
    note(instance_text(problem))
    assert optimum(problem).value >= optimum(BottleneckSATA(problem.graph)).value * (1 - 1e-9)


@pytest.mark.slow
def test_a_broken_guarantee_is_shrunk_and_printed_as_a_file():
    """A heuristic that takes the first elements and claims 1/2 is caught on an instance of two elements at most."""
    seen = {}

    @settings(max_examples=300, database=None)
    @given(selections("cardinality"))
    def claim(problem):
        outcome = Outcome(Selection(tuple(range(problem.constraint.limit))), Guarantee(2.0, "f(S) >= f(OPT) / 2", (), "nowhere"))
        run = judge(problem, optimum(problem), outcome, 2.0)
        if run.faults:
            seen["text"], seen["elements"] = instance_text(problem, run.faults[0][1]), problem.num_elements
        assert not run.faults

    with pytest.raises(AssertionError):
        claim()
    assert seen["elements"] == 2, "two elements suffice: the first without worth, the second with some"
    assert '"kind": "selection"' in seen["text"]
    assert "stated 2" in seen["text"]


def test_weights_of_any_size_keep_the_optimum_two_sided():
    for spread in (1e-6, 1.0, 1e6):
        rng = np.random.default_rng(4)
        weights = spread * rng.lognormal(0, 2, 12)
        graph = graph_of_edges(np.repeat(np.arange(3), 2), np.repeat(np.arange(6), 2), np.tile(np.arange(2), 6), weights)
        assert optimum(BottleneckSATA(graph, fractional=True)).value > 0
