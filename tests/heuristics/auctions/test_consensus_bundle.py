"""Bundles by consensus on task allocation: answers on every graph, what is counted, and options."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from task_problems import OBJECTIVES, drawn, line

import waybound as wb
from waybound.formulations.auctions.task_allocation import TaskAllocation
from waybound.formulations.stop import Stop
from waybound.heuristics.auctions.consensus_bundle import GRAPHS, consensus_bundle, graph_of
from waybound.heuristics.heuristic import Context
from waybound.reports.ratios.judging import run_heuristic
from waybound.solvers.linear_programs import LinearPrograms

CBBA = "consensus-bundle"


@pytest.mark.parametrize(("objective", "communication"), list(itertools.product(OBJECTIVES, GRAPHS)))
def test_robots_agree_over_every_graph(objective, communication):
    rng = np.random.default_rng(1)
    for k in range(8):
        problem = TaskAllocation(drawn(rng, robots=5, tasks=8, matrix=k % 2 == 1), objective)
        found = run_heuristic(problem, CBBA, {"communication": communication}, 1)
        assert problem.evaluate(found.answer).feasible
        assert not found.message and found.guarantee is None


def test_graphs_have_the_links_of_their_names():
    assert [int(graph_of(name, 5).sum()) for name in GRAPHS] == [20, 10, 8, 8]
    assert not graph_of("ring", 1).any() and int(graph_of("ring", 2).sum()) == 2


def test_a_longer_line_takes_more_rounds_and_each_of_them_a_message_a_link():
    rounds = []
    for robots in (2, 8):
        found = run_heuristic(line(range(robots), [robots - 0.9]), CBBA, {"communication": "line"}, 1)
        rounds.append(found.statistics["rounds"])
        assert found.statistics["messages"] == rounds[-1] * 2 * (robots - 1)
    assert rounds[1] > rounds[0]


def test_bundles_may_be_small_and_what_is_left_is_inserted():
    problem = line([0, 10], [1, 2, 3, 9])
    found = run_heuristic(problem, CBBA, {"most": 1}, 1)
    assert problem.evaluate(found.answer).feasible and "2 tasks that nobody had room for" in found.message


def test_cut_short_every_task_is_done_all_the_same():
    context = Context(np.random.default_rng(1), 0.0, None, lambda answer: None, Stop(), LinearPrograms())
    found = consensus_bundle(line([0, 5], [1, 2, 3]), context)
    assert found.limit == "time" and line([0, 5], [1, 2, 3]).evaluate(found.answer).feasible


@pytest.mark.parametrize("options", [{"communication": "pigeons"}, {"most": 0}, {"most": "two"}])
def test_other_options_are_refused(options):
    with pytest.raises(wb.UsageError):
        run_heuristic(line([0], [1]), CBBA, options, 1)
