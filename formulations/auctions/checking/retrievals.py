"""Evidence ``retrievals``: a day in the orchard lasts until robots have made all retrievals, and until each bin can be home.

It holds for every instance, and has no data. A trip that fetches bin b takes a robot at least p_b = (way out) + (way home) steps, less what
it saves on its first trip if it does not begin at the repository. Hence the last step C has

    sum over robots of max(0, C - free_r)  >=  sum_b p_b - (what first trips save),

and the sum of all bins' steps is at least that of the shortest first on as many machines (Conway, Maxwell and Miller 1967). A bin comes
home no sooner than it and the bins before it can be full, and no sooner than a robot can have reached it: straight, or by the repository at
the faster of both speeds. All numbers are whole.
"""

from collections.abc import Mapping
from typing import Any

from ....instances.errors import InputError
from ...evidence import checker


@checker("retrievals", "orchard-day", "retrievals are", needs="jobs")
def check_retrievals(problem: Any, data: Mapping[str, Any]) -> float:
    """Lower bound on the last bin's step, or on the sum of all; the evidence must have no data.

    Source: docs/formulations/orchard-day.md#bounds.
    """
    jobs = problem.jobs
    if data:
        raise InputError("evidence of retrievals holds no data", found=str(sorted(data))[:80])
    grid, columns = jobs.grid, jobs.grid.columns

    def way(a: int, b: int, speed: int) -> int:
        (r1, c1), (r2, c2) = divmod(int(a), columns), divmod(int(b), columns)
        cells = abs(c1 - c2) if r1 == r2 else abs(r1 - r2) + min(c1 + c2, 2 * (columns - 1) - c1 - c2)
        return int(-(-cells // speed))

    home, empty, full = grid.repository * columns, grid.empty_speed, grid.full_speed
    robots = [(int(cell), int(free)) for cell, free in zip(jobs.robot_cells, jobs.robot_free, strict=True)]
    cells = [int(cell) for cell in jobs.bin_cells]
    back = [way(cell, home, full) for cell in cells]
    from_home = min(free + way(cell, home, max(empty, full)) for cell, free in robots)  # with a full bin, robots may be faster

    def reached(cell: int) -> int:
        straight = min(free + way(at, cell, empty) for at, free in robots)
        return min(straight, from_home + way(home, cell, empty))

    ready: list[int] = []
    soonest: list[int] = []
    for k, cell in enumerate(cells):
        before = ready[int(jobs.after[k])] if jobs.after[k] >= 0 else 0
        stood = 0 if jobs.standing[k] else from_home + way(home, cell, empty)
        ready.append(max(before, stood) + int(jobs.work[k]))
        soonest.append(max(ready[k], reached(cell)) + back[k])
    away = [at for at, _ in robots if at != home]
    if problem.objective == "completion":
        least = sorted(min(way(at, cell, empty) for at in (home, *away)) + b for cell, b in zip(cells, back, strict=True))
        shortest_first = sum(p * -(-(len(least) - k) // len(robots)) for k, p in enumerate(least))
        return float(max(sum(soonest), shortest_first))
    saved = sum(max(0, *(way(home, cell, empty) - way(at, cell, empty) for cell in cells)) for at in away)
    work = sum(way(home, cell, empty) + b for cell, b in zip(cells, back, strict=True)) - saved
    frees = sorted(free for _, free in robots)
    shared = min(-(-(work + sum(frees[: k + 1])) // (k + 1)) for k in range(len(frees)))
    return float(max(*soonest, shared, 0))
