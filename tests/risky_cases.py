"""Risky paths with known answers: tables and examples of Xiao (2019), and small graphs on which its planners go wrong."""

import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from waybound import RiskyGraph, RiskyPath
from waybound.instances.risk.element import RiskElement
from waybound.instances.risk.elements import LengthRisk, LocaleRisk, MoveRisk, TurnRisk
from waybound.instances.risk.occupancy import OccupancyGrid
from waybound.instances.risk.traverse_elements import CollectedRisk

TABLE_3_1_CELLS = [(2, 2), (3, 3), (4, 4), (5, 4), (6, 4), (7, 4), (7, 5), (7, 6), (7, 7), (7, 8), (8, 9), (9, 10)]
TABLE_3_1_DISTANCE = [0.01, 0, 0, 0.02, 0.04, 0.02, 0.04, 0.02, 0, 0, 0.01, 0.04]
TABLE_3_1_CONTACTS = [0.0] * 6 + [0.03] * 6

ELEMENTS = ("distance", "visibility", "length", "turn", "tether", "contacts")
RED = [
    (0.01, 0.02, 0, 0, 0.01, 0), *[(0.01, 0.02, 0.04, 0, 0.01, 0)] * 3, *[(0.01, 0.01, 0.04, 0, 0.02, 0)] * 2,
    (0.01, 0.01, 0.06, 0.05, 0.02, 0), (0.01, 0.01, 0.05, 0.05, 0.03, 0), (0.01, 0.01, 0.05, 0, 0.04, 0),
    (0.02, 0.02, 0.04, 0.05, 0.04, 0), (0.03, 0.04, 0.05, 0.05, 0.04, 0),
]  # fmt: skip
GREEN = [
    (0.01, 0.02, 0, 0, 0.01, 0), *[(0.01, 0.02, 0.04, 0, 0.01, 0)] * 3, (0.03, 0.01, 0.06, 0.05, 0.02, 0), (0.04, 0.01, 0.06, 0, 0.02, 0),
    (0.02, 0.01, 0.06, 0, 0.03, 0), (0.01, 0, 0.05, 0.05, 0.03, 0),
]  # fmt: skip


def hazardous(cost: float) -> float:
    """The risk whose hazard is ``cost``."""
    return -math.expm1(-cost)


def graph(
    arcs: Sequence[tuple[int, int]],
    elements: Iterable[RiskElement],
    *,
    states: int = 0,
    start: int = 0,
    conditional: bool = True,
    **given: Any,
) -> RiskyGraph:
    """A graph of a list of moves."""
    tail, head = np.array(arcs, dtype=np.int64).reshape(-1, 2).T
    return RiskyGraph(states or int(max(tail.max(), head.max())) + 1, tail, head, tuple(elements), start, conditional, **given)


BENT = np.array([(0, 0), (1, 0), (2, 1), (2, 2), (2, 4)], dtype=float)
LINE = [(0, 1), (1, 2), (2, 3), (3, 4)]


def risks(element: RiskElement, positions: Any = BENT, arcs: Any = LINE) -> Any:
    """Risks of the states of a path that passes them in turn."""
    states = len(positions)
    problem = RiskyPath(graph(arcs, [element], states=states, goals=(states - 1,), positions=positions))
    return problem.risks(range(states))[element.label]


def of_table(rows: Sequence[Sequence[float]], reward: float = 0.0) -> RiskyPath:
    """A path whose states have the risks of a table, one row a state."""
    columns = np.array(rows).T
    n = len(rows)
    rewards = np.zeros(n)
    rewards[-1] = reward
    elements = [LocaleRisk(column, name) for column, name in zip(columns, ELEMENTS, strict=True)]
    arcs = list(itertools.pairwise(range(n)))
    return RiskyPath(graph(arcs, elements, goals=(n - 1,), rewards=rewards, objective="reward-per-risk" if reward else "risk"))


def table_3_1() -> RiskyPath:
    """The worked example of 12 states."""
    elements = (
        LocaleRisk(np.array(TABLE_3_1_DISTANCE), "distance"), TurnRisk(0.02, "angle"), LocaleRisk(np.array(TABLE_3_1_CONTACTS), "contacts"),
    )  # fmt: skip
    positions = np.array(TABLE_3_1_CELLS, dtype=float)
    return RiskyPath(graph(list(itertools.pairwise(range(12))), elements, goals=(11,), positions=positions))


def ring(goal: tuple[int, int] = (0, 2), objective: str = "risk") -> RiskyPath:
    """Nine cells (x, y) without (0, 1): the way to a corner passes a cell by another way than the best one there. Hazards in twentieths."""
    cells = [(x, y) for x in range(3) for y in range(3) if (x, y) != (0, 1)]
    arcs = [(a, b) for a, p in enumerate(cells) for b, q in enumerate(cells) if abs(p[0] - q[0]) + abs(p[1] - q[1]) == 1]
    locale = np.zeros(8)
    locale[cells.index((1, 1))] = hazardous(3 / 20)
    elements = (LocaleRisk(locale), LengthRisk(1 / 20), TurnRisk(hazardous(2 / 20) / 2, "angle"))
    return RiskyPath(
        graph(
            arcs, elements, start=cells.index((0, 0)), goals=(cells.index(goal),), objective=objective,
            positions=np.array(cells, dtype=float), state_names=tuple(f"{x}{y}" for x, y in cells),
        )
    )  # fmt: skip


def two_ways(rewards: Sequence[float] = (0, 1, 2, 1), **given: Any) -> RiskyPath:
    """s-a-g and s-b-g, b a little riskier and more rewarding."""
    return RiskyPath(graph([(0, 1), (0, 2), (1, 3), (2, 3)], [LocaleRisk(np.array([0, 0.1, 0.11, 0]))], rewards=rewards, **given))


def _lettered(letters: str, moves: Sequence[str], elements: Callable[[dict[str, int], list[int], list[int]], list[RiskElement]],
              goal: str, objective: str) -> RiskyPath:  # fmt: skip
    at = {letter: k for k, letter in enumerate(letters)}
    tail, head = [at[m[0]] for m in moves], [at[m[1]] for m in moves]
    made = graph(
        list(zip(tail, head, strict=True)), elements(at, tail, head), goals=(at[goal],), objective=objective, state_names=tuple(letters)
    )
    return RiskyPath(made)


def mud(goal: str = "v", objective: str = "risk") -> RiskyPath:
    """Through m it is shorter, and 0.5 survive at v then instead of 0.95."""

    def elements(at: dict[str, int], tail: list[int], head: list[int]) -> list[RiskElement]:
        risk = np.zeros((2, 7))
        risk[:, at["v"]] = 0.05, 0.5
        moves = MoveRisk([-1] * len(tail), tail, head, [0.01] * len(tail))
        return [moves, CollectedRisk(np.array([letter == "m" for letter in at]), risk, "mud")]

    return _lettered("smabwuv", ["sm", "sa", "mw", "ab", "bw", "wu", "uv"], elements, goal, objective)


def mud_costs(goal: str = "v") -> RiskyPath:
    """The same by hazards: 1 a move, 9 more at v after m."""

    def elements(at: dict[str, int], tail: list[int], head: list[int]) -> list[RiskElement]:
        risk = np.zeros((2, 7))
        risk[1, at["v"]] = hazardous(9.0)
        moves = MoveRisk([-1] * len(tail), tail, head, [hazardous(1.0)] * len(tail))
        return [moves, CollectedRisk(np.array([letter == "m" for letter in at]), risk, "mud")]

    return _lettered("smabwuv", ["sm", "sa", "mw", "ab", "bw", "wu", "uv"], elements, goal, "hazard")


def dear_pair(letters: str, moves: Sequence[str], pair: str, objective: str = "hazard") -> RiskyPath:
    """Every move costs 1, the one of ``pair`` 10 more; from s to g."""

    def elements(at: dict[str, int], tail: list[int], head: list[int]) -> list[RiskElement]:
        every = MoveRisk([-1] * len(tail), tail, head, [hazardous(1.0)] * len(tail))
        return [every, MoveRisk(*[[at[letter]] for letter in pair], [hazardous(10.0)], "pair")]

    return _lettered(letters, moves, elements, "g", objective)


def loop(objective: str = "hazard") -> RiskyPath:
    """A walk round a loop dodges a dear pair of moves, which no path can."""
    return dear_pair("svgcd", ["sv", "vg", "vc", "cd", "dv"], "svg", objective)


def refusal(objective: str = "hazard") -> RiskyPath:
    """A search that refuses loops misses the best path."""
    return dear_pair("szabgyx", ["sz", "za", "ab", "bz", "zg", "sy", "yx", "xa"], "szg", objective)


def lattice(rows: int, columns: int, connectivity: int = 4, removed: Iterable[tuple[int, int]] = (), **given: Any) -> RiskyPath:
    """A grid from a corner, the same risk everywhere."""
    occupied = np.zeros((rows, columns), dtype=bool)
    for cell in removed:
        occupied[cell] = True
    grid = OccupancyGrid(occupied)
    n = len(grid.cells)
    tail, head = grid.arcs(connectivity)
    made = RiskyGraph(n, tail, head, (LocaleRisk(np.full(n, 0.01)),), 0, True, positions=grid.positions, **{"goals": (n - 1,), **given})
    return RiskyPath(made)


def random_map(rng: np.random.Generator, side: int = 3, *, muddy: bool = False, goal: int | None = None, **given: Any) -> RiskyPath:
    """A grid with random risks of places, lengths and turns, and perhaps mud that costs from the second muddy cell on."""
    grid = OccupancyGrid(np.zeros((side, side), dtype=bool))
    n = side * side
    tail, head = grid.arcs(4)
    risks = rng.choice([0, 0.01, 0.02, 0.04, 0.1, 0.2], n)
    risks[0] = 0.01
    elements: list[RiskElement] = [LocaleRisk(risks), LengthRisk(0.03, "linear"), TurnRisk(0.1, "norm")]
    if muddy:
        wet = rng.random(n) < 0.4
        elements.append(CollectedRisk(wet, np.array([np.zeros(n), np.where(wet, 0.4, 0.0)]), "mud"))
    goals = () if "rewards" in given else (n - 1 if goal is None else goal,)
    return RiskyPath(RiskyGraph(n, tail, head, tuple(elements), 0, True, goals, positions=grid.positions, **given))


def all_paths(problem: RiskyPath) -> list[tuple[int, ...]]:
    """Every path without repetition, the start alone included."""
    ahead, found = [(problem.graph.start,)], []
    while ahead:
        path = ahead.pop()
        found.append(path)
        ahead.extend((*path, state) for state in problem.graph.neighbours(path[-1]) if state not in path)
    return found


def best(problem: RiskyPath) -> float:
    """The optimum, by enumeration and the judge."""
    values = [verdict.values[0] for path in all_paths(problem) if (verdict := problem.evaluate(path)).feasible]
    return min(values) if problem.sense == "min" else max(values)


def named(problem: RiskyPath, path: Sequence[int]) -> str:
    """The states of a path by their names."""
    return " ".join(map(problem.graph.state_name, path))
