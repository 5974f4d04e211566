import numpy as np
import pytest

import waybound as wb
from waybound import BinAssignment, OrchardDay, UsageError
from waybound.instances.auctions.orchard_grid import OrchardGrid
from waybound.instances.auctions.orchard_rules import OrchardRules
from waybound.reports.missions.auctions.orchard import Orchard
from waybound.reports.missions.auctions.orchard_days.days import play_day
from waybound.reports.missions.auctions.orchard_days.policies import CHOICES

SMALL = {"rows": 3, "columns": 6, "robots": 4, "groups": 3, "bins_per_cell": 1}
RULES = OrchardRules(OrchardGrid(3, 6), 4, 3, bins_per_cell=1)


@pytest.mark.parametrize("delivery", ["baseline", "proposed"])
@pytest.mark.parametrize("policy", CHOICES)
def test_policies_play_the_compiled_day(policy, delivery):
    log = wb.run("orchard", policy=policy, steps=80, seed=5, delivery=delivery, **SMALL)
    day = play_day(RULES, 5, policy, delivery)
    assert log["finished"].iloc[-1] == day.makespan
    assert log["idle_worker_steps"].iloc[-1] == 5 * day.idle_steps
    assert log["returned"].tolist() == [day.returned_by(step) for step in range(1, 81)]


def test_a_day_is_played_to_its_end_by_default():
    log = wb.run("orchard", policy="greedy", seed=5, **SMALL)
    assert log["finished"].iloc[-1] == len(log) == play_day(RULES, 5, "greedy", "proposed").makespan
    assert log["finished"].iloc[:-1].isna().all()


@pytest.mark.parametrize(("mode", "policy"), [("deferred", "auction"), ("immediate", "auction-immediate")])
def test_the_auction_as_a_heuristic_is_the_rule_of_its_name(mode, policy):
    log = wb.run("orchard", heuristic="auction", options={"mode": mode}, steps=40, seed=2, **SMALL)
    assert log["returned"].tolist() == wb.run("orchard", policy=policy, steps=40, seed=2, **SMALL)["returned"].tolist()


def test_measures_tell_what_an_assignment_would_cost():
    auction = wb.run("orchard", heuristic="auction", steps=60, seed=3, **{**SMALL, "robots": 6})
    held = auction.dropna(subset=["least"])
    assert len(held)
    assert (held["objective"] >= held["least"] - 1e-9).all()
    assert ((held["objective"] > held["least"]) == (held["beaten"] == 1)).all()
    exact = wb.run("orchard", solver="lapjv", steps=60, seed=3, **{**SMALL, "robots": 6}).dropna(subset=["least"])
    assert (exact["objective"] == exact["least"]).all()
    assert not exact["beaten"].any()


@pytest.mark.parametrize("method", [{"solver": "highs"}, {"heuristic": "bins-then-requests"}], ids=str)
def test_bins_and_requests_can_be_chosen_together(method):
    log = wb.run("orchard", steps=80, seed=1, plan="joint", bound_time=0, **method, **SMALL)
    assert (log["returned"].iloc[-1], log.attrs["faults"]) == (12.0, [])
    without = wb.run("orchard", steps=80, seed=1, plan="joint", delivery="baseline", idle="stay", heuristic="bins-then-requests", **SMALL)
    assert (without["returned"].iloc[-1], without.attrs["faults"]) == (12.0, [])


@pytest.mark.parametrize("plan", ["makespan", "completion"])
def test_schedules_of_all_standing_bins_bring_them_home_too(plan):
    log = wb.run("orchard", heuristic="list-schedule", steps=80, seed=1, plan=plan, **SMALL)
    assert log["finished"].iloc[-1] > 0
    assert (log["returned"].iloc[-1], log.attrs["faults"]) == (12.0, [])


def test_a_schedule_knows_all_robots():
    mission = Orchard()
    world = mission.world(1, plan="makespan", **SMALL)
    first = mission.problem(world.observe())
    assert isinstance(first, OrchardDay)
    assert first.jobs.num_robots == 4
    while world.time == 0 or mission.problem(world.observe()) is None:
        world.step(mission.policies()["auction"](world.observe()))
    o, jobs = world.observe(), mission.problem(world.observe()).jobs
    busy = np.setdiff1d(np.arange(4), o.robots)
    assert len(busy) > 0
    assert (jobs.robot_free[busy] > 0).all()
    assert not jobs.robot_free[o.robots].any()
    assert jobs.bin_cells.tolist() == o.bin_cells.tolist()
    mission.values["plan"] = "step"
    assert isinstance(mission.problem(world.observe()), BinAssignment)


def test_nothing_is_asked_where_nobody_is_idle_or_no_bin_stands():
    mission = Orchard()
    world = mission.world(1, **{**SMALL, "robots": 1})
    world.step(mission.policies()["auction"](world.observe()))
    assert mission.problem(world.observe()) is None


def test_it_can_be_filmed(filmed):
    shots = filmed("orchard", policy="auction", steps=80, seed=5, **SMALL).shots
    last, middle = shots[-1][0], shots[15][0]
    assert last.marked.all()
    assert (last.points[:, 0] < 0).all()  # beside the repository
    standing = np.isfinite(middle.points[:, 0]) & ~middle.marked
    assert (middle.points[standing, 0] >= 0).all()
    assert len(np.unique(last.points, axis=0)) == len(last.points)


def test_unknown_settings_are_refused():
    for wrong, message in (({"delivery": "fast"}, "delivery must be one of baseline, proposed"), ({"plan": "day"}, "plan must be one of")):
        with pytest.raises(UsageError, match=message):
            wb.run("orchard", policy="auction", steps=1, **wrong)
