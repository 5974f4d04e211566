import json
import math

import numpy as np
from hypothesis import given, strategies as st

from waybound.formulations.evaluation import Check, Checklist, Evaluation, Violation, judge


def test_residuals_up_to_what_is_allowed_pass():
    judge = Checklist()
    judge.test("load", -5.0, "light")
    judge.test("load", 0.5, "on the edge", allowed=0.5)
    assert judge.violations == []
    assert judge.checks(["load"]) == (Check("load", True, 0.5, 2),)


def test_residuals_beyond_it_are_violations_with_their_place():
    judge = Checklist()
    judge.test("load", 0.2, "heavy", allowed=0.1, vehicle="vehicle 1", site="s")
    judge.test("load", 7.0, "heavier", vehicle="vehicle 2")
    assert judge.violations == [
        Violation("load", "heavy", 0.2, "vehicle 1", "s"),
        Violation("load", "heavier", 7.0, "vehicle 2"),
    ]
    assert judge.checks(["load"]) == (Check("load", False, 7.0, 2),)


def test_what_is_not_a_number_never_passes():
    judge = Checklist()
    judge.test("energy", math.nan, "unknown")
    assert judge.violations[0].amount == math.inf
    assert not judge.checks(["energy"])[0].passed


def test_a_check_with_nothing_to_test_passes_and_says_so():
    assert Checklist().checks(["energy"]) == (Check("energy", True, 0.0, 0),)


def test_json_holds_no_infinity():
    check, violation = Check("energy", False, math.inf, 1), Violation("energy", "unknown", math.inf)
    text = json.dumps([check.to_json(), violation.to_json()], allow_nan=False)
    assert json.loads(text) == [
        {"name": "energy", "passed": False, "residual": None, "tested": 1},
        {"check": "energy", "message": "unknown", "amount": None},
    ]


def test_json_names_vehicle_and_site_where_they_are_known():
    assert Violation("load", "m", 1.0, "vehicle 1", "s").to_json() == {
        "check": "load", "message": "m", "amount": 1.0, "vehicle": "vehicle 1", "site": "s",
    }  # fmt: skip


def test_an_objective_is_a_number_or_a_list_in_order_of_priority():
    assert Evaluation((3.0,), (), (), {}).objective == 3.0
    assert Evaluation((3.0, 4.0), (), (), {}).objective == [3.0, 4.0]
    assert not Evaluation((3.0,), (), (Violation("load", "m", 1.0),), {}).feasible


@given(st.lists(st.floats(-2, 2) | st.sampled_from([0.1, math.nan, math.inf, -math.inf]), max_size=8), st.sampled_from([0.0, 0.1]))
def test_many_residuals_are_judged_as_one_after_the_other(excess, allowed):
    checklist = Checklist()
    for k, amount in enumerate(excess):
        checklist.test("load", amount, f"thing {k}", allowed=allowed)
    check, found = judge("load", np.array(excess, dtype=float), lambda k: f"thing {k}", allowed)
    assert (check,) == checklist.checks(["load"])
    assert found == checklist.violations
