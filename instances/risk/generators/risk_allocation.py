"""Chance-constrained plans of vehicles with linear dynamics: above a sea floor, and through a bent corridor.

``auv``: depth keeping, a double integrator whose mean altitude is minimised while it stays above a sea floor, after the example of Ono and
Williams (2008). ``corridor``: a double integrator in the plane that reaches a goal between two walls with the least fuel, the sum of the
absolute inputs. ``obstacles``: the same plane without walls and with boxes in the way, each step on one of the four sides of each. Seed 1
of the first two with its other settings at their defaults is a fixed problem of the literature's kind; other seeds draw floor, walls and
noise.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...errors import UsageError
from ...generators import GENERATORS, Draw, Floats, Generator, Setting
from ..allocation import MOST_RISK, RISKS, Affine, ChanceConstraints, CostTerm, Risk, RiskAllocationInstance
from ..gaussian import Dynamics

FAMILIES = ("auv", "corridor", "obstacles")

SETTINGS = {
    "family": Setting("auv", "above a sea floor, through a corridor, or around obstacles", choices=FAMILIES),
    "steps": Setting(20, "number of steps", least=1, most=1000),
    "total": Setting(None, "risk of all constraints together; by default 0.05, and 0.001 in a corridor", type=float, least=1e-12, most=0.5),
    "risk": Setting("allocated", "how risk is counted", choices=RISKS),
    "constraints": Setting(2, "constraints a step in a corridor: its walls, or these and two limits of the speed across", least=2, most=4),
    "obstacles": Setting(2, "number of obstacles", least=1, most=20),
    "name": Setting(None, "name of the instance", type=str),
}


def make(draw: Draw, settings: Mapping[str, Any]) -> RiskAllocationInstance:
    """One instance."""
    family, steps = settings["family"], settings["steps"]
    instance = {"auv": _auv, "corridor": _corridor, "obstacles": _obstacles}[family](draw, settings)
    name = settings["name"] or f"risk-{family}-t{steps}-s{settings['seed']}"
    object.__setattr__(instance, "name", name)
    return instance


def _vary(draw: Draw, settings: Mapping[str, Any], low: float, high: float) -> float:
    """Factor of a quantity: 1 for seed 1, whose problem is fixed, else drawn."""
    return 1.0 if settings["seed"] == 1 else float(draw.uniform(low, high, 1)[0])


def _shorter(steps: int) -> Floats:
    """Factors of the variances of positions and of speeds, with which many steps spread about as far as 20."""
    part = min(1.0, 20 / steps)
    return np.array([part, part**3])


def _auv(draw: Draw, settings: Mapping[str, Any]) -> RiskAllocationInstance:
    steps = settings["steps"]
    a, b = np.array([[1.0, 1.0], [0.0, 1.0]]), np.array([[0.5], [1.0]])
    noise = np.diag([0.15, 0.02]) ** 2 * _vary(draw, settings, 0.5, 1.5) @ np.diag(_shorter(steps))
    t = np.arange(1, steps + 1) * (20 / max(steps, 20))
    floor = 6.0 * _vary(draw, settings, 0.6, 1.1) * np.sin(t / 3.2) + 0.25 * t
    dynamics = Dynamics(a, b, noise, np.array([12.0, 0.0]), np.zeros((2, 2)), steps, ("altitude", "rate"), ("thrust",))
    heights = np.zeros((steps, 2 * steps))
    heights[np.arange(steps), 2 * np.arange(steps)] = -1.0
    cost = -heights.sum(axis=0) / steps
    rows = Affine(np.zeros((steps, steps)), heights, np.zeros(steps))
    names = tuple(f"floor@{k + 1}" for k in range(steps))
    chance = ChanceConstraints(rows, -floor, names, np.arange(steps))
    return _instance(dynamics, cost, (), chance, settings, 0.05, 0.9)


def _plane(settings: Mapping[str, Any], deviation: float, factor: float) -> Dynamics:
    a, b = np.eye(4), np.zeros((4, 2))
    a[0, 2] = a[1, 3] = 1.0
    b[[0, 1], [0, 1]], b[[2, 3], [0, 1]] = 0.5, 1.0
    noise = (
        np.diag([deviation, deviation, deviation / 10, deviation / 10]) ** 2 * factor @ np.diag(np.repeat(_shorter(settings["steps"]), 2))
    )
    return Dynamics(a, b, noise, np.zeros(4), np.zeros((4, 4)), settings["steps"], ("x", "y", "vx", "vy"), ("ux", "uy"))


def _fuel(steps: int) -> CostTerm:
    n = 2 * steps
    return CostTerm("absolute", 1.0, Affine(np.eye(n), np.zeros((n, 4 * steps)), np.zeros(n)))


def _corridor(draw: Draw, settings: Mapping[str, Any]) -> RiskAllocationInstance:
    steps, sides = settings["steps"], settings["constraints"]
    if sides == 3:
        raise UsageError("constraints must be 2 or 4, not 3", "out-of-range")
    dynamics = _plane(settings, 0.01, _vary(draw, settings, 0.5, 2.0))
    t = np.arange(1, steps + 1) / steps
    low = 2.4 * _vary(draw, settings, 0.5, 1.1) * np.sin(math.pi * t) - 0.5
    high = low + 1.1
    speed = np.full(steps, 12.0 / steps)
    state, signs, limits = (1, 1, 3, 3), (-1.0, 1.0, -1.0, 1.0), (-low, high, speed, speed)
    heights, bounds = np.zeros((steps, sides, steps, 4)), np.zeros((steps, sides))
    for k in range(sides):
        heights[np.arange(steps), k, np.arange(steps), state[k]] = signs[k]
        bounds[:, k] = limits[k]
    names = ("right", "left", "slow-right", "slow-left")[:sides]
    rows = Affine(np.zeros((steps * sides, 2 * steps)), heights.reshape(steps * sides, 4 * steps), np.zeros(steps * sides))
    chance = ChanceConstraints(rows, bounds.ravel(), tuple(f"{n}@{k + 1}" for k in range(steps) for n in names), np.arange(steps * sides))
    return _instance(dynamics, None, (10.0, 0.0), chance, settings, 0.001, 0.4)


def _obstacles(draw: Draw, settings: Mapping[str, Any]) -> RiskAllocationInstance:
    steps, count = settings["steps"], settings["obstacles"]
    dynamics = _plane(settings, 0.02, _vary(draw, settings, 0.5, 2.0))
    width, height = draw.uniform(0.8, 1.8, count), draw.uniform(1.0, 2.4, count)
    x = (np.arange(count) + draw.uniform(0.3, 0.7, count)) * 8.0 / count + 1.0
    y = draw.uniform(-0.6, 0.6, count)
    heights, bounds = np.zeros((steps, count, 4, steps, 4)), np.zeros((steps, count, 4))
    every = np.arange(steps)
    for k, (axis, sign) in enumerate(((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0))):  # before, beyond, right of and left of the box
        heights[every, :, k, every, axis] = sign
        middle, half = (x, width) if axis == 0 else (y, height)
        bounds[:, :, k] = sign * middle - half / 2.0
    size = steps * count * 4
    rows = Affine(np.zeros((size, 2 * steps)), heights.reshape(size, 4 * steps), np.zeros(size))
    names = tuple(f"box{b + 1}@{t + 1}" for t in range(steps) for b in range(count))
    chance = ChanceConstraints(rows, bounds.ravel(), names, np.repeat(np.arange(steps * count), 4))
    return _instance(dynamics, None, (10.0, 0.0), chance, settings, 0.01, 0.4 * max(1.0, 20 / steps) ** 2)


def _instance(
    dynamics: Dynamics, height: Any, goal: tuple[float, ...], chance: ChanceConstraints, settings: Mapping[str, Any], total: float, most:
    float
) -> RiskAllocationInstance:  # fmt: skip
    """Least mean of ``height`` over the states, or least fuel where it is None; ends at ``goal`` in the mean; inputs within ``most``."""
    quantities, steps = dynamics.quantities(), dynamics.steps
    n, q = len(dynamics.decision_names()), len(quantities.names)
    last = np.zeros((len(goal), q))
    last[np.arange(len(goal)), q - len(dynamics.state_names) + np.arange(len(goal))] = 1.0
    risk = settings["total"] or total
    end = np.array(goal, dtype=np.float64)
    return RiskAllocationInstance(
        np.full(n, -most), np.full(n, most), dynamics.decision_names(), quantities,
        Affine(np.zeros((1, n)), np.zeros((1, q)) if height is None else height[None], np.zeros(1)), chance,
        Risk(settings["risk"], risk, np.full(len(chance.names), min(risk, MOST_RISK))),
        Affine(np.zeros((len(goal), n)), last, np.zeros(len(goal))), end, end, tuple(f"goal-{dynamics.state_names[k]}" for k in
        range(len(goal))), terms=(_fuel(steps),) if height is None else (), format="generated",
    )  # fmt: skip


GENERATORS.enter(Generator("risk-allocation", "chance-constrained plans of vehicles with linear dynamics", SETTINGS, make))
