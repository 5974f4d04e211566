"""Graphs with risk as JSON: every element there and back, and errors that name the key."""

import numpy as np
import pytest
import risky_cases as cases

from waybound.instances.document import dump_json, parse_json
from waybound.instances.errors import InputError, UsageError
from waybound.instances.kinds import KINDS
from waybound.instances.risk.element_files import ELEMENTS
from waybound.instances.risk.elements import AccessRisk, LengthRisk, LocaleRisk, MoveRisk, TurnRisk
from waybound.instances.risk.tether import Tether
from waybound.instances.risk.traverse_elements import CollectedRisk, FunctionRisk, TetherRisk, TravelledRisk

KIND = KINDS["risky-graph"]


def everything():
    elements = [
        LocaleRisk([0.1, 0.2, 0.3], "dust"), LengthRisk(0.1, "linear"), TurnRisk(0.02, "norm"), AccessRisk([1, 2, 3], 0.1, 0.2),
        MoveRisk([-1, 0], [0, 1], [1, 2], [0.5, 0.25]), CollectedRisk([True, False, True], [[0.0, 0.1, 0.2], [0.3, 0.4, 0.5]]),
        TravelledRisk(0.1, 2.0), TetherRisk(Tether((0.5, 0.5), [[1, 1, 2, 2]], 0.25), 0.01, 0.03),
    ]  # fmt: skip
    return cases.graph(
        [(0, 1), (1, 2)], elements, goals=(2,), rewards=[0, 0.5, 1], discount=0.5, positions=[(0, 0), (0.1, 0), (0.2, 0.1)],
        obstacles=[[1, 1, 2, 2]], state_names=("a", "b", "c"), objective="risk", notes=("drawn by hand",),
    )  # fmt: skip


def test_every_element_comes_back_the_same():
    graph = everything()
    assert {element.kind for element in graph.elements} == set(ELEMENTS)
    again = KIND.decode(parse_json(dump_json(KIND.encode(graph))))
    assert again.digest() == graph.digest()
    assert (again.state_names, again.notes, again.obstacles.tolist()) == (graph.state_names, graph.notes, graph.obstacles.tolist())
    assert [e.label for e in again.elements] == [e.label for e in graph.elements]


def test_places_in_space_have_three_coordinates():
    graph = cases.graph([(0, 1)], [LengthRisk(0.1)], goals=(1,), positions=[(0, 0, 0), (1, 1, 1)])
    assert np.array_equal(KIND.decode(KIND.encode(graph)).positions, graph.positions)


def test_functions_cannot_be_written():
    with pytest.raises(UsageError, match="mine is a function of one's own, which files cannot hold"):
        KIND.encode(cases.graph([(0, 1)], [FunctionRisk(lambda path: 0.0, "mine")]))


def changed(**given):
    data = KIND.encode(everything())
    data.update(given)
    return data


def element(**given):
    return changed(elements=[given])


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (changed(problem="tsp"), "graphs with risk allow one problem"),
        (changed(conditional="yes"), "conditional must be true or false"),
        (changed(states={"count": 3, "x": [0, 1, 2]}), "states has x alone"),
        (changed(moves={"tail": [0], "head": [1, 2]}), "moves.head has a wrong length"),
        (changed(states={"count": 0}), "states.count must be a whole number"),
        (element(kind="luck"), r"elements\[0\] is no risk element; expected locale, length, .*; found 'luck'"),
        (element(kind=["locale"]), r"elements\[0\] is no risk element; expected locale, length, .*; found a list"),
        (changed(elements=[3]), r"elements\[0\] is no risk element"),
        (element(kind="locale"), r"elements\[0\] is incomplete: missing 1 required positional argument: 'risk'"),
        (element(kind="locale", risk=[0.1, 0.2, 3]), r"risks of locale must lie in \[0, 1\]; found 3 in row 3"),
        (element(kind="locale", risk=[0.1]), r"elements\[0\].risk has a wrong length; expected 3; found 1"),
        (element(kind="turn", rate=0.1, speed=2), r"elements\[0\] has an unknown key 'speed'"),
        (element(kind="moves", before=["a"], state=[0], after=[1], risk=[0.1]), r"elements\[0\].before\[0\] must be a whole number"),
        (element(kind="tether", obstacles=[]), r"elements\[0\] is incomplete"),
    ],
)
def test_what_is_wrong_is_named_by_its_key(data, message):
    with pytest.raises(InputError, match=message):
        KIND.decode(data)
