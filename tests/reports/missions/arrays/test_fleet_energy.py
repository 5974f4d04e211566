import pytest
from file_cases import check_refused

import waybound as wb
from waybound.instances.arrays.worlds.fleet_energy import NEVER
from waybound.instances.errors import InputError, UsageError
from waybound.reports.missions.arrays.fleet_energy import FleetEnergy

SURE = {"scatter": 0, "jobs": 0}


def played(how=None, **settings):
    mission = FleetEnergy()
    supported = []
    watch = lambda world, row: supported.append(sum(world.jobs[k].end == NEVER for k in mission.taken))  # noqa: E731
    return wb.run(mission, watch=watch, **(how or {"policy": "one-by-one"}), **settings), supported, mission


def test_jobs_for_ever_are_as_many_as_the_fleet_sustains():
    for robots, jobs in ((20, 0), (21, 1), (41, 1), (42, 2)):
        _, supported, mission = played(seed=1, robots=robots, steps=3, **SURE)
        assert (mission.robots_for_ever, supported[-1]) == (21, jobs)


def test_estimates_settle_and_supported_jobs_fall():
    _, supported, mission = played(seed=1, believed_charge=840, jobs=0, steps=540)
    assert list(dict.fromkeys(supported)) == [0, 3, 2, 1]
    assert 84 < mission.charge <= 240 and 10 <= mission.flight <= 12


def test_without_learning_estimates_stay():
    _, supported, mission = played(seed=1, believed_charge=840, jobs=0, steps=200, adapt=False)
    assert (mission.charge, mission.flight, supported[-1]) == (84, 12, 3)


def test_where_ways_are_counted_places_are_hardly_ever_alone():
    covered = []
    for counted in (False, True):
        log, _, _ = played(seed=1, robots=100, persistent=6, steps=1080, count_ways=counted, **SURE)
        covered.append(log["covered"].iloc[-1])
        assert log["lost"].iloc[-1] == 0
    assert covered[0] < 95 < 99.5 < covered[1]


@pytest.mark.parametrize("solver", ["highs", "cpsat"])
def test_any_solver_of_integer_programs_plans(solver):
    log, _, _ = played({"solver": solver}, seed=2, robots=44, steps=60)
    assert set(log["status"]) == {"none", "optimal"} and log["covered"].iloc[-1] > 80
    assert (log["problems"] > 0).sum() < 30  # plans hold for a while
    assert {"flight", "charge", "for_ever", "planned_alone"} <= set(log.columns)


def test_a_fleet_that_reaches_nothing_is_refused_before_the_first_step():
    check_refused(InputError, "no robot reaches", wb.run, "fleet-energy", policy="one-by-one", speed=0.001)
    check_refused(UsageError, "the flight time is 2 steps", wb.run, "fleet-energy", policy="one-by-one", believed_flight=20)


def test_it_can_be_filmed(filmed):
    film = filmed("fleet-energy", policy="one-by-one", seed=1, steps=12)
    assert len(film.pictures(3)) == 3 and film.shots[-1][0].marked.any() and not film.shots[0][0].marked.any()
