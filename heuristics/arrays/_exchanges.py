"""Exchanges of robots at places that are watched: scheduled one by one, and as a program with the fewest takeoffs."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...formulations.arrays.exchange_schedule import ExchangeCase, Sortie
from ...formulations.programs.program import Program, Rows, Variables


def robots_for_ever(charge: float, flight: float) -> int:
    """How many robots sustain one job for ever, ``ceil(charge / flight) + 1``. Source: Mitchell (2020), (A.2)."""
    return int(-(-charge // flight)) + 1


def feasible(ready: NDArray[np.int64], jobs: Sequence[tuple[int, float]], flight: int, charge: int) -> bool:
    """Whether the supply of charged robots keeps up with what ``jobs`` ask for, bin by bin of one flight time each.

    ``ready`` is when each robot is charged, 0 for those aloft; a job asks for a number of robots at a time, for so many steps (infinite if
    for ever). By the end of bin i a job has asked for ``robots * min(i + 1, its bins, persistence number)``. Source: Mitchell (2020),
    appendix A.1, as a test of all bins: docs/missions/fleet-energy.md#errata.
    """
    most = robots_for_ever(charge, flight)
    for i in range(most):
        asked = sum(robots * min(i + 1, most, -(-duration // flight)) for robots, duration in jobs)
        if asked > int((ready <= i * flight).sum()):
            return False
    return True


def one_by_one(case: ExchangeCase) -> list[Sortie]:
    """Exchanges in the order in which batteries run out, each as late as the leaving robot's battery allows, by a charged robot nearby.

    Robots that are needed at one instant are matched to their places so that the ways are short in sum (Hungarian method). If nobody can
    be there in time, the place is alone until whoever can be there first. Ties go to the first place and robot. Source: Mitchell (2020),
    appendix A.1 (exchange scheduling); docs/missions/fleet-energy.md#schedules.
    """
    from scipy.optimize import linear_sum_assignment

    free, travel = case.ready.astype(np.int64).copy(), case.travel
    useful = 2 * travel < case.flight
    schedule: list[Sortie] = []
    until = {place: int(begin) for place, begin in enumerate(case.begin)}
    for robot, (place, takeoff, arrive) in sorted(case.aloft.items()):
        here = max(arrive, 0)
        leave = max(min(takeoff + case.flight - int(travel[robot, place]), int(case.end[place])), here)
        schedule.append(Sortie(robot, place, here, leave))
        free[robot] = leave + travel[robot, place] + case.charge
        if here <= until[place]:
            until[place] = max(until[place], leave)
    while until := {place: when for place, when in until.items() if when < case.end[place]}:
        now = min(until.values())
        due = [place for place in sorted(until) if until[place] == now]
        inside = (useful[:, due] & (free[:, None] + travel[:, due] <= now)).T
        never = 1 + len(due) * int(travel.max())
        for k, robot in zip(*linear_sum_assignment(np.where(inside, travel[:, due].T, never)), strict=True):
            if inside[k, robot]:
                way = int(travel[robot, due[k]])
                until[due[k]] = min(now + case.flight - 2 * way, int(case.end[due[k]]))
                schedule.append(Sortie(int(robot), due[k], now, until[due[k]]))
                free[robot] = until[due[k]] + way + case.charge
        for place in due:
            if until[place] == now:
                times = (free + travel[:, place])[useful[:, place]]
                until[place] = int(times.min()) if len(times) else int(case.end[place])
    return schedule


def exchange_program(case: ExchangeCase) -> tuple[Program, NDArray[np.int64]]:
    """The fewest takeoffs, and before that the fewest steps at which a place is alone, as an integer program; and its columns.

    Robots whose pads are equally far from all places are one class. A column is a sortie of a class, shape (columns, 4): class, place,
    arrival and leaving; of a robot aloft it is ``-1 - robot``, and leaving is all that is open. Then comes one column for each step of each
    place at which it may be alone. Rows: somebody is at each place, or it is alone; of a class no more are flying or charging than there
    are; a robot aloft stays until one time. Where nobody can fly twice, only the longest watches are columns: shorter ones gain nothing.
    The mathematics: docs/missions/fleet-energy.md#fewest-exchanges.
    """
    import scipy.sparse as sp

    _, first, classes = np.unique(case.travel, axis=0, return_index=True, return_inverse=True)
    last, aloft = int(case.end.max(initial=0)), np.array(sorted(case.aloft), dtype=np.int64)
    classes = classes.reshape(-1)
    columns: list[tuple[int, int, int, int]] = []
    for k, row in enumerate(case.travel[first]):
        soonest = int(np.where(np.isin(np.arange(len(classes)), aloft), 0, case.ready)[classes == k].min())
        again = soonest + 2 + case.charge < last
        for place, way in enumerate(row.tolist()):
            end = int(case.end[place])
            for arrive in range(max(int(case.begin[place]), soonest + way), end):
                latest = min(arrive + case.flight - 2 * way, end)
                columns += [(k, place, arrive, leave) for leave in range(arrive + 1 if again else latest, latest + 1) if leave > arrive]
    for robot in aloft.tolist():
        place, takeoff, arrive = case.aloft[robot]
        here = max(arrive, 0)
        leave = max(min(takeoff + case.flight - int(case.travel[robot, place]), int(case.end[place])), here)
        columns += [(-1 - robot, place, here, k) for k in range(here, leave + 1)]
    table = np.array(columns, dtype=np.int64).reshape(-1, 4)
    steps = [(place, step) for place in range(len(case.begin)) for step in range(int(case.begin[place]), int(case.end[place]))]
    where = {key: k for k, key in enumerate(steps)}
    watched = [(where[place, step], j) for j, (_, place, a, b) in enumerate(columns) for step in range(a, b) if (place, step) in where]
    own = np.where(table[:, 0] < 0, classes[np.minimum(-1 - table[:, 0], len(classes) - 1)], table[:, 0])
    ways = case.travel[first[own], table[:, 1]] if len(table) else np.zeros(0, dtype=np.int64)
    out, back = np.where(table[:, 0] < 0, 0, table[:, 2] - ways), table[:, 3] + ways + case.charge
    busy = [(int(own[j]) * last + step, j) for j in range(len(table)) for step in range(int(out[j]), min(int(back[j]), last))]
    ready = np.where(np.isin(np.arange(len(classes)), aloft), 0, case.ready)
    supply = np.array([((classes == k) & (ready <= step)).sum() for k in range(len(first)) for step in range(last)], dtype=np.float64)
    stays = [(int(np.searchsorted(aloft, -1 - table[j, 0])), j) for j in range(len(table)) if table[j, 0] < 0]
    alone = [(k, len(table) + k) for k in range(len(steps))]

    def rows(name: str, entries: Sequence[tuple[int, int]], lower: NDArray[np.float64], upper: NDArray[np.float64]) -> Rows:
        at = np.array(entries, dtype=np.int64).reshape(-1, 2)
        matrix = sp.csr_matrix((np.ones(len(at)), (at[:, 0], at[:, 1])), shape=(len(lower), len(table) + len(steps)))
        parts = {"indptr": matrix.indptr.astype(np.int32), "indices": matrix.indices.astype(np.int32), "data": matrix.data}
        return Rows(name, (np.arange(len(lower)),), lower=lower, upper=upper, **parts)

    one, many = np.ones(len(steps)), np.full(len(steps), np.inf)
    blocks = (
        rows("watched", [*watched, *alone], one, many), rows("robots", busy, np.full(len(supply), -np.inf), supply),
        rows("aloft", stays, np.ones(len(aloft)), np.ones(len(aloft))),
    )  # fmt: skip
    sorties = Variables(
        "sortie", (np.arange(len(table)),), lower=np.zeros(len(table)), upper=np.ones(len(table)),
        cost=(table[:, 0] >= 0).astype(np.float64), integer=True,
    )  # fmt: skip
    gaps = Variables("alone", (np.arange(len(steps)),), lower=0 * one, upper=one, cost=np.full(len(steps), 1.0 + len(steps)))
    return Program("exchanges", "min", (sorties, gaps), blocks), table


def scheduled(case: ExchangeCase, columns: NDArray[np.int64], answer: NDArray[np.float64]) -> list[Sortie]:
    """The schedule of an answer of ``exchange_program``: in the order of takeoffs, the robot of the class that is free first."""
    _, classes = np.unique(case.travel, axis=0, return_inverse=True)
    chosen = columns[np.round(answer[: len(columns)]) > 0.5]
    schedule, free = [], case.ready.astype(np.int64).copy()
    for kind, place, arrive, leave in chosen[chosen[:, 0] < 0].tolist():
        robot = -1 - kind
        schedule.append(Sortie(robot, place, arrive, leave))
        free[robot] = leave + case.travel[robot, place] + case.charge
    own = sorted(chosen[chosen[:, 0] >= 0].tolist(), key=lambda s: (s[2] - case.travel[classes.reshape(-1) == s[0]][0, s[1]], *s))
    for kind, place, arrive, leave in own:
        robots = np.flatnonzero(classes.reshape(-1) == kind)
        robot = int(robots[np.argmin(free[robots])])
        schedule.append(Sortie(robot, place, arrive, leave))
        free[robot] = leave + case.travel[robot, place] + case.charge
    return schedule
