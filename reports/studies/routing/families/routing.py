"""Routing problems: random ones whose optimum is enumerated, and ones on which tours and their cuts do badly."""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from .....formulations.routing.objective import LongestRoute, Makespan, Objective, Reward
from .....formulations.routing.overrun import quantile
from .....formulations.routing.problem import RoutingProblem
from .....formulations.routing.routes import Routes
from .....instances.routing.instance import Sites, VehicleType
from .....instances.routing.travel import EXPLICIT, Travel
from ....ratios.families import Family, listed
from ....ratios.judged_runs import Case
from ....ratios.optimum import attained

Rng = np.random.Generator

MOST = 7
"""Customers of a random problem at most: all ways to route them are compared."""

RISKY = 4
"""Customers of one with risks at most, all of whose routings are judged."""

NEARLY = 1e-9
"""Difference of moves that are meant to tie, for the one that leads astray to be the shorter."""

KINDS = ("plane", "clusters", "grid", "graph", "rounded")


def travel_of(rng: Rng, kind: str, n: int) -> Travel:
    """Symmetric distances between ``n`` sites of a kind.

    They lie in the plane, in clusters, on a grid with several in one place, or along shortest paths of a graph; or distances are rounded to
    whole numbers, so that the triangle inequality fails by little.
    """
    if kind == "clusters":
        xy = rng.integers(0, 100, (3, 2))[rng.integers(0, 3, n)] + rng.normal(0, 2, (n, 2))
        return Travel("euclidean", xy)
    if kind == "grid":
        return Travel("manhattan", rng.integers(0, 4, (n, 2)).astype(float))
    if kind == "graph":
        lengths = np.where(rng.random((n, n)) < 0.5, rng.integers(1, 10, (n, n)), 30).astype(float)
        lengths = np.minimum(lengths, lengths.T)
        for k in range(n):
            lengths = np.minimum(lengths, lengths[:, [k]] + lengths[k])
        return Travel(EXPLICIT, matrix=lengths)
    if kind == "rounded":
        return Travel("EUC_2D", rng.integers(0, 12, (n, 2)).astype(float))
    return Travel("euclidean", rng.uniform(0, 100, (n, 2)))


def _sites(n: int, **data: Any) -> Sites:
    return Sites.of(range(n), **data)


def salesman(k: int, rng: Rng, kind: str) -> Case:
    """One vehicle that can serve all."""
    n = int(rng.integers(2, MOST + 2))
    return Case(RoutingProblem(_sites(n), travel_of(rng, kind, n), (VehicleType(),), name=f"{kind}-{k}", problem="tsp"))


def loads(k: int, rng: Rng, kind: str) -> Case:
    """Vehicles with a capacity: equal demands, whole ones, or others."""
    n = int(rng.integers(2, MOST + 2))
    demand = [np.full(n, 3.0), rng.integers(1, 12, n).astype(float), 2.0 * rng.integers(0, 6, n), rng.uniform(0, 1, n)][k % 4]
    capacity = float(max(demand[1:].max(), rng.uniform(0.1, 1.1) * demand[1:].sum(), 0.5))
    vehicle = VehicleType(capacity=capacity if k % 4 == 3 else float(np.ceil(capacity)), fixed_cost=float(rng.choice([0.0, 0.0, 20.0])))
    return Case(RoutingProblem(_sites(n, demand=demand), travel_of(rng, kind, n), (vehicle,), name=f"{kind}-{k}"))


def shared(k: int, rng: Rng, kind: str) -> Case:
    """A few vehicles whose longest route counts, by distance or with services by duration."""
    n, vehicles = int(rng.integers(2, MOST + 2)), int(rng.integers(1, 5))
    service = rng.integers(0, 30, n).astype(float) if k % 2 else np.zeros(n)
    aim = Objective.of(Makespan() if k % 2 else LongestRoute())
    return Case(
        RoutingProblem(_sites(n, service=service), travel_of(rng, kind, n), (VehicleType(count=vehicles),), aim, name=f"{kind}-{k}")
    )


def rewarded(k: int, rng: Rng, kind: str) -> Case:
    """A few vehicles that collect rewards within a distance from which at least one site can be reached."""
    n, travel = int(rng.integers(3, MOST + 2)), travel_of(rng, kind, MOST + 1)
    sites = _sites(n, reward=np.r_[0.0, rng.integers(1, 20, n - 1)], required=False)
    travel = Travel(EXPLICIT, matrix=travel.distances[:n, :n])
    near = 2.0 * travel.distances[0, 1:]
    vehicle = VehicleType(count=1 + k % 3, max_distance=float(near.min() + rng.uniform(0, 1) * near.sum() + 1.0))
    return Case(RoutingProblem(sites, travel, (vehicle,), Objective.of(Reward()), name=f"{kind}-{k}"))


def risky(k: int, rng: Rng, kind: str) -> Case:
    """Vehicles whose uncertain durations are limited at a risk, of each route or of all; each customer may have a route of its own."""
    n, travel = int(rng.integers(2, RISKY + 2)), travel_of(rng, kind, RISKY + 1)
    matrix = travel.distances[:n, :n]
    variances = (1.0 + matrix) * rng.uniform(0.0, 1.0, (n, n)) * max(1.0, 0.2 * float(matrix.mean()))
    risk = float(rng.choice([0.01, 0.05, 0.2]))
    far = matrix[0] + matrix[:, 0] + quantile(risk / RISKY) * np.sqrt(variances[0] + variances[:, 0])
    vehicle = VehicleType(max_duration=float(far.max() * rng.uniform(1.3, 2.5) + 1.0), risk=None if k % 2 else risk)
    travel = Travel(EXPLICIT, matrix=matrix, variances=variances)
    problem = RoutingProblem(_sites(n), travel, (vehicle,), name=f"{kind}-{k}", team_risk=risk if k % 2 else None)
    every = [Routes.of(routes) for routes in _routings(problem.customers.tolist())]
    best = min((v.values[0], at) for at, v in enumerate(map(problem.evaluate, every)) if v.feasible)[1]
    return Case(problem, attained(problem, every[best], "enumeration"))


def _routings(customers: list[int]) -> Iterator[list[tuple[int, ...]]]:
    """All ways to visit the customers by routes."""
    if not customers:
        yield []
    for routes in _routings(customers[1:]) if customers else ():
        yield [tuple(customers[:1]), *routes]
        for k, route in enumerate(routes):
            for at in range(len(route) + 1):
                yield [*routes[:k], (*route[:at], customers[0], *route[at:]), *routes[k + 1 :]]


def random_families(make: str) -> tuple[Family, ...]:
    """The random families of ``salesman``, ``loads``, ``shared``, ``rewarded`` or ``risky`` problems."""
    case = {"salesman": salesman, "loads": loads, "shared": shared, "rewarded": rewarded, "risky": risky}[make]
    most = RISKY if make == "risky" else MOST
    words = {"plane": "uniform", "clusters": "three clusters", "grid": "few places", "graph": "shortest paths", "rounded": "rounded"}
    return tuple(Family(kind, f"{words[kind]}, up to {most} customers", partial(case, kind=kind)) for kind in KINDS)


def strip(n: int) -> Case:
    """Two rows in zigzag: the tree goes from one end to the other, and the matching all the way back (Cornuejols and Nemhauser 1978)."""
    apart = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
    travel = Travel(EXPLICIT, matrix=apart // 2 * (1 + NEARLY) + apart % 2)
    problem = RoutingProblem(_sites(n), travel, (VehicleType(),), name=f"strip-{n}", problem="tsp")
    tour = [*range(2, n, 2), *reversed(range(1, n, 2))]
    return Case(problem, attained(problem, Routes.of([tour]), "construction"))


def strips() -> Family:
    """Instances whose ratio tends to 3/2 for Christofides' tour."""
    return listed("strip", "a zigzag, on which the matching is half a tour", [partial(strip, n) for n in (4, 5, 8, 13, 20, 31, 50)])


def star(n: int, capacity: float, demand: float) -> Case:
    """Customers that are as far from each other as by way of the depot."""
    matrix = np.where(np.eye(n + 1, dtype=bool), 0.0, 2.0)
    matrix[0, 1:] = matrix[1:, 0] = 1.0
    sites = _sites(n + 1, demand=np.r_[0.0, np.full(n, demand)])
    return Case(RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix), (VehicleType(capacity=capacity),), name=f"star-{n}-{capacity:g}"))


def heaps(sizes: tuple[int, ...], capacity: float) -> Case:
    """Customers in one place each heap, all heaps equally far from the depot and from each other."""
    heap = np.repeat(np.arange(1, len(sizes) + 1), sizes)
    place = np.r_[0, heap]
    matrix = np.where(place[:, None] == place[None, :], 0.0, np.where((place == 0)[:, None] | (place == 0)[None, :], 1.0, 0.01))
    sites = _sites(len(place), demand=np.r_[0.0, np.ones(len(heap))])
    name = f"heaps-{'-'.join(map(str, sizes))}-{capacity:g}"
    return Case(RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix), (VehicleType(capacity=capacity),), name=name))


def big_and_small(big: float, small: float, pairs: int) -> Case:
    """Pairs in one place of a demand above half a vehicle and one that fills it: cuts by halves part them."""
    angle = 2 * np.pi * np.repeat(np.arange(pairs), 2) / pairs
    xy = np.vstack([[0.0, 0.0], 10 * np.column_stack([np.cos(angle), np.sin(angle)])])
    sites = _sites(2 * pairs + 1, demand=np.r_[0.0, np.tile([big, small], pairs)])
    return Case(
        RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(capacity=big + small),), name=f"pairs-{big:g}-{small:g}-{pairs}")
    )


def load_traps() -> tuple[Family, ...]:
    """Instances on which full vehicles are not the best ones."""
    stars = [(4, 2.0), (6, 3.0), (8, 2.0), (8, 7.0)]
    piles = [((2, 2, 2), 2.0), ((3, 3), 3.0), ((3, 3, 2), 2.0), ((4, 4), 3.0), ((1, 2, 3), 4.0)]
    pairs = [(6.0, 4.0, 4), (9.0, 1.0, 4), (5.0, 5.0, 3), (51.0, 49.0, 4)]
    return (
        listed("star", "nothing is gained by going on", [partial(star, n, q, 1.0) for n, q in stars]),
        listed("heaps", "as many customers in a place as fill vehicles, or one more", [partial(heaps, s, q) for s, q in piles]),
        listed("big-and-small", "what shares a vehicle is cut apart", [partial(big_and_small, b, s, p) for b, s, p in pairs]),
    )


def two_sides(near: int, far: float, vehicles: int) -> Case:
    """Near customers on one side of the depot, a far one on the other: whoever goes there is the longest."""
    xy = np.vstack([[0.0, 0.0], [[-far, 0.0]], np.column_stack([np.arange(1.0, near + 1), np.zeros(near)])])
    fleet = (VehicleType(count=vehicles),)
    name = f"sides-{near}-{far:g}-{vehicles}"
    return Case(RoutingProblem(_sites(near + 2), Travel("euclidean", xy), fleet, Objective.of(LongestRoute()), name=name))


def share_traps() -> tuple[Family, ...]:
    """Instances on which the longest route cannot be cut evenly."""
    sides = [(3, 1.0, 2), (6, 6.0, 2), (6, 3.0, 3), (7, 7.0, 4)]
    return (listed("two-sides", "a line with the depot within", [partial(two_sides, a, f, k) for a, f, k in sides]),)


def astray(near: int, lone: float, much: float) -> Case:
    """A cluster as far away as a vehicle gets, ``near`` sites of reward 1 each, and a lone site of reward ``much`` on the other side.

    Whoever goes to the one cannot go to the other.
    """
    xy = np.vstack([[0.0, 0.0], [[-lone, 0.0]], np.column_stack([np.full(near, 5.0), np.zeros(near)])])
    sites = _sites(near + 2, reward=np.r_[0.0, much, np.ones(near)], required=False)
    fleet = (VehicleType(count=1, max_distance=10.0),)
    return Case(RoutingProblem(sites, Travel("euclidean", xy), fleet, Objective.of(Reward()), name=f"astray-{near}-{lone:g}-{much:g}"))


def reward_traps() -> tuple[Family, ...]:
    """Instances on which the largest reward, or the largest for its distance, shuts out all others."""
    cases = [(4, 4.0, 1.5), (8, 4.0, 1.5), (8, 0.5, 1.0), (8, 0.05, 0.5)]
    return (listed("astray", "one site looks better than each of a cluster", [partial(astray, n, d, r) for n, d, r in cases]),)


def long_ways(n: int) -> Case:
    """Sites on a line, each twice as far from the depot as the one before, and on its other side: the nearest is always behind."""
    x = np.r_[0.0, (-2.0) ** np.arange(n)]
    problem = RoutingProblem(
        _sites(n + 1), Travel("euclidean", np.column_stack([x, np.zeros(n + 1)])), (VehicleType(count=1),), LongestRoute()
    )
    return Case(problem)


def nearest_traps() -> tuple[Family, ...]:
    """Instances on which the nearest site is the wrong one."""
    return (
        listed("long-ways", "a line on which the nearest site is always on the other side", [partial(long_ways, n) for n in range(3, 10)]),
    )
