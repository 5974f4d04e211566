import math

import numpy as np
import pytest
import risky_cases as cases
from risky_cases import LINE, risks

from waybound import InputError, RiskyPath
from waybound.instances.risk.elements import AccessRisk, LengthRisk, LocaleRisk, MoveRisk, TurnRisk


@pytest.mark.parametrize(
    ("measure", "expected"),
    [
        ("norm", [0, 0, 1, 1, 1]),  # the last move is straight on, and longer
        ("angle", [0, 0, 1, 1, 0]),
        ("change", [0, 0, 1, 1, 1]),
    ],
)
def test_turns_by_each_measure(measure, expected):
    assert risks(TurnRisk(0.02, measure)) == pytest.approx(0.02 * np.array(expected), abs=1e-12)


def test_a_right_angle_is_two_by_angle_and_root_two_by_norm():
    corner = np.array([(0, 0), (1, 0), (1, 1)], dtype=float)
    assert risks(TurnRisk(0.02, "angle"), corner, LINE[:2])[2] == pytest.approx(0.04)
    assert risks(TurnRisk(0.02, "norm"), corner, LINE[:2])[2] == pytest.approx(0.02 * math.sqrt(2))


def test_exponential_length_does_not_depend_on_how_a_way_is_cut():
    whole, cut = np.array([(0, 0), (2, 0)], dtype=float), np.array([(0, 0), (1, 0), (2, 0)], dtype=float)
    for growth, same in (("exponential", True), ("linear", False)):
        one, two = (1 - np.prod(1 - np.array(risks(LengthRisk(0.02, growth), at, LINE[: len(at) - 1]))) for at in (whole, cut))
        assert (one == pytest.approx(two, abs=1e-15)) == same
    assert risks(LengthRisk(0.02, "linear"), whole, LINE[:1]) == [0, 0.04]


def test_access_charges_each_direction_its_own():
    assert risks(AccessRisk([3, 1, 1, 2, 2], 0.1, 0.02)) == pytest.approx([0, 0.2, 0, 0.02, 0])


def test_a_table_knows_moves_and_pairs_of_moves():
    table = MoveRisk([-1, 0, 4], [1, 1, 1], [2, 2, 2], [0.1, 0.5, 0.9])
    assert risks(table) == pytest.approx([0, 0, 1 - 0.9 * 0.5, 0, 0])


def test_a_table_keeps_small_risks():
    assert risks(MoveRisk([-1, -1], [0, 1], [1, 2], [1e-12, 5e-17])) == [0, 1e-12, 5e-17, 0, 0]
    assert risks(MoveRisk([-1, 0], [1, 1], [2, 2], [1e-17, 2e-17]))[2] == pytest.approx(3e-17, rel=1e-15, abs=0.0)
    assert risks(MoveRisk([-1, 0], [1, 1], [2, 2], [1.0, 0.3]))[2] == 1.0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: LocaleRisk([0.1, 1.2]), r"risks of locale must lie in \[0, 1\]; found 1.2 in row 2"),
        (lambda: LocaleRisk([0.1, float("nan")]), "must lie in"),
        (lambda: LengthRisk(-1.0), "the rate of length must be a number of at least 0"),
        (lambda: LengthRisk(1.0, "square"), "the growth of length is unknown; expected linear, exponential"),
        (lambda: TurnRisk(1.0, "square"), "the measure of turn is unknown"),
        (lambda: TurnRisk(float("inf")), "the rate of turn"),
        (lambda: MoveRisk([-1, -1], [0, 0], [1, 1], [0.1, 0.1]), r"moves has two risks for one move; found \(-1, 0, 1\)"),
        (lambda: MoveRisk([-1], [0, 1], [1], [0.1]), "state of moves must be one state a risk"),
    ],
)
def test_what_is_no_risk_is_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize(
    ("element", "given", "message"),
    [
        (LocaleRisk([0.1]), {}, "risks of locale must be one a state; expected 3"),
        (LengthRisk(0.1), {}, "risk element length needs positions of the states"),
        (MoveRisk([-1], [0], [7], [0.1]), {}, "after 1 of moves does not exist"),
        (AccessRisk([1.0], 0.1), {}, "widths of access must be one finite number a state"),
    ],
)
def test_what_does_not_fit_the_states_is_refused(element, given, message):
    with pytest.raises(InputError, match=message):
        cases.graph([(0, 1), (1, 2)], [element], **given)


def test_a_linear_risk_beyond_1_is_refused_where_it_arises():
    graph = cases.graph([(0, 1)], [LengthRisk(0.6, "linear")], goals=(1,), positions=[(0, 0), (2, 0)])
    with pytest.raises(InputError, match=r"the risk of length must lie in \[0, 1\]; found 1.2 at 1 2"):
        RiskyPath(graph).evaluate((0, 1))


@pytest.mark.parametrize("measure", ["angle", "norm", "change"])
def test_going_straight_has_no_risk_however_places_are_rounded(measure):
    points = np.arange(6)[:, None] * np.array([0.4, 0.1]) + 0.2
    assert risks(TurnRisk(0.5, measure), points) == [0.0] * 6
