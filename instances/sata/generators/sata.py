"""Random sensing graphs of a given density, after the recipe of the SATA experiments.

1. Every robot has the same number of actions.
2. Every action sees a random target.
3. Every target is seen by a random action.
4. Random edges are added until the graph of robots, actions and targets is connected.
5. Random edges are added until the density phi is reached: of all pairs of an action and a target, phi percent are edges.

An edge that is drawn again is drawn in vain, so that every action and every target has at least one edge. The number of edges is
exactly ``round(phi / 100 * actions * targets)``; a phi below what steps 2 to 4 make is refused.

Source: Sung (2019), Multi-Robot Coordination for Hazardous Environmental Monitoring, section 3.5.1 and (3.6); read as in
docs/formulations/sensing.md#random-graphs.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...errors import UsageError
from ...generators import GENERATORS, Draw, Generator, Integers, Setting
from ..sensing_graph import SensingGraph, graph_of_edges

MOST_EDGES = 50_000_000

SETTINGS = {
    "robots": Setting(40, "number of robots", least=1, most=1_000_000),
    "actions": Setting(2, "number of actions of each robot", least=1, most=10_000),
    "targets": Setting(50, "number of targets", least=1, most=1_000_000),
    "phi": Setting(15.0, "density: edges in percent of all pairs of action and target", least=0.0, most=100.0),
    "weights": Setting("binary", "weights of the edges: all 1, or uniform in [0.5, 1.5]", choices=("binary", "uniform")),
    "name": Setting(None, "name of the instance", type=str),
}


def make(draw: Draw, settings: Mapping[str, Any]) -> SensingGraph:
    """One instance."""
    robots, targets, phi = settings["robots"], settings["targets"], settings["phi"]
    if robots * settings["actions"] > MOST_EDGES:
        raise UsageError(
            f"robots={robots} with actions={settings['actions']} are too many actions; at most {MOST_EDGES} are made", "too-large"
        )
    owner = np.repeat(np.arange(robots), settings["actions"])
    pairs = len(owner) * targets
    wanted = round(phi / 100.0 * pairs)
    if wanted > MOST_EDGES:
        raise UsageError(f"phi={phi:g} asks for {wanted} edges; at most {MOST_EDGES} are made", "too-large")
    least = max(len(owner), robots + targets - 1)
    if wanted < least:
        raise UsageError(
            f"phi={phi:g} asks for {wanted} edges, but {least} are needed for an edge at every action and target of a connected graph: "
            f"ask for phi of at least {_percent(least, pairs)}"
        )
    actions = np.arange(len(owner))
    seeing = actions * targets + draw.integers(0, targets - 1, len(owner))
    seen = draw.integers(0, len(owner) - 1, targets) * targets + np.arange(targets)
    first = np.unique(np.concatenate([seeing, seen]))
    keys = np.concatenate([first, _others(draw, first, max(wanted - len(first), 0), pairs)])
    enough = _connecting(keys, len(first), owner, robots, targets)
    if enough is None or enough > wanted:
        count = f"{enough} edges" if enough is not None else f"more than {len(keys)} edges"
        hint = f"ask for phi of at least {_percent(enough or len(keys) + 1, pairs)}, or try another seed"
        raise UsageError(f"phi={phi:g} asks for {wanted} edges, but with this seed it takes {count} to reach all and connect them: {hint}")
    weight = np.ones(wanted) if settings["weights"] == "binary" else draw.uniform(0.5, 1.5, wanted)
    keys = np.sort(keys)
    name = settings["name"] or f"sata-r{robots}-t{targets}-phi{phi:g}-s{settings['seed']}"
    return graph_of_edges(owner, keys // targets, keys % targets, weight, robots=robots, targets=targets, name=name, format="generated")


def _percent(edges: int, pairs: int) -> str:
    """Smallest density, to three decimals, that means at least so many edges."""
    thousandth = -(-edges * 100_000 // pairs)
    return f"{thousandth / 1000:g}"


def _others(draw: Draw, taken: Integers, count: int, pairs: int) -> Integers:
    """``count`` random pairs that are not ``taken``, all different, in the order in which they were drawn."""
    if count == 0:
        return np.zeros(0, dtype=np.int64)
    if 2 * (len(taken) + count) > pairs:
        free = np.delete(np.arange(pairs), taken)
        return free[draw.permutation(len(free))[:count]]
    drawn = taken
    while len(drawn) < len(taken) + count:
        missing = len(taken) + count - len(drawn)
        more = np.concatenate([drawn, draw.integers(0, pairs - 1, 2 * missing + 16)])
        _, at = np.unique(more, return_index=True)
        drawn = more[np.sort(at)]
    return drawn[len(taken) : len(taken) + count]


def _connecting(keys: Integers, first: int, owner: Integers, robots: int, targets: int) -> int | None:
    """Least number of ``keys``, at least ``first``, whose edges connect all; None if all of them do not."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    def connected(count: int) -> bool:
        # Robots stand for their actions, whose edges to them are always there.
        ends = owner[keys[:count] // targets], robots + keys[:count] % targets
        size = robots + targets
        parts = connected_components(coo_matrix((np.ones(count, dtype=np.int8), ends), shape=(size, size)), directed=False)[0]
        return int(parts) == 1

    if not connected(len(keys)):
        return None
    low, high = first, len(keys)
    while low < high:
        middle = (low + high) // 2
        if connected(middle):
            high = middle
        else:
            low = middle + 1
    return low


GENERATORS.enter(Generator("sata", "random sensing graphs of a given density (SATA experiments)", SETTINGS, make))
