import math
from types import SimpleNamespace

import numpy as np
import pytest
from coded import coded
from file_cases import check_refused

from waybound.instances.errors import InputError
from waybound.instances.risk.element import RiskElement, TraverseElement, placed, probabilities, rate_of


class Visited(TraverseElement):
    """As risky as the part of the states that were visited."""

    kind, label = "visited", "visited"

    def check(self, space):
        placed(self, space)

    def parts(self):
        return ()

    def begin(self, space, state):
        return frozenset({state}), 1.0 / space.num_states

    def step(self, space, memory, state, after):
        return memory | {after}, len(memory | {after}) / space.num_states


SPACE = SimpleNamespace(num_states=4, positions=np.arange(8.0).reshape(4, 2))


def test_an_element_is_none_before_it_tells_its_risks():
    check_refused(TypeError, "abstract", RiskElement)
    check_refused(TypeError, "begin", type("Idle", (TraverseElement,), {name: lambda self, space: None for name in ("check", "parts")}))


def test_a_memory_is_carried_on_and_no_worse_than_itself_alone():
    element = Visited()
    memory, first = element.begin(SPACE, 0)
    further, second = element.step(SPACE, memory, 0, 2)
    back, third = element.step(SPACE, further, 2, 0)
    assert (element.category, first, second, third) == ("traverse", 0.25, 0.5, 0.5)
    assert element.no_worse(further, back) and element.no_worse(back, further)
    assert not element.no_worse(memory, further) and not element.no_worse(further, memory)


def test_whatever_the_path_was_an_unknown_memory_proves_no_risk():
    ways = np.array([[-1, 0, 1], [0, 1, 2], [1, 2, 3]])
    assert Visited().least(SPACE, *ways.T).tolist() == [0.0, 0.0, 0.0]
    assert Visited().least(SPACE, *ways[:0].T).shape == (0,)


def test_probabilities_keep_their_shape_and_both_ends():
    made = probabilities("risks", [[0, 1], [0.25, 1e-300]])
    assert made.dtype == np.float64 and made.tolist() == [[0.0, 1.0], [0.25, 1e-300]]
    assert probabilities("risks", []).shape == (0,)


@pytest.mark.parametrize(
    ("values", "found"),
    [
        ([0.5, -1e-9, 2.0], "-1e-09 in row 2"),
        ([0.0, math.nextafter(1.0, 2.0)], "1 in row 2"),
        ([[0.0, 0.1], [0.2, 3.0]], "3 in row 2, column 2"),
    ],
)
def test_the_first_number_that_is_no_probability_is_named_with_its_place(values, found):
    with pytest.raises(InputError, match=rf"^risks must lie in \[0, 1\]; found {found}$"):
        probabilities("risks", values)


def test_a_rate_is_a_finite_number_of_at_least_0():
    assert (rate_of("the rate", 0), rate_of("the rate", 2), rate_of("the rate", 1e300)) == (0.0, 2.0, 1e300)
    assert isinstance(rate_of("the rate", 2), float)
    for wrong in (-1e-300, math.inf, math.nan, True, "1", None):
        with pytest.raises(InputError, check=coded("out-of-range")):
            rate_of("the rate", wrong)


def test_places_are_those_of_the_states_and_missed_where_there_are_none():
    element = Visited()
    assert placed(element, SPACE) is SPACE.positions
    element.check(SPACE)
    with pytest.raises(InputError, match=r"^risk element visited needs positions of the states$"):
        element.check(SimpleNamespace(num_states=4, positions=None))
