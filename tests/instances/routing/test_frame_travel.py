from typing import Any

import networkx as nx
import numpy as np
import pandas as pd
import pytest
from coded import coded
from file_cases import check_refused, refused
from hypothesis import given, strategies as st

import waybound as wb
from waybound.instances.clock import Times
from waybound.instances.errors import InputError
from waybound.instances.routing.foreign_names import ELSEWHERE, OURS
from waybound.instances.routing.frame_travel import MOVES, Moves, is_list, listed_moves, matrix_of, moves_of, without_infinities

IDS = ("o", "a", "b")
D = np.array([[0, 1, 2], [3, 0, 4], [5, 6, 0]], dtype=float)


def moves(travel: Any, durations: Any = None, unit: str | None = None, weight: str = "weight", nodes: tuple[str, ...] = IDS) -> Moves:
    return moves_of(travel, durations, IDS, nodes, Times(unit), weight, "km")


def roads(directed: bool = True) -> nx.Graph:
    graph = (nx.MultiDiGraph if directed else nx.Graph)()
    for tail, head, km in [("o", "j", 1.0), ("j", "a", 0.0), ("a", "b", 4.0), ("b", "o", 2.0), ("a", "o", 7.0)]:
        graph.add_edge(tail, head, km=km, minutes=10 * km)
    return graph


def test_a_frame_with_labels_is_put_in_order_and_holds_timedeltas() -> None:
    order = ["b", "o", "a"]
    mixed = pd.DataFrame(D, index=IDS, columns=IDS).loc[order, order]
    made = moves(mixed, mixed.map(lambda v: pd.Timedelta(minutes=v)), "min")
    assert np.array_equal(made.distances, D) and np.array_equal(made.durations, D) and made.forbidden is None


def test_a_list_of_moves_lacks_what_cannot_be_made() -> None:
    frame = pd.DataFrame(
        {"from": ["o", "a", "b"], "to": ["a", "b", "o"], "distance": [1, 4, 5], "duration": pd.to_timedelta([2, 3, 9], "min")}
    )
    made = moves(frame, unit="min")
    assert made.forbidden is not None and np.argwhere(made.forbidden).tolist() == [[0, 2], [1, 0], [2, 1]]
    assert made.distances[0, 1] == 1 and made.durations is not None and made.durations[2, 0] == 9
    assert np.isfinite(made.distances).all() and made.distances[0, 2] == 10


def test_shortest_ways_through_a_graph_over_other_nodes_and_edges_of_length_0() -> None:
    made = moves(roads(), "minutes", weight="km")
    assert made.distances.tolist() == [[0, 1, 5], [6, 0, 4], [2, 3, 0]]
    assert made.durations is not None and made.durations[0, 2] == 50
    assert moves(roads(directed=False), weight="km").distances.tolist() == [[0, 1, 2], [1, 0, 3], [2, 3, 0]]


def test_of_edges_beside_each_other_the_shortest_counts_and_sites_may_be_called_otherwise() -> None:
    graph = nx.MultiDiGraph()
    for tail, head, km in [(1, 2, 5.0), (1, 2, 3.0), (2, 3, 1.0), (3, 1, 1.0)]:
        graph.add_edge(tail, head, weight=km)
    assert moves(graph, nodes=("1", "2", "3")).distances[0, 1] == 3


@pytest.mark.parametrize(
    ("travel", "given_more", "message"),
    [
        (roads(), {"weight": "length"}, "has no attribute 'length'; expected weight= the one that holds distances; found km, minutes"),
        (roads(), {"weight": "km", "nodes": ("o", "a", "z")}, "the graph has no node 'z' for site b"),
        (nx.DiGraph([("o", "a", {"weight": 1}), ("a", "b", {"weight": 1})]), {}, "no road leads to site o"),
        (nx.DiGraph([("o", "a", {"weight": -1}), ("a", "b", {"weight": 1})]), {}, "weight of the edge from o to a must be finite"),
        (pd.DataFrame({"from": ["o", "z"], "to": ["a", "b"], "distance": [1, 1]}), {}, "the list of moves names the unknown site 'z'"),
        (pd.DataFrame({"from": ["o", "o"], "to": ["a", "a"], "distance": [1, 1]}), {}, "the move from o to a stands twice"),
        (np.full((3, 3), np.nan), {}, "must be a number and not negative; expected inf for a move that cannot be made"),
        ({"durations": [[0, 1], [1, 0]]}, {}, "the distance matrix and the sites have different sizes"),
        (D, {"durations": np.full((3, 3), np.timedelta64(60, "s"))}, "the duration matrix holds timedeltas: say in which unit"),
    ],
)
def test_what_is_wrong_is_named(travel: Any, given_more: dict[str, Any], message: str) -> None:
    assert message in refused(moves, travel, **given_more)


@given(st.integers(2, 5), st.randoms(use_true_random=False))
def test_infinities_become_forbidden_moves_and_nothing_else_changes(n: int, rng: Any) -> None:
    values = np.array([[rng.choice([0.0, 1.0, 7.5, np.inf]) for _ in range(n)] for _ in range(n)])
    values[0, 1] = 3.0
    distances, durations, forbidden = without_infinities(values, None)
    shut = np.isinf(values) & ~np.eye(n, dtype=bool)
    assert durations is None and np.array_equal(shut, np.zeros_like(shut) if forbidden is None else forbidden)
    open_moves = ~shut & ~np.eye(n, dtype=bool)
    assert np.array_equal(distances[open_moves], values[open_moves]) and np.isfinite(distances).all()


def test_a_matrix_has_the_size_of_the_sites() -> None:
    check_refused(InputError, r"expected \(3, 3\); found \(2, 3\)", matrix_of, D[:2], IDS, "distance", None)


# -- lists of moves ------------------------------------------------------------------------------------------------------

MOVE = pd.DataFrame({"from": ["o", "a", "b"], "to": ["a", "b", "o"], "distance": [1.0, 4.0, 5.0]})
SITES = pd.DataFrame({"id": IDS, "due": [900, 60, 900]})


def refusal_of_list(frame: Any, unit: str | None = None) -> str:
    return refused(listed_moves, frame, IDS, Times(unit))


@pytest.mark.parametrize("title", ["duration", "Duration", "DURATION"])
def test_titles_are_read_in_any_case(title: str) -> None:
    frame = MOVE.rename(columns=str.upper).assign(**{title: [50, 60, 70]})
    distances, durations, notes = listed_moves(frame, IDS, Times(None))
    assert is_list(frame, IDS) and distances[0, 1] == 1 and durations is not None and durations[0, 1] == 50 and notes == ()


@pytest.mark.parametrize("title", OURS["moves"]["duration"].split())
def test_durations_under_another_name_are_never_taken_from_the_distances(title: str) -> None:
    assert f"{title!r}; did you mean 'duration'?" in refusal_of_list(MOVE.assign(**{title: [50, 60, 70]}))
    with pytest.raises(InputError, match="did you mean 'duration'"):
        wb.RoutingProblem.from_frame(SITES, travel=MOVE.assign(**{title: [50, 60, 70]}), vehicles=1)


@pytest.mark.parametrize("own", ["from", "to", "distance"])
def test_other_names_of_what_has_to_be_there(own: str) -> None:
    for title in OURS["moves"][own].split():
        frame = MOVE.rename(columns={own: title})
        assert is_list(frame, IDS) and f"{title!r}; did you mean {own!r}?" in refusal_of_list(frame)


@pytest.mark.parametrize("title", [name for names in ELSEWHERE["moves"].values() for name in names.split()])
def test_what_is_told_otherwise_is_refused(title: str) -> None:
    assert f"unknown column {title!r}; " in refusal_of_list(MOVE.assign(**{title: 1}))


def test_ends_under_other_names_make_a_list() -> None:
    both = MOVE.rename(columns={"from": "origin", "to": "destination"})
    assert is_list(both, IDS) and "'origin'; did you mean 'from'?" in refusal_of_list(both)
    assert not is_list(pd.DataFrame(np.zeros((3, 3)), index=IDS, columns=IDS), IDS)
    assert not is_list(pd.DataFrame(np.zeros((2, 2)), columns=["from", "to"]), ("from", "to")) and not is_list(np.zeros((3, 3)), IDS)


def test_columns_that_mean_nothing_are_told() -> None:
    told = "columns of moves that are not used: street, note"
    assert listed_moves(MOVE.assign(street="x", note=1), IDS, Times(None))[2] == (told,)
    made = wb.RoutingProblem.from_frame(SITES, travel=MOVE.assign(street="x", note=1), vehicles=1)
    assert told in made.notes and told in made.remarks()


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        (MOVE.drop(columns="distance"), "the moves have no column 'distance'; expected from, to, distance, duration; found from, to"),
        (MOVE.assign(Distance=1), "columns 'distance' and 'Distance' of the moves both tell distance"),
        (MOVE.assign(km=1), "columns 'distance' and 'km' of the moves both tell distance"),
        (MOVE.assign(distance=[1, np.nan, 2]), "distance of the move from a to b must be a number and not negative"),
        (MOVE.assign(duration=[1, 2, -2]), "duration of the move from b to o must be a number and not negative"),
        (MOVE.assign(distance="far"), "column distance of the moves must hold numbers"),
        (MOVE.assign(to=["a", None, "o"]), "row 2 of the moves has no to"),
        (MOVE.assign(duratoin=1), "unknown column 'duratoin'; did you mean 'duration'?"),
    ],
)
def test_what_is_wrong_in_a_list_is_named(frame: Any, message: str) -> None:
    assert message in refusal_of_list(frame)


def test_numbers_of_sites_that_a_missing_value_made_floats_are_whole() -> None:
    frame = pd.DataFrame({"from": [0.0, 1.0], "to": [1.0, 0.0], "distance": [3, 4]})
    assert listed_moves(frame, ("0", "1"), Times(None))[0].tolist() == [[0, 3], [4, 0]]


def test_durations_are_told_once() -> None:
    with pytest.raises(InputError, check=coded("duplicate")):
        wb.RoutingProblem.from_frame(SITES, travel=MOVE.assign(duration=1), durations=np.zeros((3, 3)), vehicles=1)
    assert MOVES == ("from", "to", "distance", "duration")
