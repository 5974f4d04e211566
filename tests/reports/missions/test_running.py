import dataclasses
import math
import os
import signal
import time

import numpy as np
import pandas as pd
import pytest
from coded import coded

import waybound as wb
from waybound import Cardinality, Coverage, InputError, SubmodularSelection, UnsupportedError, UsageError
from waybound.instances.worlds import Setting, World, setting_values
from waybound.reports.missions import running
from waybound.reports.missions.mission import Mission
from waybound.reports.missions.running import COLUMNS, run

SMALL = {"robots": 4, "targets": 6, "width": 80.0, "height": 80.0}
MEASURES = ["candidates", "estimated_targets", "actual_targets", "estimated_value", "actual_value"]
METRICS = ["observed", "kept", "components"]


class Orchard(World):
    """Trees bear fruit at random; what is picked is gone."""

    def __init__(self, trees, rng):
        self._rng, self.fruit, self.picked, self.time = rng, np.zeros(trees), 0.0, 0

    def observe(self):
        return self.fruit.copy()

    def step(self, actions):
        for picker, tree in actions.items():
            if picker not in (0, 1):
                raise InputError(f"there is no picker {picker}")
            self.picked += self.fruit[tree]
            self.fruit[tree] = 0.0
        self.fruit = self.fruit + self._rng.random(len(self.fruit))
        self.time += 1

    def metrics(self):
        return {"picked": self.picked}


class Picking(Mission):
    """Two pickers choose the two fullest trees: another world, another problem, another answer than tracking."""

    name, summary, headline = "picking", "pick fruit", "picked"
    settings = {"trees": Setting(5, "number of trees", int, 2, 100)}  # noqa: RUF012

    def world(self, seed, **settings):
        values = setting_values(self.name, self.settings, settings)
        return Orchard(values["trees"], np.random.default_rng(seed))

    def problem(self, observation):
        if not observation.any():
            return None
        n = len(observation)
        items = Coverage(np.arange(n + 1, dtype=np.int32), np.arange(n, dtype=np.int32), observation)
        return SubmodularSelection(items, Cardinality(2), name="trees")

    def actions(self, observation, problem, answer):
        return {} if answer is None else dict(enumerate(answer.elements))

    def policies(self):
        return {"first-two": lambda observation: {0: 0, 1: 1}}


@pytest.mark.parametrize("decider", [{"solver": "highs"}, {"heuristic": "greedy"}, {"heuristic": "lazy-greedy"}])
def test_a_world_and_a_mission_of_ones_own_are_played_by_any_decider(decider):
    log = run(Picking(), steps=6, seed=3, trees=7, **decider)
    assert list(log.columns) == ["step", "picked", *COLUMNS]
    assert log["step"].tolist() == [1, 2, 3, 4, 5, 6]
    # The best two trees are known without a solver: replay the world and pick them.
    twin = Orchard(7, np.random.default_rng(3))
    for k in range(6):
        best = np.sort(twin.fruit)[-2:].sum()
        row = log.iloc[k]
        if best == 0:
            assert (row["problems"], row["status"]) == (0, "none")
            assert math.isnan(row["objective"])
        else:
            assert row["objective"] == pytest.approx(best)
        order = np.argsort(-twin.fruit, kind="stable")[:2]
        twin.step(dict(enumerate(order.tolist())))
        assert row["picked"] == pytest.approx(twin.picked)


def test_without_steps_a_mission_is_played_until_its_world_is_over_or_as_long_as_it_lasts():
    class Ripe(Orchard):
        @property
        def over(self):
            return self.picked > 9.0

    class Harvest(Picking):
        lasting = 50

        def world(self, seed, **settings):
            return Ripe(5, np.random.default_rng(seed))

    picked = run(Harvest(), policy="first-two")["picked"]
    assert picked.iloc[-1] > 9.0 >= picked.iloc[-2]
    assert len(run(Harvest(), policy="first-two", steps=len(picked) + 3)) == len(picked) + 3
    assert len(run(Picking(), policy="first-two")) == Picking.lasting == 100


def test_a_policy_solves_no_problem():
    log = run(Picking(), steps=4, policy="first-two")
    assert (log["problems"] == 0).all()
    assert (log["status"] == "none").all()
    assert log["picked"].is_monotonic_increasing


@pytest.mark.parametrize("name", ["highs", "greedy", "sequential-greedy", "lazy-greedy", "random", "brute-force", "lp-rounding"])
def test_tracking_is_played_by_solvers_and_heuristics_by_name(name):
    decider = {"solver": name} if name == "highs" else {"heuristic": name}
    settings = {**SMALL, "robots": 2, "primitives": 5} if name == "brute-force" else SMALL
    log = run("tracking", steps=5, seed=2, **decider, **settings)
    assert list(log.columns) == ["step", *METRICS, *COLUMNS, *MEASURES]
    assert len(log) == 5
    assert log["status"].isin(["optimal", "feasible", "none"]).all()
    assert (log["limit"] == "none").all()
    solved = log[log["problems"] > 0]
    assert len(solved) > 0
    assert (solved["estimated_value"] - solved["objective"]).abs().max() < 1e-9
    assert (log["seconds"] >= 0).all()


@pytest.mark.parametrize(
    ("problem", "decider"),
    [
        ("bottleneck", {"solver": "highs"}), ("bottleneck", {"heuristic": "greedy"}), ("bottleneck", {"heuristic": "lp-rounding"}),
        ("bottleneck", {"heuristic": "local"}), ("bottleneck-lp", {"solver": "highs"}), ("bottleneck-lp", {"heuristic": "local"}),
    ],
)  # fmt: skip
def test_a_bottleneck_is_tracked_whole_or_in_shares(problem, decider):
    log = run("tracking", steps=4, seed=2, scenario="gazebo-local", problem=problem, **decider)
    assert (log["problems"] > 0).all()
    rounded, value = log["estimated_value"], log["objective"]
    if problem == "bottleneck":
        assert (rounded - value).abs().max() < 1e-9
    assert (log["actual_targets"] <= log["candidates"]).all()


def test_the_greedy_states_its_guarantee_and_keeps_it():
    greedy, exact = (run("tracking", steps=1, seed=5, targets=30, **d) for d in ({"heuristic": "sequential-greedy"}, {"solver": "highs"}))
    assert greedy["guarantee"].tolist() == [2.0]
    assert exact["objective"][0] / 2 <= greedy["objective"][0] <= exact["objective"][0]
    assert exact["bound"][0] == pytest.approx(exact["objective"][0])
    assert exact["status"].tolist() == ["optimal"]


def test_bounds_of_all_teams_together_lie_above_the_value():
    log = run("tracking", steps=4, seed=5, heuristic="greedy", bound_time=60.0, **SMALL)
    solved = log[log["problems"] > 0]
    assert (solved["bound"] >= solved["objective"] - 1e-9).all()
    assert (solved["bound_kind"] == "verified").all()
    assert np.allclose(solved["gap"], (solved["bound"] - solved["objective"]) / solved["objective"])


def test_the_same_seed_gives_the_same_log_and_another_seed_another():
    logs = [run("tracking", steps=6, seed=s, heuristic="random", **SMALL).drop(columns="seconds") for s in (4, 4, 5)]
    pd.testing.assert_frame_equal(logs[0], logs[1])
    assert not logs[0].equals(logs[2])


def test_each_step_has_random_numbers_of_its_own():
    places = []
    log = run(
        "tracking", steps=12, seed=1, heuristic="random", robots=1, targets=1, width=50.0, height=50.0, sensing=100.0, target_step=0.0,
        watch=lambda world, row: places.append(tuple(world.robots[0])),
    )  # fmt: skip
    assert log["observed"].min() == 1.0
    moves = np.diff(np.array(places), axis=0)
    assert len({tuple(np.round(move, 6)) for move in moves}) > 4


def test_all_deciders_meet_the_same_targets():
    ways = []
    for decider in ({"policy": "force-vector"}, {"policy": "stay"}, {"heuristic": "greedy"}, {"heuristic": "random"}):
        targets = []
        run("tracking", steps=8, seed=6, turn_every=3, watch=lambda world, row, t=targets: t.append(world.targets), **decider, **SMALL)
        ways.append(np.array(targets))
    assert ways[0].shape == (9, 6, 2)
    assert all(np.array_equal(ways[0], way) for way in ways[1:])


def test_the_log_tells_where_it_comes_from():
    log = wb.run("tracking", steps=1, seed=9, policy="stay", targets=3)
    assert log.attrs == {
        "mission": "tracking", "solver": None, "heuristic": None, "policy": "stay", "seed": 9, "settings": {"targets": 3}, "limit": "none",
        "faults": [],
    }  # fmt: skip


def test_without_a_decider_the_first_solver_that_can_is_taken():
    assert (run("tracking", steps=2, seed=1, **SMALL)["status"] == "optimal").all()


def interrupt():
    os.kill(os.getpid(), signal.SIGINT)


def test_an_interrupt_keeps_the_rows_so_far():
    before = signal.getsignal(signal.SIGINT)

    def watch(world, row):
        if world.time == 3:
            interrupt()

    log = run("tracking", steps=50, seed=1, heuristic="greedy", watch=watch, **SMALL)
    assert log["step"].tolist() == [1, 2, 3]
    assert log.attrs["limit"] == "interrupt"
    assert signal.getsignal(signal.SIGINT) is before


def test_an_interrupt_that_a_search_took_for_its_own_ends_the_run_after_that_step(monkeypatch):
    real, calls = running.solve, []

    def swallowing(*given, **named):
        calls.append(1)
        if len(calls) == 2:
            try:
                interrupt()
                time.sleep(0.05)  # lets the handler run
            except KeyboardInterrupt:
                pass
        return real(*given, **named)

    monkeypatch.setattr(running, "solve", swallowing)
    log = run(Picking(), steps=50, seed=3, heuristic="greedy")
    assert log.attrs["limit"] == "interrupt"
    assert 0 < len(log) < 50


def test_an_interrupt_before_the_first_step_leaves_an_empty_log_with_its_columns():
    class Slow(Picking):
        def problem(self, observation):
            interrupt()
            return super().problem(observation)

    log = run(Slow(), steps=5, heuristic="greedy")
    assert list(log.columns) == ["step", "picked", *COLUMNS]
    assert len(log) == 0
    assert log.attrs["limit"] == "interrupt"


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"steps": 0}, "steps must be a whole number of at least 1"),
        ({"steps": 2.5}, "steps"),
        ({"steps": True}, "steps"),
        ({"seed": -1}, "seed"),
        ({"policy": "nothing"}, "choose from force-vector, stay"),
        ({"policy": "stay", "solver": "highs"}, "one of solver, heuristic and policy"),
        ({"solver": "highs", "heuristic": "greedy"}, "one of solver, heuristic and policy"),
        ({"policy": "stay", "options": {"h": 1}}, "takes no options"),
        ({"heuristic": "nothing"}, "unknown heuristic"),
        ({"heuristic": "greedy", "options": {"colour": 1}}, "colour"),
        ({"colour": "red"}, "no setting 'colour'"),
    ],
)
def test_what_cannot_be_run_is_refused_in_one_line(given, says):
    with pytest.raises(UsageError, match=says) as error:
        run("tracking", **given)
    assert "\n" not in str(error.value)


def test_an_unknown_mission_lists_the_known_ones_and_other_things_are_refused():
    with pytest.raises(UsageError, match=r"unknown mission 'mars'; choose from .*tracking"):
        run("mars")
    with pytest.raises(UsageError, check=coded("malformed")):
        run(3)  # type: ignore[arg-type]


@pytest.mark.parametrize("given", [{"solver": "nothing"}, {"heuristic": "nothing"}, {"heuristic": "greedy", "options": {"colour": 1}}])
def test_a_name_that_does_not_exist_is_refused_even_if_nothing_were_to_solve(given):
    with pytest.raises(UsageError, match=r"nothing|colour"):
        run("tracking", steps=1, sensing=0.0, **given)


def test_a_heuristic_of_another_family_says_what_it_lacks():
    with pytest.raises(UnsupportedError, match="savings"):
        run("tracking", heuristic="savings", steps=1)


def test_an_action_that_the_world_refuses_is_an_error():
    class Wrong(Picking):
        def actions(self, observation, problem, answer):
            return {7: 0}

    with pytest.raises(InputError, match="picker 7"):
        run(Wrong(), steps=2, heuristic="greedy")


def test_a_fault_beside_an_answer_is_told_with_its_step(monkeypatch):
    honest = running.solve
    monkeypatch.setattr(running, "solve", lambda *a, **k: dataclasses.replace(honest(*a, **k), faults=("it lied",)))
    log = run("tracking", heuristic="sequential-greedy", steps=2, seed=1, bound_time=0)
    assert len(log) == 2
    assert set(log.attrs["faults"]) == {"step 1: it lied", "step 2: it lied"}
