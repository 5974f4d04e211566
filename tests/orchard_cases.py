"""Small orchards whose optima and days are known."""

import numpy as np

from waybound import OrchardDay, OrchardJobs
from waybound.instances.auctions.orchard_grid import OrchardGrid
from waybound.instances.auctions.orchard_rules import OrchardRules, OrchardStart
from waybound.instances.auctions.worlds.orchard import OrchardWorld
from waybound.reports.missions.auctions.orchard_days.policies import CHOOSING, trips

LANE = OrchardGrid(1, 6)
ONE_ROUTE = OrchardStart(np.array([1]), np.array([[1, 2, 3, 4]]))
TWO_ROUTES = OrchardStart(np.array([1, 4]), np.array([[1, 2], [4, 3]]))

FOUR = (("greedy", "baseline"), ("auction", "baseline"), ("greedy", "proposed"), ("auction", "proposed"))

WHOLE_DAYS = [
    (ONE_ROUTE, 1, (47, 47, 45, 45), 37), (ONE_ROUTE, 2, (31, 31, 30, 30), 21), (ONE_ROUTE, 3, (31, 31, 30, 30), 20),
    (TWO_ROUTES, 1, (45, 45, 36, 39), 33), (TWO_ROUTES, 2, (25, 25, 20, 20), 17), (TWO_ROUTES, 3, (20, 20, 16, 16), 13),
]  # fmt: skip
"""Start, robots, last steps of the rules of ``FOUR``, and the least of any plan."""

SCHEDULES = {
    "S1": (((0, 2), (1, 1), (0, 4)), (0, 0, 0), ((0, 0), (0, 0)), (3, 3, 6), 6, 15),
    "S2": (((0, 1), (0, 8), (4, 8)), (5, 0, 0), ((0, 0), (0, 0)), (2, 12, 18), 18, 42),
    "S3": (((0, 1), (1, 1), (2, 3), (3, 4), (4, 5), (4, 8)), (0,) * 6, ((0, 0), (0, 0)), (2, 3, 8, 11, 14, 18), 28, 85),
    "S4": (((0, 2), (1, 2)), (0, 0), ((0, 0), (0, 6)), (3, 5), 5, 9),
    "S5": (((0, 2), (1, 2), (0, 6), (2, 5)), (0, 0, 3, 0), ((0, 0), (0, 6)), (3, 5, 9, 11), 14, 38),
}
"""Places, steps at which bins are full, robots, ways out and home, least last step, least sum."""


def lane(start, robots):
    return OrchardRules(LANE, robots, len(start.cells))


def retrievals(places, full, robots=((0, 0), (0, 0)), objective="makespan"):
    """Bins that stand and are full at given steps, in five lanes of ten cells."""
    grid, count = OrchardGrid(5, 10), len(places)
    jobs = OrchardJobs(
        grid, grid.cells(robots), np.zeros(len(robots), int), grid.cells(places), np.full(count, -1), np.ones(count, bool), np.array(full)
    )
    return OrchardDay(jobs, objective)


def random_jobs(rng, robots=3, bins=5):
    """Bins in chains, some to be brought, and robots here and there."""
    grid = OrchardGrid(int(rng.integers(1, 4)), int(rng.integers(3, 7)), 0, int(rng.integers(1, 4)), int(rng.integers(1, 3)))
    after, last = [], []
    for k in range(bins):
        group = int(rng.integers(0, len(last) + 1))
        after.append(last[group] if group < len(last) else -1)
        if group < len(last):
            last[group] = k
        else:
            last.append(k)
    standing = np.array([before < 0 or bool(rng.random() < 0.3) for before in after]) & (rng.random(bins) < 0.8)
    cells = np.where(rng.random(robots) < 0.5, grid.home, rng.integers(0, grid.size, robots))
    return OrchardJobs(
        grid, cells, rng.integers(0, 4, robots), rng.choice(grid.harvested, bins), np.array(after), standing, rng.integers(0, 5, bins)
    )


def played(rules, seed, choice, delivery, cost="later", start=None):
    """The world after a day by the rules, step by step."""
    world = OrchardWorld(rules, np.random.Generator(np.random.PCG64(seed)), start=start)
    while (world.returned < 0).any():
        o = world.observe()
        world.step(trips(o, CHOOSING[choice](o, cost) if len(o.bins) else {}, delivery))
    return world
