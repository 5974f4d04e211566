import ast
import inspect
import warnings

import numpy as np
import pytest
from coded import check_coded
from draws import draws
from file_cases import check_refused
from hypothesis import given, settings, strategies as st
from truth.local_algorithm import cycle, random_graph

from waybound.instances.errors import UsageError
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.solvers.engines.sata.local_max_min import robot as robot_module
from waybound.solvers.engines.sata.local_max_min.messages import BYTES_A_NUMBER, Network, exchange
from waybound.solvers.engines.sata.local_max_min.shares import local_shares


@settings(max_examples=draws(120))
@given(
    st.integers(0, 10**6), st.integers(1, 5), st.sampled_from(["secant", "step"]), st.sampled_from(["layers", "ball"]), st.booleans(),
    st.sampled_from([0.03, 0.1, 0.7]),
)  # fmt: skip
def test_robots_that_talk_find_what_the_arrays_find(seed: int, h: int, search: str, smoothing: str, normalise: bool, fine: float) -> None:
    graph = random_graph(np.random.default_rng(seed), most_robots=10)
    options = {"search": search, "smoothing": smoothing, "normalise": normalise, "eps": fine, "step": fine}
    arrays, talk = local_shares(graph, h, **options), exchange(graph, h, **options)  # type: ignore[arg-type]
    assert np.abs(arrays.shares - talk.shares).max() <= 1e-12
    assert talk.levels == pytest.approx(arrays.levels, rel=1e-12, nan_ok=True)
    assert talk.relative_eps >= arrays.relative_eps * (1 - 1e-12)
    assert talk.rounds == 5 * h - 4


def test_they_agree_on_a_generated_graph_of_some_size_where_robots_are_not_in_order() -> None:
    rng = np.random.default_rng(3)
    owner = rng.permutation(np.repeat(np.arange(60), 3))
    action = np.repeat(np.arange(180), 2)
    target = (owner[action] + rng.integers(0, 6, 360)) % 60
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        graph = graph_of_edges(owner, action, target, rng.uniform(0.5, 1.5, 360), robots=61, targets=62, duplicates="sum")
    for search in ("secant", "step"):
        assert np.abs(local_shares(graph, 4, search=search).shares - exchange(graph, 4, search=search).shares).max() <= 1e-12


@pytest.mark.parametrize("search", ["secant", "step"])
@pytest.mark.parametrize("h", [1, 2, 4])
def test_the_number_of_rounds_does_not_depend_on_the_number_of_robots_and_bytes_grow_with_it(h: int, search: str) -> None:
    runs = {size: exchange(cycle(size), h, search=search) for size in (10, 20, 80)}
    assert {run.rounds for run in runs.values()} == {5 * h - 4}
    # Beyond its diameter every robot of a cycle hears and says the same.
    assert runs[80].messages == 4 * runs[20].messages == 8 * runs[10].messages
    assert runs[80].bytes == 4 * runs[20].bytes
    assert runs[80].most_bytes == runs[20].most_bytes


def test_messages_are_counted_for_each_receiver_at_eight_bytes_a_number() -> None:
    # Three robots of one action see one target: height 1 takes the introduction only, a cap, an action and a weight to two others.
    run = exchange(graph_of_edges([0, 1, 2], [0, 1, 2], [0, 0, 0]), 1)
    assert (run.rounds, run.messages, run.bytes, run.most_bytes) == (1, 6, 6 * 3 * BYTES_A_NUMBER, 3 * BYTES_A_NUMBER)


def test_robots_that_share_no_target_exchange_nothing() -> None:
    run = exchange(graph_of_edges([0, 0, 1], [0, 1, 2], [0, 0, 1]), 3)
    assert (run.messages, run.bytes) == (0, 0)
    assert run.shares.sum() == pytest.approx(2.0)


def test_the_network_carries_nothing_to_robots_that_share_no_target() -> None:
    network = Network({7: [0, 1], 8: [1, 2]})
    assert network.by_robot({0: {1: (1.0,)}, 1: {}, 2: {}})[1] == {0: (1.0,)}
    with pytest.raises(ValueError, match="cannot speak"):
        network.by_robot({0: {2: (1.0,)}})


def test_a_robots_programme_knows_no_graph() -> None:
    # What a robot may know comes through its constructor and its inboxes: its module imports neither graph nor arrays.
    names = {
        alias.name
        for node in ast.walk(ast.parse(inspect.getsource(robot_module)))
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert not names & {"SensingGraph", "CleanGraph", "clean", "local_shares", "Network"}
    assert list(inspect.signature(robot_module.Robot).parameters) == ["name", "actions", "orders"]


def test_messages_are_plain_numbers_and_tuples(monkeypatch: pytest.MonkeyPatch) -> None:
    kinds: set[type] = set()

    def look(message: object) -> None:
        kinds.add(type(message))
        for part in message if isinstance(message, tuple) else ():
            look(part)

    monkeypatch.setattr(Network, "_count", lambda self, message: look(message))
    for search in ("secant", "step"):
        for smoothing in ("layers", "ball"):
            exchange(random_graph(np.random.default_rng(2), most_robots=8), 3, search=search, smoothing=smoothing)
    assert kinds <= {tuple, float, int}


def test_searches_of_too_many_levels_are_refused() -> None:
    check_coded(UsageError, "too-large", exchange, cycle(4), 2, eps=1e-6)
    check_refused(UsageError, "step=1e-06", exchange, cycle(4), 2, search="step", step=1e-6)
