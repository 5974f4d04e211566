"""Days played by the compiled loop."""

from dataclasses import dataclass

import numpy as np

from .....formulations.stop import NEVER, Stop, Stopped
from .....instances.auctions.orchard_rules import OrchardRules, OrchardStart, draw_start
from .....instances.errors import UsageError
from .....instances.generators import Draw
from .....instances.number_arrays import Integers
from .policies import CHOICES, COSTS, DELIVERIES

MOST_STEPS = 1_000_000


@dataclass(frozen=True, eq=False)
class Day:
    """The course of a day: steps at which each bin stood, was full and came home (-1 for never), and counts.

    ``idle_steps`` are those that groups waited for bins, all together; ``beaten`` are the ``auctions`` of several robots that an assignment
    of the same robots beats.
    """

    stood: Integers
    full: Integers
    returned: Integers
    steps: int
    idle_steps: int
    auctions: int
    beaten: int

    @property
    def makespan(self) -> int:
        """The step at which the last bin came home."""
        if (self.returned < 0).any():
            raise UsageError(f"after {self.steps} steps not all bins are at the repository", "missing")
        return int(self.returned.max())

    def returned_by(self, step: int) -> int:
        """Bins at the repository at a step."""
        return int(((self.returned >= 0) & (self.returned <= step)).sum())


def play_day(
    rules: OrchardRules,
    seed: int = 1,
    choice: str = "auction",
    delivery: str = "proposed",
    cost: str = "later",
    *,
    start: OrchardStart | None = None,
    limit: int = MOST_STEPS,
    stop: Stop = NEVER,
) -> Day:
    """Play a day until all bins are home, by the rules that ``run`` has as policies: the same day, to the step.

    ``seed`` is that of the groups' start, as in ``make_world``, unless ``start`` tells it; ``choice``, ``delivery`` and ``cost`` are those
    of ``policies``. Raises Stopped.
    """
    from .day_kernels import day

    for what, value, known in (("choice", choice, CHOICES), ("delivery", delivery, DELIVERIES), ("cost", cost, COSTS)):
        if value not in known:
            raise UsageError(f"{what} must be one of {', '.join(known)}, not {value!r}", "unknown-name")
    grid = rules.grid
    begin = draw_start(rules, Draw(np.random.Generator(np.random.PCG64(seed)))) if start is None else start
    fruit = np.zeros(grid.size, np.int64)
    fruit[grid.harvested] = rules.bins_per_cell
    times = (np.full(rules.bins, -1), np.full(rules.bins, -1), np.full(rules.bins, -1))
    codes = CHOICES.index(choice), DELIVERIES.index(delivery), COSTS.index(cost)
    shape = (grid.distances, grid.empty_times, grid.full_times, grid.home)
    counts = day(
        stop.flag, shape, (np.ascontiguousarray(begin.cells), begin.orders, fruit), (rules.robots, rules.fill), codes, limit, times
    )
    if stop.reached():
        raise Stopped
    return Day(*times, *(int(number) for number in counts))


def least_makespan(rules: OrchardRules) -> int:
    """Steps that every way to play the day takes: all retrievals shared evenly by the robots, and all picking by the groups.

    Source: docs/formulations/orchard-day.md#bounds.
    """
    grid = rules.grid
    out, back = grid.empty_times[grid.home, grid.harvested], grid.full_times[grid.harvested, grid.home]
    work = rules.bins_per_cell * int((out + back).sum())
    picking = -(-rules.fill * rules.bins // rules.groups) + int(back.min())
    return max(-(-work // rules.robots), picking)


def most_returned(rules: OrchardRules, step: int) -> int:
    """A bound on the bins at the repository at ``step``: the shortest retrievals for which the robots' steps suffice."""
    grid = rules.grid
    each = np.sort(np.repeat(grid.empty_times[grid.home, grid.harvested] + grid.full_times[grid.harvested, grid.home], rules.bins_per_cell))
    return int(np.searchsorted(np.cumsum(each), step * rules.robots, side="right"))
