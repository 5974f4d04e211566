import math

import numpy as np
import pytest
import risky_cases as cases
from coded import coded
from risky_cases import BENT, LINE, risks

from waybound import InputError, RiskyPath
from waybound.instances.risk.tether import Tether
from waybound.instances.risk.traverse_elements import CollectedRisk, FunctionRisk, TetherRisk, TravelledRisk


def test_mud_counts_from_the_state_after_it():
    table = np.array([[0.0] * 5, [0.1] * 5, [0.2] * 5])
    assert risks(CollectedRisk([False, True, False, True, True], table)) == [0.0, 0.0, 0.1, 0.1, 0.2]
    assert risks(CollectedRisk([True] * 5, table)) == [0.0, 0.1, 0.2, 0.2, 0.2]


def test_memories_are_ordered_only_where_more_is_never_safer():
    growing = CollectedRisk([True], [[0.0], [0.1]])
    assert growing.no_worse(0, 1) and not growing.no_worse(1, 0)
    falling = CollectedRisk([True], [[0.1], [0.0]])
    assert not falling.no_worse(0, 1) and falling.no_worse(1, 1)


def test_the_way_travelled_is_free_at_first():
    expected = [
        0, 0, -math.expm1(-0.1 * (math.sqrt(2) - 0.5)), -math.expm1(-0.1 * (math.sqrt(2) + 0.5)), -math.expm1(-0.1 * (math.sqrt(2) + 2.5)),
    ]  # fmt: skip
    assert risks(TravelledRisk(0.1, 1.5)) == pytest.approx(expected)


def test_a_tether_charges_length_and_contacts_and_ends_where_it_cannot_follow():
    at = np.array([(3, 0), (3, 1), (3, 2)], dtype=float)
    element = TetherRisk(Tether((0, 0), [[1, 1, 2, 2]]), 0.01, 0.03)
    assert risks(element, at, LINE[:2]) == pytest.approx([0.03, 0.0316227766, 1 - (1 - 0.0365028154) * 0.97])
    assert risks(TetherRisk(Tether((0, 0), []), 1e-17), at, LINE[:2])[0] == pytest.approx(3e-17, rel=1e-15, abs=0.0)
    assert risks(element, np.array([(0, 1.5), (3, 1.5)]), LINE[:1])[1] == 1.0


def test_functions_of_ones_own_see_the_whole_path():
    assert risks(FunctionRisk(lambda path: 0.1 * (path.count(1) + len(path) - 1), "own")) == pytest.approx([0, 0.2, 0.3, 0.4, 0.5])
    with pytest.raises(InputError, match=r"the risk of own must lie in \[0, 1\]; found 2 at path \(0,\)"):
        risks(FunctionRisk(lambda path: 2.0, "own"))


@pytest.mark.parametrize("seed", range(3))
def test_the_least_risk_is_never_above_the_risk(seed):
    rng = np.random.default_rng(seed)
    table = np.sort(rng.random((3, 5)), axis=0)
    for element in (CollectedRisk(rng.random(5) < 0.5, table), TravelledRisk(0.3), TetherRisk(Tether((5, 5), []), 0.05)):
        graph = cases.graph(LINE, [element], states=5, goals=(4,), positions=BENT)
        least = graph.least_risks(element, [-1, -1, 0, 1, 2], [-1, 0, 1, 2, 3], range(5))
        assert (least <= np.array(RiskyPath(graph).risks(range(5))[element.label]) + 1e-12).all()


def test_what_is_no_level_is_refused():
    with pytest.raises(InputError, check=coded("wrong-shape")):
        CollectedRisk([True], [0.1])


@pytest.mark.parametrize(
    ("element", "given", "message"),
    [
        (CollectedRisk([True], [[0.1, 0.1, 0.1]]), {}, "places of collected must be one a state"),
        (TetherRisk(Tether((0, 0), [])), {"positions": np.zeros((3, 3))}, "tether bends in the plane"),
        (TravelledRisk(0.1), {}, "risk element travelled needs positions of the states"),
    ],
)
def test_what_does_not_fit_the_states_is_refused(element, given, message):
    with pytest.raises(InputError, match=message):
        cases.graph([(0, 1), (1, 2)], [element], **given)
