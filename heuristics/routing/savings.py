"""Savings: Clarke and Wright's parallel merging of routes, with loads, time windows and route limits."""

from collections.abc import Iterator

import numpy as np

from ...formulations.routing.problem import RoutingProblem
from ...formulations.routing.routes import Route, Routes
from ...formulations.stop import Stop
from ...instances.errors import UsageError
from ...instances.memory import fits, readable
from ...instances.routing.travel import Travel
from ..heuristic import CUT_SHORT, Context, Outcome, heuristic
from .tour_steps.distance_matrices import Floats, Sites

FEATURES = frozenset(
    {
        "objective:total-cost", "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance",
        "limited-fleet", "fixed-cost", "separate-durations",
    }
)  # fmt: skip

ALL_PAIRS = 2_000
"""Sites up to which all joins are looked at: a second's work. With more, joins between near sites are."""

NEIGHBOURS = 100
"""Nearest sites that a join is tried with, as in Arnold, Gendreau and Sörensen (2019), Efficiently solving very large-scale routing
problems."""

SLOW_TO_BEGIN = 1_500
"""Sites beyond which engines take seconds, and then minutes, to their first answer."""

BYTES_A_JOIN = 60
"""Memory of a join while all of them are sorted."""

STILL = 0.01
"""Share of the routes that a round must have joined for another one."""

STRIP = 1 << 22
"""Distances that are looked at between two looks at the time."""


@heuristic(
    "savings",
    "routing", FEATURES | {"objective:vehicles", "objective:priorities", "objective:weights"},
    "Clarke and Wright's parallel savings, with windows and route limits",
    opens=lambda problem: problem.family == "routing" and problem.size > SLOW_TO_BEGIN,
)  # fmt: skip
def savings(problem: RoutingProblem, context: Context, *, shape: float = 1.0) -> Outcome:
    """Start with one route per customer, and join route ends in order of the cost they save.

    Takes one depot and one vehicle type, every site required. May use more vehicles than the fleet has, since joins are never taken back.
    Cut short, it has joined fewer routes.

    Source: Clarke and Wright (1964), Operations Research 12, 568-581; docs/formulations/routing.md#savings. Without windows and with
    symmetric data routes are joined at either end (reversed where needed), else last to first only. While there are more routes than
    vehicles, joins that save nothing are taken too, the least loss first. O(n^2 log n) up to ``ALL_PAIRS`` sites; with more, joins are
    tried between the ``NEIGHBOURS`` nearest sites, then between the nearest ends of the routes that are left, until little changes.

    Parameters
    ----------
    shape : float, > 0
        Weight of the joining arc: savings are ``c_i0 + c_0j - shape * c_ij`` (Yellow 1970). 1 is the original.
    """
    if not (isinstance(shape, int | float) and 0 < shape <= 1e6):
        raise UsageError(f"shape must be a positive number of at most 1e6, not {shape!r}", "out-of-range")
    from .savings_steps.merging_kernels import merge

    stop, vehicle, sites, travel = context.begin(), problem.fleet[0], problem.sites, problem.travel
    n, depot, every, limit = len(sites), vehicle.start, np.arange(len(sites)), problem.vehicle_limit
    if n > ALL_PAIRS and not fits(BYTES_A_JOIN * NEIGHBOURS * n):
        raise UsageError(f"savings for {n:,} sites needs {readable(BYTES_A_JOIN * NEIGHBOURS * n)}, more than there is", "too-large")
    out = np.stack([travel.distance(depot, every), travel.duration(depot, every)])
    back = np.stack([travel.distance(every, depot), travel.duration(every, depot)])
    both_ways = _symmetric(travel.matrix) and _symmetric(travel.duration_matrix) and not problem.features() & {"time-windows"}
    window = float(sites.ready[depot]), float(sites.due[depot])
    bounds = (*window, vehicle.max_duration, vehicle.max_distance)
    bounded = bool(problem.features() & {"time-windows", "depot-windows", "max-duration", "max-distance"})
    state = (
        np.arange(n), np.full(n, -1), np.full(n, -1), np.arange(n), np.arange(n), np.array(sites.demand, dtype=np.float64),
        np.ones(n, dtype=np.int64), np.zeros(n), np.zeros(n),
    )  # fmt: skip
    _, following, _, first, last, _, size, _, _ = state
    size[sites.depot] = 0
    ends, routes, saving, losing_too = problem.customers, len(problem.customers), 0, False
    while True:
        near = len(ends) > ALL_PAIRS
        i, j = _neighbours(travel, ends, both_ways, stop) if near else _all_pairs(ends, both_ways)
        length = travel.distance(i, j)
        gain = vehicle.unit_cost * back[0, i] + vehicle.unit_cost * out[0, j] - float(shape) * (vehicle.unit_cost * length)
        gain += vehicle.fixed_cost
        # Joins that cost more than they save come last, and only where the fleet is too small without them.
        kept = np.nonzero(gain > (0 if limit is None or (near and not losing_too) else -np.inf))[0]
        # Stable sort on the negated gain: ties go to the lower site numbers, so the result does not depend on the platform.
        order = kept[np.argsort(-gain[kept], kind="stable")]
        losing = int((gain[order] > 0).sum())
        before, saving = routes, saving + losing
        i, j, length = i[order], j[order], length[order]
        time = length if not travel.own_durations else travel.duration(i, j)
        routes = merge(
            stop.flag, i, j, length, time, losing, routes, n if limit is None else limit, state, bounded, bounds, out, back,
            np.asarray(sites.service), np.asarray(sites.ready), np.asarray(sites.due), vehicle.capacity, both_ways,
        )  # fmt: skip
        too_many = limit is not None and routes > limit
        if not near or stop.reached() or (before - routes < STILL * before and not (too_many and (before > routes or not losing_too))):
            break
        losing_too = losing_too or before == routes
        ends = np.unique(np.concatenate([first[size > 0], last[size > 0]]))
    answer = Routes(tuple(Route(tuple(_visits(int(first[head]), following))) for head in np.nonzero(size > 0)[0])).canonical()
    messages = []
    if len(problem.customers) > ALL_PAIRS:
        messages.append(f"joins were tried between the {NEIGHBOURS} nearest sites")
    cut = bool(stop.reached())
    if cut:
        messages.append(f"{len(answer):,} routes were left: {CUT_SHORT}")
        if limit == 1 and not bounded and sites.demand.sum() <= vehicle.capacity:  # a lone vehicle drives them one after the other
            answer = Routes((Route(tuple(site for route in answer for site in route.visits)),))
    elif limit is not None and len(answer) > limit:
        messages.append(f"savings found no way to join its {len(answer)} routes for a fleet of {limit}")
    statistics = {"routes": len(answer), "savings": saving}
    return Outcome(answer, statistics=statistics, message="; ".join(messages), limit=stop.reached() if cut else "none")


def _visits(node: int, following: Sites) -> Iterator[int]:
    while node >= 0:
        yield node
        node = int(following[node])


def _symmetric(matrix: Floats | None) -> bool:
    """Whether a matrix is symmetric, as all distances of coordinates (None) are."""
    return matrix is None or bool((matrix == matrix.T).all())


def _all_pairs(ends: Sites, both_ways: bool) -> tuple[Sites, Sites]:
    """All pairs of ends, in one or both directions."""
    ends = np.sort(ends)
    a, b = np.triu_indices(len(ends), 1) if both_ways else np.nonzero(~np.eye(len(ends), dtype=bool))
    return ends[a], ends[b]


def _neighbours(travel: Travel, ends: Sites, both_ways: bool, stop: Stop) -> tuple[Sites, Sites]:
    """Pairs of each end with its nearest ones, in ascending order; as far as the time goes."""
    parts, n = [np.zeros(0, np.int64)], len(ends)
    tree = None
    if travel.coordinates is not None and travel.matrix is None:
        from scipy.spatial import cKDTree

        points = travel.coordinates[ends]
        tree, step = cKDTree(points), max(1, STRIP // (20 * NEIGHBOURS))
    else:
        step = max(1, STRIP // n)
    for at in range(0, n, step):
        if stop.reached():
            break
        if tree is not None:
            others = tree.query(points[at : at + step], NEIGHBOURS + 1)[1]
        else:
            lengths = travel.distance(ends[at : at + step, None], ends[None, :])
            others = np.argpartition(lengths, NEIGHBOURS, axis=1)[:, : NEIGHBOURS + 1]
        mine = np.repeat(np.arange(at, at + len(others)), others.shape[1])
        theirs = others.ravel()
        if both_ways:
            mine, theirs = np.minimum(mine, theirs), np.maximum(mine, theirs)
        parts.append((mine * n + theirs)[mine != theirs])
        if not both_ways:
            parts.append((theirs * n + mine)[mine != theirs])
    pairs = np.concatenate(parts)
    pairs.sort()  # np.unique is twenty times slower
    a, b = np.divmod(pairs[np.diff(pairs, prepend=-1) > 0], n)
    return ends[a], ends[b]
