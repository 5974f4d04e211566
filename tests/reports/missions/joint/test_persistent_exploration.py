from types import SimpleNamespace

import numpy as np
import pytest

import waybound as wb
from waybound.instances.errors import InputError, UsageError
from waybound.reports.missions.joint import persistent_exploration as module
from waybound.reports.missions.joint.persistent_exploration import PersistentExploration

SMALL = {"rows": 17, "columns": 17, "robots": 2}

NAME = "persistent-exploration"


class Stub:
    """One robot, each round of which appends a waypoint 25 s away."""

    def __init__(self, *given):
        self.plans = [SimpleNamespace(stops=[1], end=0.0)]
        self.pool, self.offered, self.places, self.left = np.zeros((1, 2)), np.ones((1, 1)), [], np.ones(1, dtype=bool)

    def selected(self, plans, count, least):
        return [0], 1.0, 1.0


@pytest.mark.parametrize(("assigned", "rounds"), [(True, 5), (False, 1)])
def test_plans_are_extended_until_the_horizon_or_until_nothing_is_assigned(monkeypatch, assigned, rounds):
    mission = PersistentExploration()
    world = mission.world(1, endurance=300.0, **SMALL)
    monkeypatch.setattr(module, "Horizon", Stub)
    ends = []
    for view in mission.teams(world.observe()):
        if assigned:
            view.plans[0].end += 25.0
            mission._horizon.places.append((0, 0))
            ends.append(view.plans[0].end)
        else:
            ends.append(0.0)
    assert ends == ([25.0, 50.0, 75.0, 100.0, 125.0] if assigned else [0.0]) and len(ends) == rounds


@pytest.mark.parametrize("how", [{"heuristic": "greedy-assignment"}, {"heuristic": "pure-greedy"}, {"policy": "pure-greedy"}])
@pytest.mark.parametrize("model", ["markov", "decay", "static"])
def test_every_way_to_decide_keeps_the_map_and_loses_no_robot(how, model):
    log = wb.run(NAME, seed=2, steps=24, model=model, endurance=60.0, charge=20.0, advance=50.0, **SMALL, **how)
    idle = wb.run(NAME, seed=2, steps=24, model=model, policy="stay", **SMALL)
    last = log.iloc[-1]
    assert last["lost"] == 0.0 and last["entropy"] < 0.6 * idle["entropy"].iloc[-1] and last["unobserved"] < 40
    assert log["aloft"].max() == 2.0 and log["aloft"].min() < 2.0
    assert (log["seconds"] > 0).any()


@pytest.mark.parametrize("objective", ["makespan", "cost", "mixed"])
def test_exact_plans_collect_at_least_what_greedy_ones_do(objective):
    mission = PersistentExploration()
    world = mission.world(3, waypoints=4, objective=objective, **SMALL)
    view = next(iter(mission.teams(world.observe())))
    problem = mission.problem(view)
    exact, greedy = wb.solve(problem, solver="cpsat"), wb.solve(problem, heuristic="greedy-assignment")
    assert exact.status == "optimal"
    value = exact.objective if isinstance(exact.objective, list) else [exact.objective]
    other = greedy.objective if isinstance(greedy.objective, list) else [greedy.objective]
    assert value[0] >= other[0] - 1e-9
    assert view.added <= view.at_most and view.rewards.sum() >= view.added - 1e-9  # rewards stand alone, and overlap


def test_robots_in_the_air_start_where_they_will_be():
    seen = []

    class Watched(PersistentExploration):
        def problem(self, observation):
            problem = super().problem(observation)
            seen.append((problem, {f"robot {plan.robot + 1}": (plan.end, plan.used) for plan in observation.plans}))
            return problem

    wb.run(Watched(), seed=1, steps=3, heuristic="greedy-assignment", advance=10.0, horizon=30.0, waypoints=3, **SMALL)
    aloft = [(problem, ends) for problem, ends in seen if any(v.name in ends for v in problem.fleet)]
    assert aloft
    for problem, ends in aloft:
        for vehicle in problem.fleet:
            if vehicle.name in ends:
                end, used = ends[vehicle.name]
                assert problem.travel.distances[vehicle.start, problem.customers[0]] >= end
                assert vehicle.max_duration == pytest.approx(300.0 - (used - end))
        assert not problem.sites.required.any() and (problem.sites.reward[problem.customers] > 0).all()


def test_without_lanes_robots_begin_around_the_base():
    log = wb.run(NAME, seed=4, steps=30, lanes=0, heuristic="greedy-assignment", model="decay", dynamic=0.2, advance=20.0, **SMALL)
    assert log["unobserved"].iloc[-1] < log["unobserved"].iloc[0] and log["lost"].iloc[-1] == 0.0


@pytest.mark.parametrize(
    ("settings", "fault", "message"),
    [
        ({"utility": "chi-square", "model": "decay"}, UsageError, "needs model=markov"),
        ({"advance": 200.0}, UsageError, "advance must lie from tick to horizon"),
        ({"advance": 5.0}, UsageError, "advance must lie from tick to horizon"),
        ({"advance": 15.0}, UsageError, "advance must be a multiple of tick"),
        ({"endurance": 2.0, "spacing": 5}, InputError, "no view is within reach"),
        ({"endurance": 0.5}, InputError, "robots reach no cell"),
        ({"safe": 0.0, "lanes": 0, "spacing": 1}, InputError, "no view is within reach"),
        ({"misfit_weight": -1.0}, UsageError, "misfit-weight must lie between"),
    ],
)
def test_what_reaches_nothing_is_refused_before_the_first_step(settings, fault, message):
    with pytest.raises(fault, match=message):
        wb.run(NAME, steps=1, policy="stay", **{**SMALL, **settings})


def test_measures_tell_what_was_selected_and_how_far_it_may_be_from_the_best():
    log = wb.run(NAME, seed=1, steps=11, heuristic="greedy-assignment", **SMALL)
    planned = log[log["problems"] > 0]
    assert planned["step"].tolist() == [1, 11] and (planned["selected"] >= planned["assigned"]).all() and (planned["assigned"] > 0).all()
    assert planned["selection_gap"].between(0, 100 / np.e).all()


def test_it_can_be_filmed(filmed):
    shots = filmed(NAME, policy="pure-greedy", seed=1, steps=4, **SMALL).shots
    assert shots[-1][0].marked.sum() > shots[0][0].marked.sum() == 0
