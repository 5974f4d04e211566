import numpy as np
import pytest
from truth.local_algorithm import hops

from waybound.instances.sata.sensing_graph import SensingGraph, graph_of_edges
from waybound.solvers.engines.sata.local_max_min.messages import exchange
from waybound.solvers.engines.sata.local_max_min.shares import local_shares

SEARCHES = ["secant", "step"]


def long_graph(rng: np.random.Generator, robots: int) -> SensingGraph:
    """Robots in a row, each of which sees targets close to its own place: many hops from end to end."""
    owner = np.repeat(np.arange(robots), rng.integers(1, 4, robots))
    pairs = sorted({(v, int(rng.integers(max(0, owner[v] - 1), owner[v] + 2))) for v in range(len(owner)) for _ in range(2)})
    action, target = np.array(pairs).T
    weight = np.exp(rng.normal(0, 0.5, len(action))) if rng.random() < 0.7 else np.ones(len(action))
    return graph_of_edges(owner, action, target, weight, robots=robots, targets=robots + 1)


def changed_beyond(graph: SensingGraph, near: np.ndarray, rng: np.random.Generator | None) -> tuple[SensingGraph, np.ndarray]:
    """The graph with all robots outside of ``near`` cut off or, with ``rng``, replaced by others; and the new numbers of actions (or -1).

    New robots may see any target that no robot of ``near`` sees, and those that old robots beyond saw as well.
    """
    inside = near[graph.robot_of_action]
    kept = inside[graph.action_of_edge]
    number = np.where(inside, np.cumsum(inside) - 1, -1)
    owner = graph.robot_of_action[inside].tolist()
    action, target, weight = number[graph.action_of_edge[kept]].tolist(), graph.indices[kept].tolist(), graph.weights[kept].tolist()
    robots, targets = graph.num_robots, graph.num_targets
    if rng is not None:
        beyond = np.setdiff1d(graph.indices[~kept], graph.indices[kept]).tolist()
        shared = np.intersect1d(graph.indices[~kept], graph.indices[kept]).tolist()
        for _ in range(int(rng.integers(1, 12))):
            for _ in range(int(rng.integers(1, 4))):
                choice = rng.choice([*beyond, *shared, targets, targets + 1], size=2, replace=False)
                action += [len(owner)] * 2
                target += choice.tolist()
                weight += rng.uniform(0.1, 9.0, 2).tolist()
                owner.append(robots)
            robots += 1
        targets += 2
    return graph_of_edges(owner, action, target, weight, robots=robots, targets=targets), number


@pytest.mark.share(5)
@pytest.mark.parametrize("search", SEARCHES)
@pytest.mark.parametrize("h", [1, 2, 3, 4])
@pytest.mark.parametrize("replaced", [False, True])
def test_nothing_beyond_the_radius_changes_a_bit(h: int, search: str, replaced: bool) -> None:
    rng, tested = np.random.default_rng(10 * h + replaced), 0
    while tested < 25:
        graph = long_graph(rng, int(rng.integers(20, 60)))
        centre = int(rng.integers(graph.num_robots))
        distance = hops(graph, centre)
        near = distance <= 3 * h - 2
        if near.all() or not (graph.robot_of_action == centre).any():
            continue
        # Robots beyond may share targets with robots at the very radius, but not with nearer ones.
        other, number = changed_beyond(graph, near, rng if replaced else None)
        mine = np.nonzero(graph.robot_of_action == centre)[0]
        for smoothing in ("layers", "ball"):
            before = local_shares(graph, h, search=search, smoothing=smoothing).shares[mine]
            after = local_shares(other, h, search=search, smoothing=smoothing).shares[number[mine]]
            assert before.tobytes() == after.tobytes()
        tested += 1


@pytest.mark.parametrize("search", SEARCHES)
@pytest.mark.parametrize("h", [1, 2])
def test_messages_do_not_come_from_beyond_the_radius_either(h: int, search: str) -> None:
    rng = np.random.default_rng(h)
    for _ in range(6):
        graph = long_graph(rng, 24)
        distance = hops(graph, 3)
        other, number = changed_beyond(graph, distance <= 3 * h - 2, None)
        mine = np.nonzero(graph.robot_of_action == 3)[0]
        before, after = exchange(graph, h, search=search).shares[mine], exchange(other, h, search=search).shares[number[mine]]
        assert before.tobytes() == after.tobytes()


@pytest.mark.share(2)
@pytest.mark.parametrize("h", [1, 2])
def test_the_radius_is_sharp(h: int) -> None:
    rng, moved = np.random.default_rng(h), 0
    for _ in range(150):
        graph = long_graph(rng, 40)
        centre = int(rng.integers(graph.num_robots))
        other, number = changed_beyond(graph, hops(graph, centre) <= 3 * h - 3, None)
        mine = np.nonzero(graph.robot_of_action == centre)[0]
        before, after = local_shares(graph, h).shares[mine], local_shares(other, h).shares[number[mine]]
        moved += bool(np.abs(before - after).max() > 1e-6)
    assert moved > 0
