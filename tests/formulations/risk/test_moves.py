import math

import numpy as np
import pytest
import risky_cases as cases
from coded import coded

from waybound.formulations.evidence import CHECKERS
from waybound.formulations.risk import moves
from waybound.formulations.risk.moves import Memories, MoveGraph
from waybound.instances.errors import UsageError
from waybound.instances.risk.elements import LocaleRisk
from waybound.instances.risk.tether import Tether
from waybound.instances.risk.traverse_elements import CollectedRisk, TetherRisk


@pytest.mark.parametrize("seed", range(4))
def test_least_hazards_are_those_of_all_paths_without_traverse_risks_and_below_them_with(seed):
    for muddy in (False, True):
        problem = cases.random_map(np.random.default_rng(seed), muddy=muddy)
        least = np.full(9, math.inf)
        for path in cases.all_paths(problem):
            hazard = -math.log1p(-problem.evaluate(path).quantities["risk"])
            least[path[-1]] = min(least[path[-1]], hazard)
        reach = problem.moves.to_states()
        assert (reach <= least + 1e-12).all() and (muddy or reach == pytest.approx(least))
        to_goal = problem.moves.from_moves([8])
        assert to_goal[-1] + problem.moves.start_hazard == pytest.approx(reach[8])


def test_walks_of_equal_hazard_take_the_fewest_moves():
    graph = cases.graph([(0, 1), (1, 2), (2, 3), (0, 3)], [LocaleRisk([0.1, 0, 0, 0.2])], goals=(3,))
    assert MoveGraph(graph).walk(3) == (0, 3)
    assert MoveGraph(graph).walk(0) == (0,)
    apart = cases.graph([(0, 1)], [LocaleRisk([0, 0, 0])], states=3, goals=(1,))
    assert MoveGraph(apart).walk(2) is None


def test_certain_failures_are_no_moves():
    graph = cases.graph([(0, 1), (1, 2)], [LocaleRisk([0, 1, 0])], goals=(2,))
    assert np.isinf(MoveGraph(graph).to_states()[1:]).all()
    assert np.isfinite(MoveGraph(graph).with_any_risk().to_states()).all()


def test_no_walk_turns_straight_back():
    problem = cases.lattice(2, 2)
    moves_ = problem.moves
    tail, head = problem.graph.tail, problem.graph.head
    assert not (tail[moves_.first] == head[moves_.second]).any() and not (head[moves_.second] == 0).any()


def test_successors_hold_what_is_the_same_on_every_path():
    problem = cases.mud_costs()
    for move, (after, hazards) in enumerate(problem.moves.successors[:-1]):
        assert hazards == pytest.approx([1.0] * len(after)) and all(problem.graph.tail[b] == problem.graph.head[move] for b in after)
    assert len(problem.moves.successors[-1][0]) == 2


def test_prices_are_paid_at_every_state():
    problem = cases.ring()
    reach = problem.moves.priced(np.full(8, 0.25))
    ends = problem.graph.head == problem.graph.goals[0]
    assert reach[ends].min() == pytest.approx(11 / 20 + 4 * 0.25)  # fewer states, though the hazard is larger than 10 / 20


def test_evidence_proves_the_least_hazard():
    problem = cases.ring()
    assert CHECKERS["move-potentials"](problem, problem.moves.evidence(0.0).data) == pytest.approx(0.393469, abs=5e-7)


def test_graphs_with_too_many_pairs_are_refused(monkeypatch):
    monkeypatch.setattr(moves, "MOST_PAIRS", 10)
    with pytest.raises(UsageError, match="pairs of moves that follow each other; at most 10 are searched", check=coded("too-large")):
        MoveGraph(cases.lattice(3, 3).graph)


def test_equal_memories_have_one_number_and_less_mud_is_no_worse():
    memories = Memories(cases.mud_costs().graph)
    clean, _ = memories.step(memories.begin, 0, 2)
    muddy, _ = memories.step(memories.begin, 0, 1)
    assert clean == memories.begin != muddy
    assert memories.step(muddy, 5, 6)[1] == pytest.approx(9.0) and memories.step(clean, 5, 6)[1] == 0.0
    assert memories.no_worse(clean, muddy) and not memories.no_worse(muddy, clean)


def test_all_elements_are_remembered_together_and_certain_failure_is_infinite():
    at = np.array([(3, 0), (3, 2), (0, 1.5)])
    elements = [TetherRisk(Tether((0, 0), [[1, 1, 2, 2]]), 0.0, 0.03), CollectedRisk([True] * 3, [[0.0] * 3, [0.1] * 3])]
    memories = Memories(cases.graph([(0, 1), (1, 2)], elements, goals=(2,), positions=at))
    first, hazard = memories.step(memories.begin, 0, 1)
    assert hazard == pytest.approx(-math.log(0.97 * 0.9)) and not memories.no_worse(memories.begin, first)
    assert memories.step(first, 1, 2)[1] == math.inf
