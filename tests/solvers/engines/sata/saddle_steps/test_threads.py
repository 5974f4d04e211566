from __future__ import annotations

import numpy as np
import pytest

from waybound import BottleneckSATA
from waybound.reports.benchmarks.saddle import FAMILIES, joined
from waybound.solvers.backend import Control, Options
from waybound.solvers.engines.sata.saddle import Saddle
from waybound.solvers.engines.sata.saddle_steps import threads
from waybound.solvers.engines.sata.saddle_steps.game import Game, RegretMatching
from waybound.solvers.engines.sata.saddle_steps.halpern import HalpernPrimalDual
from waybound.solvers.engines.sata.saddle_steps.normal_matrix import NormalMatrix
from waybound.solvers.engines.sata.saddle_steps.threads import Threads

COUNTS = (1, 2, 3)


@pytest.fixture(autouse=True)
def shared(monkeypatch):
    """Threads share loops of any size."""
    monkeypatch.setattr(threads, "LEAST_SHARED", 0.0)


def same(*several) -> bool:
    return all(one.tobytes() == several[0].tobytes() for one in several)


@pytest.mark.parametrize("count", [1, 2, 3, 7])
def test_parts_are_all_rows_once_with_as_many_entries_each(count):
    starts = np.concatenate([[0], np.cumsum(np.random.default_rng(count).integers(0, 9, 500))])
    parts = Threads(count, 1.0).cut(starts)
    assert [k for begin, end in parts for k in range(begin, end)] == list(range(500))
    held = [starts[end] - starts[begin] for begin, end in parts]
    assert max(held) - min(held) <= 2 * 8


def test_more_threads_than_rows_leave_some_idle():
    parts = Threads(4, 1.0).cut(np.array([0, 3, 5]))
    assert len(parts) == 4 and [k for begin, end in parts for k in range(begin, end)] == [0, 1]


def test_small_loops_are_left_to_one_thread(monkeypatch):
    monkeypatch.setattr(threads, "LEAST_SHARED", 1e5)
    assert [Threads(2, entries).count for entries in (99_999.0, 100_000.0)] == [1, 2]


@pytest.mark.parametrize("method", [HalpernPrimalDual, RegretMatching])
@pytest.mark.parametrize("family", ["expander", "planted", "torus"])
def test_first_order_steps_are_the_same_to_the_bit(method, family, make_game):
    means = []
    for count in COUNTS:
        made = make_game(FAMILIES[family](900))
        playing = method(Game(made.graph, made.record, made.limits, made.programs, count))
        playing.run(90)
        means.append(playing.means())
    shares, prices = zip(*means, strict=True)
    assert same(*shares) and same(*prices)


@pytest.mark.parametrize("kind", [0, 1])
def test_solves_of_the_interior_point_are_the_same_to_the_bit(kind, make_game):
    graph, found = FAMILIES["torus"](900), []
    rng = np.random.default_rng(0)
    scaling, prices, given = rng.uniform(0.1, 10.0, graph.num_actions), rng.uniform(0.5, 1.5, 900) / 900, rng.normal(size=900)
    for count in COUNTS:
        made = make_game(graph)
        matrix = NormalMatrix.of(Game(graph, made.record, made.limits, made.programs, count))
        assert matrix is not None
        matrix.preconditioners.chosen = kind
        system = matrix.system(scaling, prices, np.full(900, 1e-6))
        found.append(system.solve(given, 1e-9, made.limits))
    assert same(*found) and np.isfinite(found[0]).all()


@pytest.mark.parametrize(
    "problem", [*(BottleneckSATA(FAMILIES[name](900), fractional=True) for name in ("expander", "torus")), joined(2000)]
)
def test_answer_and_bound_are_the_same_to_the_bit(problem):
    results = [Saddle().run(problem, Options(gap=1e-4, threads=count), Control()) for count in COUNTS]
    assert same(*(result.answer for result in results))
    assert len({(result.bound, str(result.statistics), str(result.evidence)) for result in results}) == 1
    assert results[0].limit == "gap"
