import math

import numpy as np
import pandas as pd
import pytest
from scipy import stats

import waybound
from waybound.reports.studies.frames import apart, by_method, frame_table, intervals, loop_means, mean_interval, play


def test_intervals_are_students():
    values = np.array([1.0, 4.0, 2.0, 8.0])
    mean, half = mean_interval(values)
    low, high = stats.t.interval(0.95, 3, loc=values.mean(), scale=stats.sem(values))
    assert (mean - half, mean + half) == pytest.approx((low, high))


def test_they_hold_the_mean_as_often_as_they_say():
    rng = np.random.default_rng(1)
    held = [abs(mean - 5.0) <= half for mean, half in (mean_interval(rng.normal(5.0, 2.0, 6)) for _ in range(2000))]
    assert np.mean(held) == pytest.approx(0.95, abs=0.02)


def test_one_value_has_none():
    assert mean_interval([3.0])[0] == 3.0
    assert math.isnan(mean_interval([3.0])[1])


def test_columns_have_means_without_what_is_missing_and_nothing_where_all_is():
    own = pd.DataFrame({"x": [1.0, math.nan, 3.0], "y": [math.nan] * 3})
    assert intervals(own, ("x", "y")) == {"x": 2.0, "x_half": mean_interval([1.0, 3.0])[1]}


def test_methods_are_compared_in_the_same_worlds():
    values = pd.DataFrame({"seed": [1, 2, 1, 2, 3], "method": ["a", "a", "b", "b", "b"], "observed": [5.0, 9.0, 4.0, 6.0, 99.0]})
    lead, half = apart(values, "observed", "a", "b")
    assert lead == 2.0 and half == pytest.approx(stats.t.ppf(0.975, 1))  # the third world has no a


def test_what_a_way_to_decide_loses_counts_from_the_exact_one():
    loops = pd.DataFrame({"seed": [1, 2, 1, 2], "method": ["exact", "exact", "greedy", "greedy"], "share": [9.0, 8.0, 6.0, 7.0]})
    assert [(row["decided by"], row["runs"], row["lost"]) for row in loop_means(loops, ("share",), "share", most=True)] == [
        ("exact", 2, 0.0), ("greedy", 2, 2.0)
    ]  # fmt: skip
    assert loop_means(loops, ("share",), "share", most=False)[1]["lost"] == -2.0
    assert loop_means(pd.DataFrame(), ("share",), "share", most=True) == []


def test_methods_keep_their_order():
    rows = [{"method": name, "x": k} for k, name in enumerate("bab")]
    assert [(name, list(log["x"])) for name, log in by_method(rows)] == [("b", [0, 2]), ("a", [1])]


def test_tables_show_intervals_beside_means_and_a_dash_for_nothing():
    table = frame_table(
        "t", [{"what": "x", "mean": 12.345, "mean_half": 0.5}, {"what": "y", "mean": math.nan, "mean_half": math.nan, "n": 3}]
    )
    assert [column.name for column in table.columns] == ["what", "mean", "n"]
    assert [column.right for column in table.columns] == [False, True, True]
    assert table.rows == (("x", "12.35 ± 0.50", "-"), ("y", "-", "3"))


def test_a_mission_is_played_by_all_methods_or_not_at_all(monkeypatch):
    methods = {"stay": {"policy": "stay"}, "force": {"policy": "force-vector"}}
    rows = play("tracking", methods, 2, 1, {"targets": 5}, {"kind": "k"}, ("step", "observed"))
    assert [(row["kind"], row["seed"], row["method"], row["step"]) for row in rows] == [("k", 1, m, s) for m in methods for s in (1, 2)]
    assert [row["step"] for row in play("tracking", methods, 2, 1, {"targets": 5}, {}, ("step",), last=True)] == [2, 2]
    run = waybound.run

    def interrupted(*given, **named):
        log = run(*given, **named)
        log.attrs["limit"] = "interrupt"
        return log

    monkeypatch.setattr("waybound.reports.missions.running.run", interrupted)
    with pytest.raises(KeyboardInterrupt):
        play("tracking", methods, 1, 1, {"targets": 5}, {}, ("step",))
