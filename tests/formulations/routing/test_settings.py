import math
from dataclasses import replace

import numpy as np
import pytest
from coded import coded

from waybound import InputError, RoutingInstance, RoutingProblem, UsageError, generate
from waybound.formulations.routing.settings import KNOWN, parts_of


def instance(deviation: float = 0.3) -> RoutingInstance:
    made = generate("random", customers=4, deviation=deviation, seed=2, **{"max-duration": 300.0})
    return RoutingInstance(made.name, "generated", made.sites, made.travel, made.fleet, "cvrp", ("cvrp", "vrptw"), made.min_vehicles)


def test_each_setting_changes_what_it_names() -> None:
    plain = parts_of(instance(), None, {})
    assert plain["problem"] == "cvrp" and plain["team_risk"] is None and parts_of(instance(), "vrptw", {})["problem"] == "vrptw"
    assert len(parts_of(instance(), None, {"customers": "2"})["sites"]) == 3
    assert parts_of(instance(), None, {"capacity": "7.5"})["fleet"][0].capacity == 7.5
    assert parts_of(instance(), None, {"vehicles": 3})["fleet"][0].count == 3
    assert parts_of(instance(), None, {"vehicles": "unlimited"})["fleet"][0].count is None
    exactly = parts_of(instance(), None, {"vehicles-exactly": 2})
    assert (exactly["fleet"][0].count, exactly["min_vehicles"]) == (2, 2)
    risks = parts_of(instance(), None, {"risk": "0.1", "team-risk": 0.2})
    assert (risks["fleet"][0].risk, risks["team_risk"]) == (0.1, 0.2)
    assert parts_of(instance(), None, {"convention": "trunc1"})["travel"].convention == "trunc1"


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"vehicels": 2}, f"unknown setting vehicels; routing problems take {', '.join(KNOWN)}"),
        ({"vehicles": 2, "vehicles-exactly": 2}, "not both"), ({"vehicles": 0}, "at least 1"), ({"customers": "few"}, "a whole number"),
        ({"capacity": "much"}, "must be a number"), ({"capacity": -1}, "must be positive"), ({"risk": 0}, "must be positive"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said(settings: dict[str, object], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        parts_of(instance(), None, settings)


def test_a_risk_needs_variances_and_is_a_half_at_most() -> None:
    with pytest.raises(UsageError, check=coded("contradiction")):
        parts_of(instance(0.0), None, {"risk": 0.1})
    for name in ("risk", "team-risk"):
        for value in (0.51, 1.0, math.inf, math.nan):
            with pytest.raises((InputError, UsageError), match=r"1/2 at most|must be positive"):
                RoutingProblem.from_instance(instance(), None, {name: value})


def test_a_problem_that_the_data_do_not_allow_is_refused() -> None:
    with pytest.raises(UsageError, match="cannot be read as tsp; it allows cvrp, vrptw"):
        parts_of(instance(), "tsp", {})
    several = replace(instance(), fleet=(*instance().fleet, replace(instance().fleet[0], name="other")))
    with pytest.raises(UsageError, check=coded("contradiction")):
        parts_of(several, None, {"vehicles": 2})


def test_optional_sites_that_are_worth_nothing_need_an_objective_that_is_said() -> None:
    given = instance()
    idle = replace(given, sites=replace(given.sites, required=given.sites.required & False))
    with pytest.raises(InputError, check=coded("missing")):
        parts_of(idle, None, {})
    assert str(parts_of(idle, None, {"objective": "total-cost"})["objective"]) == "total-cost"
    assert str(parts_of(replace(idle, objective=("total-cost",)), None, {})["objective"]) == "total-cost"
    some = replace(given, sites=replace(given.sites, required=given.sites.required & (np.arange(len(given.sites)) > 1)))
    assert str(parts_of(some, None, {})["objective"]) == "total-cost"
    worth = replace(idle, sites=replace(idle.sites, reward=np.ones(len(idle.sites))))
    assert str(parts_of(worth, None, {})["objective"]) == "total-cost - reward"
