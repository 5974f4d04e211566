"""The local algorithm for all robots at once, over arrays: O(h) work an edge and level."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from .....formulations.stop import NEVER, Stop
from .....instances.errors import UsageError
from .....instances.sata.sensing_graph import SensingGraph
from .cleaning import CleanGraph, Floats, clean
from .search import MARGIN, SecantSearch, step_search, sums_at_caps, tree_minima

SEARCHES = ("secant", "step")
SMOOTHINGS = ("layers", "ball")
MOST_LAYERS = 1000
LEAST_EPS, MOST_EPS = 1e-6, 1.0


@dataclass(frozen=True, eq=False)
class LocalShares:
    """Result of the local algorithm, in arrays of shape (actions of the sensing graph,).

    Actions that see nothing have the share 0 and the level NaN; ``levels`` are those of the trees, before the margin. The largest valid
    level of any tree is at most (1 + relative_eps) times the one that was used, margin included.
    """

    shares: Floats
    levels: Floats
    relative_eps: float
    clean: CleanGraph


def check_options(h: Any, eps: Any, search: Any, step: Any, smoothing: Any) -> None:
    """Raise UsageError for the first option that is out of range."""
    if isinstance(h, bool) or not isinstance(h, int | np.integer) or not 1 <= h <= MOST_LAYERS:
        raise UsageError(f"h must be a whole number from 1 to {MOST_LAYERS}, not {h!r}", "out-of-range")
    for name, value, least, most in (("eps", eps, LEAST_EPS, MOST_EPS), ("step", step, 0.0, math.inf)):
        if (
            isinstance(value, bool)
            or not isinstance(value, int | float | np.integer | np.floating)
            or not least <= value <= most
            or value in (0, math.inf)
        ):
            wanted = f"from {least:g} to {most:g}" if math.isfinite(most) else "above 0"
            raise UsageError(f"{name} must be a number {wanted}, not {value!r}", "out-of-range")
    for name, value, known in (("search", search, SEARCHES), ("smoothing", smoothing, SMOOTHINGS)):
        if value not in known:
            raise UsageError(f"{name} must be {' or '.join(known)}, not {value!r}", "unknown-name")


def local_shares(
    graph: SensingGraph | CleanGraph,
    h: int,
    *,
    eps: float = 0.1,
    search: str = "secant",
    step: float = 0.1,
    smoothing: str = "layers",
    normalise: bool = True,
    stop: Stop = NEVER,
) -> LocalShares:
    """Shares of the robots among their actions that make the worst-covered target's coverage large, each from its surroundings alone.

    The options are those of docs/local_algorithm.md#options; a robot's shares depend on what lies within 3h - 2 hops. Targets that nobody
    sees are not looked at. For the worst-covered target that somebody sees, ``OPT / value <= Delta_R (1 + eps) (1 + 1/h) (1 - 1/Delta_T)``.
    Raises UsageError for an option out of range, Stopped where it has to end before.

    Source: Floréen, Hassinen, Kaasinen, Kaski, Musto and Suomela (2011), Local approximability of max-min and min-max linear programs; Sung
    (2019), section 3.4.1, Algorithm 2; proved in docs/formulations/bottleneck.md#the-local-algorithm.
    """
    check_options(h, eps, search, step, smoothing)
    cleaned = graph if isinstance(graph, CleanGraph) else clean(graph)
    if not cleaned.num_actions:
        nothing = np.zeros(0)
        return LocalShares(cleaned.spread(nothing), cleaned.spread(nothing, np.nan), float(eps), cleaned)
    if search == "secant":
        levels, relative = SecantSearch(cleaned, h, eps, stop).run(), float(eps)
    else:
        levels, relative = step_search(cleaned, h, step, stop)
    shares = shares_at_levels(cleaned, levels * (1.0 - MARGIN), h, smoothing=smoothing, normalise=normalise, stop=stop)
    relative = (1.0 + relative) / (1.0 - MARGIN) - 1.0
    return LocalShares(cleaned.spread(shares), cleaned.spread(levels, np.nan), relative, cleaned)


def shares_at_levels(
    cleaned: CleanGraph, levels: Floats, h: int, *, smoothing: str = "layers", normalise: bool = True, stop: Stop = NEVER
) -> Floats:
    """All of the algorithm that follows the search: smoothing, the layered solution, and its average over copies.

    ``levels`` are valid levels of the actions' trees, used as they are.
    """
    from .layer_kernels import ball_minima, solve_layer

    graph, targets, most = cleaned.layout, cleaned.num_targets, cleaned.delta_r
    if smoothing == "layers":
        layers = tree_minima(cleaned, levels, np.empty(0), h, h, stop)
    else:
        layers = np.empty((1, cleaned.num_actions))
        ball_minima(stop.flag, graph, levels, np.empty(targets), np.empty(cleaned.num_robots), h - 1, layers[0])
    robot = np.repeat(np.arange(cleaned.num_robots), np.diff(graph.first))
    reds, blues, back = graph.caps[robot], np.empty(most), np.empty(most)
    total, sums, next_sums = reds.copy(), sums_at_caps(cleaned), np.empty(targets)
    for layer in range(h - 1, -1, -1):
        stop.check()
        solve_layer(graph, layers[min(layer, len(layers) - 1)], reds, sums, next_sums, blues, back, total, layer == 0)
        sums, next_sums = next_sums, sums
    stop.check()
    total /= 2.0 * (h + 1)
    load = np.bincount(robot, total, cleaned.num_robots)
    return np.asarray(total / np.where((load > 1.0) | (normalise & (load > 0.0)), load, 1.0)[robot])
