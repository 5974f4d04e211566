"""The compiled day against the world's, and against what is known of days."""

import time

import numpy as np
import pytest
from coded import coded
from orchard_cases import FOUR, WHOLE_DAYS, lane, played
from patience import HANG

from waybound.formulations.stop import Stop, Stopped
from waybound.instances.auctions.orchard_grid import OrchardGrid
from waybound.instances.auctions.orchard_rules import OrchardRules
from waybound.instances.errors import UsageError
from waybound.reports.missions.auctions.orchard_days.days import least_makespan, most_returned, play_day
from waybound.reports.missions.auctions.orchard_days.policies import CHOICES, COSTS, DELIVERIES


@pytest.mark.parametrize("delivery", DELIVERIES)
@pytest.mark.parametrize("choice", CHOICES)
def test_the_compiled_day_is_the_worlds_to_the_step(choice, delivery):
    for seed in range(6):
        grid = OrchardGrid(2 + seed % 3, 5 + seed % 4, seed % 2, 1 + seed % 3, 1 + seed % 2)
        rules = OrchardRules(grid, 1 + 2 * seed, 1 + seed % 4, 1 + seed % 3, 1 + seed % 3, relocation=("nearest", "random")[seed % 2])
        cost = COSTS[seed % 2]
        world, day = played(rules, seed, choice, delivery, cost), play_day(rules, seed, choice, delivery, cost)
        for key in ("stood", "full", "returned"):
            assert getattr(world, key).tolist() == getattr(day, key).tolist()
        assert (world.idle_steps, world.time) == (day.idle_steps, day.steps)


@pytest.mark.parametrize(("start", "robots", "last", "optimum"), WHOLE_DAYS)
def test_whole_days_of_the_reference(start, robots, last, optimum):
    made = [play_day(lane(start, robots), 1, choice, delivery, start=start).makespan for choice, delivery in FOUR]
    assert tuple(made) == last
    assert min(made) >= optimum


# mean steps of 20 seeds: greedy+baseline, auction+baseline, greedy+proposed, auction+proposed; ten lanes, then five
STEPS = {
    (10, 2): (1280.6, 1262.0, 1167.4, 1179.0), (10, 4): (662.4, 636.6, 591.1, 603.6), (10, 6): (464.1, 431.5, 417.1, 415.8),
    (10, 8): (363.6, 332.3, 339.0, 332.6), (10, 10): (323.2, 290.9, 296.9, 287.9), (10, 12): (300.1, 285.4, 271.6, 280.4),
    (10, 16): (288.6, 285.3, 263.9, 279.7), (10, 20): (288.6, 285.3, 263.8, 279.7), (5, 2): (488.1, 480.4, 435.0, 441.9),
    (5, 4): (255.8, 244.7, 221.8, 230.1), (5, 6): (180.2, 169.3, 161.4, 161.0), (5, 8): (145.3, 131.9, 132.3, 131.0),
    (5, 10): (129.2, 120.5, 117.8, 116.1), (5, 12): (122.9, 119.2, 109.8, 114.4), (5, 16): (121.0, 119.2, 108.4, 114.3),
    (5, 20): (121.0, 119.2, 108.4, 114.3),
}  # fmt: skip


@pytest.mark.parametrize(("rows", "robots"), STEPS)
def test_means_are_those_of_an_independent_simulation(rows, robots):
    rules = OrchardRules(OrchardGrid(rows, 10), robots, 4)
    for (choice, delivery), known in zip(FOUR, STEPS[rows, robots], strict=True):
        days = [play_day(rules, seed, choice, delivery) for seed in range(20)]
        assert np.mean([day.makespan for day in days]) == pytest.approx(known, rel=0.03)
        assert min(day.makespan for day in days) >= least_makespan(rules)
        for step in (50, 150):
            assert max(day.returned_by(step) for day in days) <= most_returned(rules, step)


@pytest.mark.parametrize("rows", [5, 10])
def test_the_sources_method_needs_fewer_steps_than_its_baseline(rows):
    for robots in range(2, 21):
        rules = OrchardRules(OrchardGrid(rows, 10), robots, 4)
        base, proposed = ([play_day(rules, s, *how) for s in range(20)] for how in (FOUR[0], FOUR[3]))
        assert np.mean([day.makespan for day in proposed]) < np.mean([day.makespan for day in base])
        assert np.mean([day.returned_by(150) for day in proposed]) >= np.mean([day.returned_by(150) for day in base])


@pytest.mark.parametrize(("rows", "repository", "bounds"), [
    (10, 0, (1100, 550, 367, 275, 220, 184, 147, 138, 110)), (5, 0, (400, 200, 134, 100, 80, 67, 54, 50, 41)),
])  # fmt: skip
def test_bounds_on_the_last_step(rows, repository, bounds):
    made = [least_makespan(OrchardRules(OrchardGrid(rows, 10, repository), m, 4)) for m in (2, 4, 6, 8, 10, 12, 15, 16, 20)]
    assert tuple(made) == bounds


@pytest.mark.parametrize(("rows", "repository", "most"), [
    (10, 0, (43, 57, 69, 80, 91, 101, 110, 119, 127, 135, 142, 149, 156, 160, 160, 160)),
    (10, 5, (50, 66, 80, 94, 106, 117, 128, 138, 147, 156, 160, 160)), (5, 0, (43, 56, 67, 77, 80)),
])  # fmt: skip
def test_bounds_on_bins_returned_by_step_150(rows, repository, most):
    made = [most_returned(OrchardRules(OrchardGrid(rows, 10, repository), m, 4), 150) for m in range(2, 2 + len(most))]
    assert tuple(made) == most


def test_all_ways_home_add_up_to_the_reference():
    for rows, repository, full, both in ((10, 0, 1440, 2200), (10, 5, 1120, 1720), (5, 0, 520, 800), (5, 2, 456, 704)):
        grid = OrchardGrid(rows, 10, repository)
        back = grid.full_times[grid.harvested, grid.home].sum()
        assert (2 * back, 2 * (back + grid.empty_times[grid.home, grid.harvested].sum())) == (full, both)


def test_auctions_among_robots_at_one_place_are_never_beaten():
    days = [play_day(OrchardRules(OrchardGrid(10, 10), 4, 4), seed) for seed in range(20)]
    assert sum(day.auctions for day in days) > 50
    several = [play_day(OrchardRules(OrchardGrid(10, 10), 8, 4), seed) for seed in range(20)]
    assert 0 < sum(day.beaten for day in several) < 0.05 * sum(day.auctions for day in several)


def test_a_hundred_days_are_quickly_played():
    """A compiled loop plays them; the guard is against one that is not."""
    rules = OrchardRules(OrchardGrid(10, 10), 20, 4)
    began = time.process_time()
    for seed in range(100):
        play_day(rules, seed)
    assert time.process_time() - began < HANG


def test_a_day_ends_when_it_is_asked_to_or_at_its_limit():
    rules = OrchardRules(OrchardGrid(10, 10), 1, 4)
    day = play_day(rules, 1, limit=10)
    assert day.steps == 10
    with pytest.raises(UsageError, check=coded("missing")):
        _ = day.makespan
    with pytest.raises(Stopped):
        play_day(rules, 1, stop=Stop(0.0))


def test_unknown_rules_are_refused():
    rules = lane(WHOLE_DAYS[0][0], 1)
    for key, known in (("choice", "greedy"), ("delivery", "baseline"), ("cost", "later")):
        with pytest.raises(UsageError, match=f"{key} must be one of {known}"):
            play_day(rules, 1, **{key: "best"})
