from typing import Any

import pytest

from waybound.reports.campaigns.setting import Setting, canonical


def test_equal_settings_have_one_hash_and_survive_json() -> None:
    one = Setting(method="pyvrp", time_limit=1, options={"b": 2.0, "a": 1})
    other = Setting(method="pyvrp", time_limit=1.0, options={"a": 1, "b": 2})
    assert one.hash == other.hash and one.text == other.text
    assert Setting.from_json(one.to_json()) == one


@pytest.mark.parametrize(
    "changed",
    [
        {"method": "highs"}, {"heuristic": True}, {"problem": "tsp"}, {"convention": "exact"}, {"changes": {"vehicles": 3}},
        {"form": "circuit"}, {"relax": True}, {"options": {"h": 1}}, {"lp_solver": "highs"}, {"time_limit": 2.0}, {"bound_time": 0.0},
        {"iterations": 5}, {"gap": 0.1}, {"threads": 2}, {"memory_limit": 100.0}, {"files": {"fleet": "x"}},
    ],
)  # fmt: skip
def test_whatever_differs_makes_another_run(changed: dict[str, Any]) -> None:
    assert Setting(**{"method": "pyvrp", **changed}).hash != Setting(method="pyvrp").hash


def test_a_label_tells_what_sets_a_method_apart_from_itself() -> None:
    assert Setting(method="local", options={"h": 3, "a": 1}).label == "local a=1 h=3"
    assert Setting(method="highs", form="circuit", relax=True).label == "highs circuit relaxed"


def test_limits_and_reading_are_told_apart_and_given_to_solve_as_keywords() -> None:
    setting = Setting(method="savings", heuristic=True, time_limit=30.0, problem="cvrp")
    assert setting.limits == '{"gap":0,"threads":1,"time_limit":30}'
    assert '"problem":"cvrp"' in setting.reading and "time_limit" not in setting.reading
    assert setting.bound_budget == 3.0 and Setting(method="x", bound_time=0.0).bound_budget == 0.0
    assert setting.keywords()["heuristic"] == "savings" and "memory_limit" not in setting.keywords()


def test_canonical_json_is_one_line_with_sorted_keys() -> None:
    assert canonical({"b": [1.0, 2.5], "a": None}) == '{"a":null,"b":[1,2.5]}'


def test_a_method_is_told_apart_by_who_solves_its_linear_programs() -> None:
    assert Setting(method="local", lp_solver="scip").label != Setting(method="local").label
