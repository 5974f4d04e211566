"""Risky paths whose optimum is enumerated: random maps, and ones on which the least risky way is not the most rewarding one."""

from functools import partial

import numpy as np

from .....formulations.risk.risky_path import RiskyPath
from .....instances.risk.element import RiskElement
from .....instances.risk.elements import LengthRisk, LocaleRisk, TurnRisk
from .....instances.risk.occupancy import OccupancyGrid
from .....instances.risk.risky_graph import RiskyGraph
from .....instances.risk.traverse_elements import CollectedRisk
from ....ratios.families import Family, listed
from ....ratios.judged_runs import Case
from ....ratios.optimum import attained

Rng = np.random.Generator

RISKS = (0.0, 0.01, 0.02, 0.04, 0.1, 0.2)


def random_map(rng: Rng, name: str, *, rewards: bool, discount: float = 1.0, gathering: bool = False) -> RiskyPath:
    """Nine cells, one of them perhaps occupied, neighbours along the axes: risks of places, lengths and turns, and where ``gathering`` of
    what the path has collected."""
    occupied = np.zeros((3, 3), dtype=bool)
    occupied.flat[int(rng.integers(1, 9))] = rng.random() < 0.5
    grid = OccupancyGrid(occupied)
    tail, head = grid.arcs(4)
    n = len(grid.cells)
    risks = rng.choice(RISKS, n)
    risks[0] = 0.01
    elements: tuple[RiskElement, ...] = (LocaleRisk(risks), LengthRisk(0.03), TurnRisk(0.1, "norm"))
    if gathering:
        elements += (CollectedRisk(rng.random(n) < 0.3, np.stack([np.zeros(n), np.full(n, 0.2)])),)
    collected = rng.integers(0, 5, n).astype(float) * rewards
    collected[-1] += rewards
    goals = () if rewards else (int(rng.integers(1, n)),)
    while goals and not np.isin(head, goals).any():
        goals = (int(rng.integers(1, n)),)
    return RiskyPath(RiskyGraph(n, tail, head, elements, 0, True, goals, collected, discount, positions=grid.positions, name=name))


def enumerated(problem: RiskyPath) -> Case:
    """A case with the best of all its paths."""
    graph = problem.graph
    ahead: list[tuple[int, ...]] = [(graph.start,)]
    best: tuple[float, tuple[int, ...]] | None = None
    while ahead:
        path = ahead.pop()
        verdict = problem.evaluate(path)
        better = best is None or (verdict.values[0] < best[0] if problem.sense == "min" else verdict.values[0] > best[0])
        if verdict.feasible and better:
            best = verdict.values[0], path
        ahead.extend((*path, state) for state in graph.neighbours(path[-1]) if state not in path)
    assert best is not None
    return Case(problem, attained(problem, best[1], "enumeration of all paths"))


def _random(k: int, rng: Rng, rewards: bool, discount: float, gathering: bool = False) -> Case:
    return enumerated(random_map(rng, f"map-{k}", rewards=rewards, discount=discount, gathering=gathering))


def least_risk() -> Family:
    """Random maps with a goal."""
    return Family("maps", "random maps of nine cells, least risk to a goal", partial(_random, rewards=False, discount=1.0))


def gathered_risk() -> Family:
    """Random maps with a goal, on which a risk hangs on what the path has collected."""
    return Family(
        "gathering maps", "random maps whose risks grow with what the path collects",
        partial(_random, rewards=False, discount=1.0, gathering=True),
    )  # fmt: skip


def rewarded(discount: float) -> Family:
    """Random maps with rewards."""
    counted = "all rewards count" if discount else "the last reward alone counts"
    return Family(
        f"rewarded maps, {discount:g}", f"random maps of nine cells, {counted}", partial(_random, rewards=True, discount=discount)
    )


def _decoy(share: float) -> Case:
    """Two ways to an end, the one with the reward at a little more risk: two stages see the other one alone."""
    elements = (LocaleRisk(np.array([0.0, 0.1, 0.1 + 1e-6, 0.0])),)
    tail, head, rewards = np.array([0, 0, 1, 2]), np.array([1, 2, 3, 3]), np.array([0.0, 0.0, 1.0, share])
    graph = RiskyGraph(4, tail, head, elements, 0, True, rewards=rewards, name=f"decoy-{share:g}")
    return enumerated(RiskyPath(graph))


def decoys() -> Family:
    """Ways whose rewards the upper stage does not see."""
    return listed("decoys", "the rewarding way is a little riskier", [partial(_decoy, share) for share in (1.0, 0.5, 0.1)])
