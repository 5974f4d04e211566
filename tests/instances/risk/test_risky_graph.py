import networkx as nx
import numpy as np
import pytest
import risky_cases as cases
from coded import coded

from waybound.instances.errors import Code, InputError
from waybound.instances.risk.elements import LengthRisk, LocaleRisk
from waybound.instances.risk.risky_graph import RiskyGraph, named_states
from waybound.instances.risk.tether import Tether
from waybound.instances.risk.traverse_elements import TetherRisk

RISK = LocaleRisk([0.1, 0.2, 0.3])


def test_moves_are_sorted_and_neighbours_found():
    graph = cases.graph([(2, 0), (0, 2), (0, 1)], [RISK])
    assert (graph.tail.tolist(), graph.head.tolist()) == ([0, 0, 2], [1, 2, 0])
    assert [graph.neighbours(state) for state in range(3)] == [[1, 2], [], [0]]


def test_the_objective_follows_from_goals_and_rewards():
    assert cases.graph([(0, 1), (1, 2)], [RISK], goals=(2,), rewards=[0, 0, 1]).objective == "risk"
    assert cases.graph([(0, 1), (1, 2)], [RISK], rewards=[0, 0, 1]).objective == "reward-per-risk"


def test_networkx_graphs_undirected_and_directed():
    ring = nx.cycle_graph(["a", "b", "c"])
    ring.nodes["b"].update(reward=2.0)
    made = RiskyGraph.from_networkx(ring, [RISK], "a", conditional=True, goals=["c"])
    assert (len(made.tail), made.goals, made.state_names, made.rewards.tolist()) == (6, (2,), ("a", "b", "c"), [0, 2, 0])
    for node, place in zip(ring, [(0, 0), (1, 0), (0, 1)], strict=True):
        ring.nodes[node]["pos"] = place
    assert RiskyGraph.from_networkx(ring.to_directed(), [RISK], "a", conditional=True).positions.tolist() == [[0, 0], [1, 0], [0, 1]]
    with pytest.raises(InputError, match="no such node; found 'z'"):
        RiskyGraph.from_networkx(ring, [RISK], "z", conditional=True)


def test_everything_that_values_depend_on_is_in_the_digest():
    given = {"goals": (2,), "rewards": [0, 1, 1]}
    plain = cases.graph([(0, 1), (1, 2)], [RISK], **given)
    changes = [
        {"goals": (1,)}, {"rewards": [0, 1, 2]}, {"discount": 0.5}, {"objective": "hazard"}, {"conditional": False},
        {"start": 1}, {"positions": np.zeros((3, 2))},
    ]  # fmt: skip
    digests = {cases.graph([(0, 1), (1, 2)], [RISK], **{**given, **change}).digest() for change in changes}
    digests.add(cases.graph([(0, 1), (1, 2)], [LocaleRisk([0.1, 0.2, 0])], **given).digest())
    assert len(digests | {plain.digest()}) == len(changes) + 2
    assert plain.digest() == cases.graph([(1, 2), (0, 1)], [RISK], **given, name="other").digest()


def test_risks_that_are_not_conditional_are_told():
    assert "not conditional" in cases.graph([(0, 1), (1, 2)], [RISK], conditional=False).notes[0]


@pytest.mark.parametrize(
    ("arcs", "given", "message"),
    [
        ([(0, 0)], {}, "move 0 leads from a state to itself"),
        ([(0, 1), (0, 1)], {}, "two moves lead from state 0 to state 1"),
        ([(0, 5)], {}, "head of move 1 does not exist; expected 0 to 2; found 5"),
        ([(0, 1)], {"start": 3}, "the start must be a state; expected 0 to 2"),
        ([(0, 1)], {"goals": (-1,)}, "the goal must be a state"),
        ([(0, 1)], {"conditional": "yes"}, "whether risks are conditional, true or false; found 'yes'"),
        ([(0, 1)], {"rewards": [0, -1, 0]}, "the reward of state 2 must be from 0"),
        ([(0, 1)], {"rewards": [0]}, "there must be one reward a state"),
        ([(0, 1)], {"discount": 1.5}, r"the discount must lie in \[0, 1\]; found '1.5'"),
        ([(0, 1)], {"objective": "luck"}, "the objective is unknown; expected risk, hazard, reward-per-risk"),
        ([(0, 1)], {"positions": [[0, 0]]}, "state positions must be two or three numbers each"),
        ([(0, 1)], {"state_names": ("a", "a", "b")}, "two states have the name 'a'"),
        ([(0, 1)], {"elements": [RISK, RISK]}, "two risk elements are labelled 'locale'"),
        ([(0, 1)], {"elements": [0.3]}, "elements must be risk elements; found float"),
        ([(0, 1)], {"elements": [LocaleRisk([0.1])]}, "one a state; expected 3"),
    ],
)
def test_what_is_no_graph_is_refused(arcs, given, message):
    elements = given.pop("elements", [RISK])
    with pytest.raises(InputError, match=message):
        cases.graph(arcs, elements, states=3, **given)


@pytest.mark.parametrize(
    ("arcs", "given", "code"),
    [
        ([(0, 0)], {}, "contradiction"),
        ([(0, 1), (0, 1)], {}, "duplicate"),
        ([(0, 1)], {"goals": (-1,)}, "unknown-name"),
        ([(0, 1)], {"conditional": "yes"}, "malformed"),
        ([(0, 1)], {"discount": 1.5}, "out-of-range"),
        ([(0, 1)], {"elements": [LocaleRisk([0.1])]}, "wrong-shape"),
        ([(0, 1)], {"elements": [LengthRisk(0.1)]}, "missing"),
        ([(0, 1)], {"elements": [TetherRisk(Tether((0, 0), []))], "positions": np.zeros((3, 3))}, "unsupported"),
    ],
)
def test_programs_are_told_what_is_wrong_by_a_code(arcs, given, code: Code):
    elements = given.pop("elements", [RISK])
    with pytest.raises(InputError, check=coded(code)):
        cases.graph(arcs, elements, states=3, **given)


def test_names_of_states():
    assert named_states(["a", "b"], ["b", "a"], "goal") == (1, 0)
    with pytest.raises(InputError, match="the goal 'c' is no state"):
        named_states(["a", "b"], ["c"], "goal")
