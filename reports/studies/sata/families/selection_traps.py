"""Selection problems on which greedy rules do as badly as is known, with their optima by construction."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from .....formulations.sata.selections import Selection
from .....formulations.sata.submodular_selection import SubmodularSelection
from .....formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from .....instances.sata.constraints import Cardinality, Constraint, Knapsack, PartitionMatroid
from .....instances.sata.sensing_graph import graph_of_edges
from .....instances.sata.set_functions import Coverage
from ....ratios.families import Family, listed
from ....ratios.judged_runs import Case
from ....ratios.optimum import attained

BRIBE = 1e-4
"""Weight that breaks ties in favour of the worse choice, as a share of the optimum."""


def geometric_cover(k: int, bribe: float = BRIBE) -> tuple[Coverage, Selection, float]:
    """k good sets and k bad ones, of which greedy takes all the bad ones: the function, the good sets, and the value of the bad ones.

    Items stand in a grid of k columns and k + 1 rows; those of row j <= k weigh (1 - 1/k)^(j - 1) / k^2 each, those of the last row (1 -
    1/k)^k / k each. A good set covers a column (weight 1/k), bad set j row j, which weighs what the best column has left when the rows
    above are covered; ``bribe`` is a further item of each bad set. All good sets: 1. Greedy: 1 - (1 - 1/k)^k + k bribe.

    Source: Nemhauser, Wolsey and Fisher (1978), An analysis of approximations for maximizing submodular set functions I, the tight case of
    theorem 4.2; COVER-TIGHT of docs/selection.md#reference-cases is its member of k = 2.
    """
    shrink = 1.0 - 1.0 / k
    row = np.append(shrink ** np.arange(k) / k**2, shrink**k / k)
    weights = np.concatenate([np.repeat(row, k), np.full(k, bribe)])
    grid = np.arange(k * (k + 1)).reshape(k + 1, k)
    good = [grid[:, column] for column in range(k)]
    bad = [np.append(grid[j], k * (k + 1) + j) for j in range(k)]
    f = Coverage.from_sets([*bad, *good], weights)
    return f, Selection(tuple(range(k, 2 * k))), 1.0 - shrink**k + k * bribe


def _cover(k: int, constraint: Constraint, name: str, bribe: float = BRIBE) -> Case:
    f, good, _ = geometric_cover(k, bribe)
    problem = SubmodularSelection(f, constraint, name=name)
    return Case(problem, attained(problem, good, "construction"))


def geometric_covers(constraint: str) -> Family:
    """``geometric_cover`` for k = 2 to 30, with the constraint in one of its three guises."""

    def rule(k: int) -> Constraint:
        if constraint == "cardinality":
            return Cardinality(k)
        return PartitionMatroid.of(np.zeros(2 * k), k) if constraint == "partition" else Knapsack(np.ones(2 * k), float(k))

    sizes = (2, 3, 4, 5, 6, 8, 10, 15, 20, 30)
    cases = [partial(_cover, k, rule(k), f"geometric-cover-{k}") for k in sizes]
    cases += [partial(_cover, k, rule(k), f"geometric-cover-{k}-ties", 0.0) for k in (1, *sizes[:5])]
    return listed("geometric-cover", "greedy falls to 1 - (1 - 1/k)^k, k up to 30, with and without ties", cases)


def _needles(k: int, others: int) -> Case:
    """k elements of the same worth among others that are worth nothing."""
    rng = np.random.default_rng([k, others])
    order = rng.permutation(k + others)
    f = Coverage.from_sets([[int(e)] if e < k else [] for e in order], np.ones(k))
    problem = SubmodularSelection(f, Cardinality(k), name=f"needles-{k}-{others}")
    return Case(problem, attained(problem, Selection.of(np.nonzero(order < k)[0].tolist()), "construction"))


NEEDLES = replace(
    listed(
        "needles",
        "k elements of worth among many without: samples of (n / k) ln(1/eps) find ln(2 - eps) / ln(1/eps) too few, k to infinity",
        [partial(_needles, k, k * times) for k in (10, 20) for times in (10, 20)],
    ),
    effort=15,
)
"""Elements in no sample are lost: with eps = 0.1 the published size finds 72 % for large k, a quarter of it 37 %, where 53 % are stated."""


# -- a partition matroid ----------------------------------------------------------------------------------------------


def robots(rows: Sequence[Sequence[Sequence[float]]], name: str) -> WinnerTakesAllSATA:
    """Winner takes all from the weights of robots x actions x targets."""
    flat = np.array([action for robot in rows for action in robot], dtype=np.float64)
    action, target = np.nonzero(flat)
    owner = [i for i, robot in enumerate(rows) for _ in robot]
    graph = graph_of_edges(owner, action, target, flat[action, target], robots=len(rows), targets=flat.shape[1], name=name)
    return WinnerTakesAllSATA(graph)


def copies(problem: WinnerTakesAllSATA, count: int) -> WinnerTakesAllSATA:
    """``count`` copies side by side, each with robots and targets of its own."""
    g = problem.graph
    k = np.arange(count)[:, None]
    owner = (g.robot_of_action + k * g.num_robots).ravel()
    action = (g.action_of_edge + k * g.num_actions).ravel()
    target = (g.indices + k * g.num_targets).ravel()
    graph = graph_of_edges(
        owner, action, target, np.tile(g.weights, count), robots=count * g.num_robots, targets=count * g.num_targets,
        name=f"{g.name}-x{count}",
    )  # fmt: skip
    return WinnerTakesAllSATA(graph)


def _half(e: float, count: int, reverse: bool) -> Case:
    """Two robots, of which the one with a choice takes what the other could have had: (1 + e) / (2 + e); case S2."""
    choice, fixed = [[1.0 + e + e * e, 0.0], [0.0, 1.0]], [[1.0 + e, 0.0]]
    one = robots([fixed, choice] if reverse else [choice, fixed], f"half-{e:g}")
    problem = copies(one, count)
    best = (0, 2) if reverse else (1, 2)
    answer = Selection(tuple(3 * c + a for c in range(count) for a in best))
    return Case(problem, attained(problem, answer, "construction"))


def _small(rows: Sequence[Sequence[Sequence[float]]], name: str) -> Case:
    return Case(robots(rows, name))


def _shared(count: int, share: float, reverse: bool) -> Case:
    """Robots of two actions: the target that all of them see, worth 1, or one of their own, worth ``share``."""
    rows = []
    for robot in range(count):
        actions = [[1.0] + [0.0] * count, [share * (target == robot + 1) for target in range(count + 1)]]
        rows.append(actions[::-1] if reverse else actions)
    problem = robots(rows, f"shared-target-{count}-{share:g}{'-reversed' * reverse}")
    answer = Selection(tuple(2 * robot + ((robot > 0) != reverse) for robot in range(count)))
    return Case(problem, attained(problem, answer, "construction"))


HALVES = listed(
    "half",
    "two robots of which the first takes what the second needs: (1 + e) / (2 + e)",
    [
        *(partial(_half, e, count, reverse) for e in (1.0, 0.3, 0.1, 0.01, 0.001) for count in (1, 3) for reverse in (False, True)),
        partial(_small, [[[11, 0], [0, 10]], [[11, 0]]], "S2"),
        partial(_small, [[[1, 0], [0, 1]], [[1, 0]]], "S2b"),
        partial(_small, [[[1, 0]], [[1, 0], [0, 1]]], "S2b-reversed"),
    ],
)
"""Greedy takes half of the optimum, with and without ties, in either order of the robots."""

_S10 = [[[4, 2, 0], [0, 0, 5]], [[4, 0, 0], [0, 3, 0]], [[3, 0, 1], [0, 5, 0]]]

ORDER_MATTERS = listed(
    "order-matters",
    "three robots whose order decides between 9 and 14 (S10)",
    [
        partial(_small, [_S10[i] for i in order], f"S10-{''.join(str(i + 1) for i in order)}")
        for order in ((0, 1, 2), (2, 1, 0), (1, 0, 2), (0, 2, 1), (1, 2, 0), (2, 0, 1))
    ],
)
"""Case S10 of docs/formulations/sensing.md#reference-cases, with its robots in every order."""


SHARED_TARGETS = listed(
    "shared-target",
    "robots that all like one target a little better than one of their own each",
    [
        *(partial(_shared, count, share, False) for count in (2, 3, 5, 8, 12) for share in (0.99, 0.5)),
        *(partial(_shared, count, 0.99, True) for count in (2, 3, 5, 8, 12)),
    ],
)
"""Robots that do not know what others took all go to the shared target: 1, where the optimum of n robots is 1 + (n - 1) share."""


# -- a knapsack -------------------------------------------------------------------------------------------------------


def _disjoint(values: Sequence[float], costs: Sequence[float], budget: float, best: Sequence[int], name: str) -> Case:
    """Elements that cover one item each: a plain knapsack problem."""
    f = Coverage.from_sets([[i] for i in range(len(values))], np.array(values, dtype=np.float64))
    problem = SubmodularSelection(f, Knapsack(np.array(costs, dtype=np.float64), budget), name=name)
    return Case(problem, attained(problem, Selection.of(best), "construction"))


DENSITY_TRAPS = listed(
    "density-trap",
    "a small dense element shuts out one of M times its value",
    [
        partial(_disjoint, [2.0] + [0.0] * extra + [m], [1.0] + [1.0] * extra + [m], m, [1 + extra], f"density-trap-{m:g}")
        for m in (3.0, 10.0, 100.0, 1e4)
        for extra in (0, 3)
    ],
)
"""The best value a unit of cost alone is arbitrarily bad: 2 against M. The best element alone mends it."""


def _fringe(m: int) -> Case:
    """Many elements of cost 1/m would fill the budget; a dense one of just more shuts one of them out."""
    values, costs = [1.0 / m + 3e-3] + [1.0 / m] * m, [1.0 / m + 1e-3] + [1.0 / m] * m
    return _disjoint(values, costs, 1.0 + 1e-9, range(1, m + 1), f"fringe-{m}")


HALF_TRAPS = listed(
    "half-trap",
    "a dense element of half the budget shuts out two that fill it",
    [
        *(partial(_disjoint, [1.0 + 3.0 * e, 1.0, 1.0], [0.5 + e, 0.5, 0.5], 1.0, [1, 2], f"half-trap-{e:g}") for e in (0.1, 0.01, 0.001)),
        *(partial(_fringe, m) for m in (4, 6, 10)),
    ],
)
"""Neither greedy nor the best element passes 1/2."""


def _shut_out(k: int, m: int) -> Case:
    """k good sets that share the budget, and m small ones that spread over all of them and leave a little too little room.

    A small set costs c = (1 - 1/k + 1e-6) / m and covers a share of c, and a little more, of what the small ones before it left of every
    good set: greedy takes all of them, 1 - (1 - c)^m, and then no good set fits.
    """
    c = (1.0 - 1.0 / k + 1e-6) / m
    row = np.append(c * (1.0 - c) ** np.arange(m) / k, (1.0 - c) ** m / k)
    weights = np.concatenate([np.repeat(row, k), np.full(m, BRIBE / m)])
    grid = np.arange(k * (m + 1)).reshape(m + 1, k)
    sets = [np.append(grid[j], k * (m + 1) + j) for j in range(m)] + [grid[:, column] for column in range(k)]
    costs = np.append(np.full(m, c), np.full(k, 1.0 / k))
    problem = SubmodularSelection(Coverage.from_sets(sets, weights), Knapsack(costs, 1.0 + 1e-9), name=f"shut-out-{k}-{m}")
    return Case(problem, attained(problem, Selection(tuple(range(m, m + k))), "construction"))


SHUT_OUTS = listed(
    "shut-out",
    "small sets use the budget up until no good one fits: 0.487 for three good ones",
    [partial(_shut_out, k, m) for k in (2, 3, 4, 5) for m in (5, 15, 40)],
)
"""Neither greedy nor the best element passes max(1 - exp(-(1 - 1/k)), 1/k): 0.487 for k = 3."""

FREE_ELEMENTS = listed(
    "free-elements",
    "costs of 0 and costs above the budget",
    [
        partial(_disjoint, [1.0, 5.0, 3.0], [0.0, 9.0, 2.0], 2.0, [0, 2], "free"),
        partial(_disjoint, [1.0, 5.0, 3.0], [0.0, 9.0, 2.0], 0.0, [0], "no-budget"),
        partial(_disjoint, [4.0, 5.0], [3.0, 9.0], 2.0, [], "nothing-fits"),
        partial(_disjoint, [0.0, 0.0], [1.0, 1.0], 2.0, [0], "worthless"),
    ],
)
