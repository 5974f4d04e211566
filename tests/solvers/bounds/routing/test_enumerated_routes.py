import itertools
import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from draws import ALL, draws
from hypothesis import given, settings
from oracles import small_problems
from patience import HANG
from small_routing import plane, small
from truth.routing import best_values, routes

import waybound as wb
from waybound import Evidence, RoutingProblem
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing import branch_price_cut
from waybound.solvers.bounds.routing.branch_price_cut import Tree, branch_price_cut_bound
from waybound.solvers.bounds.routing.column_generation import ColumnGeneration
from waybound.solvers.bounds.routing.enumerated_routes import ChoiceTree
from waybound.solvers.bounds.routing.restricted_master import Pool
from waybound.solvers.linear_programs import LinearPrograms

FEATURES = ("capacity", "time-windows", "service-times", "max-distance", "limited-fleet", "fixed-cost", "open-routes")


pytestmark = pytest.mark.usefixtures("compiled_pricing")


@pytest.fixture(autouse=True)
def _at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Routes are listed however wide the gap is, before moves are left out or cuts are added."""
    monkeypatch.setattr(branch_price_cut, "WIDEST", 10.0)
    monkeypatch.setattr(Tree, "_hopeless", lambda self, node, part, solved: None)


def of_kind(evidence: Evidence | None) -> list[dict[str, Any]]:
    """The evidence over listed routes in a tree."""
    nodes = [{"kind": evidence.kind, "data": evidence.data}, *evidence.data.get("nodes", [])]
    return [node["data"] for node in nodes if node.get("kind") == "enumerated-routes"]


@pytest.mark.share(2)
@pytest.mark.parametrize("feature", FEATURES)
@pytest.mark.parametrize("seed", range(6 if ALL else 2))
def test_optima_of_small_problems_are_proved_over_all_their_routes(feature: str, seed: int) -> None:
    problem = small(feature, seed, "exact")
    best = best_values(problem)
    evidence = branch_price_cut_bound(problem, Stop(HANG))
    if best is None:
        return
    assert verified_bound(problem, evidence) == pytest.approx(best[0], rel=1e-9)


@settings(max_examples=draws(60), deadline=None)
@given(problem=small_problems(most=4, hetero=True))
def test_no_more_than_the_optimum_is_proved(problem: RoutingProblem) -> None:
    if BOUNDS["branch-price-cut"].missing(problem):
        return
    evidence, best = BOUNDS["branch-price-cut"].evidence(problem, Stop(20.0), LinearPrograms()), best_values(problem)
    if evidence is not None:
        sign = 1.0 if problem.sense == "min" else -1.0
        assert sign * verified_bound(problem, evidence) <= (math.inf if best is None else sign * best[0] + 1e-9 * abs(best[0]))


@pytest.mark.parametrize("feature", FEATURES)
def test_all_sets_of_customers_are_listed_with_their_cheapest_route(feature: str, monkeypatch: pytest.MonkeyPatch) -> None:
    problem, seen = small(feature, 1, "exact"), list[tuple[Pool, Any]]()
    original = branch_price_cut.routes_below

    def all_routes(columns: ColumnGeneration, part: Any, solved: Any, gap: float, most: int) -> Pool | None:
        every = original(columns, part, solved, 1e5, most)
        seen.append((every, every.sums(columns.cost[0]) * columns.unit))
        return every

    monkeypatch.setattr(branch_price_cut, "routes_below", all_routes)
    branch_price_cut_bound(problem, Stop(HANG))
    if not seen:
        return
    (every, cost), vehicle, customers = seen[0], problem.fleet[0], problem.customers
    truth = dict[frozenset[int], float]()
    for visits in routes(problem, vehicle):
        stops = [vehicle.start, *visits, vehicle.end]
        length = vehicle.fixed_cost + vehicle.unit_cost * sum(problem.travel.distances[i, j] for i, j in itertools.pairwise(stops))
        truth[frozenset(visits)] = min(length, truth.get(frozenset(visits), math.inf))
    found = {frozenset(customers[route - 1].tolist()): value for route, value in zip(every.routes, cost.tolist(), strict=True)}
    assert len(found) == len(every) and found == pytest.approx(truth)


@pytest.fixture(scope="module")
def proved() -> tuple[RoutingProblem, float, Evidence]:
    """A problem of twelve customers that is proved by a tree over all routes of a better answer."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(branch_price_cut, "WIDEST", 10.0)
        patch.setattr(Tree, "_hopeless", lambda self, node, part, solved: None)
        patch.setattr(ChoiceTree, "_cut", lambda self, point: False)
        for seed in range(30):
            problem = plane(seed, 10, 25.0)
            evidence = branch_price_cut_bound(problem, Stop(HANG))
            data = of_kind(evidence)
            if data and evidence.kind == "enumerated-routes" and len(data[0]["nodes"]) > 2:
                return problem, float(verified_bound(problem, evidence)), evidence
    raise AssertionError("none of thirty problems has branchings")


def higher_goal(data: dict[str, Any]) -> None:
    data["goal"] *= 1.05


def dear_visits(data: dict[str, Any]) -> None:
    for node in data["nodes"]:
        if "visits" in node:
            node["visits"] = [1.5 * v for v in node["visits"]] if isinstance(node["visits"], list) else node["visits"]


def one_side_withheld(data: dict[str, Any]) -> None:
    """The last leaf says nothing, as if it had no answer."""
    data["goal"] *= 1.05
    data["nodes"][-1] = {}


def cheap_routes_hidden(data: dict[str, Any]) -> None:
    """Prices at which fewer routes are listed, and a least that no walk has."""
    data["goal"] *= 1.05
    data["prices"]["least"] = 1e9


def heavy_rows(data: dict[str, Any]) -> None:
    """Rows of weights that would exclude the optimum if they were rounded up."""
    data["goal"] *= 1.05
    at = data["nodes"][0].setdefault("rows", [])
    at.append({"sites": [1, 2, 3], "weights": [2, 2, 2], "parts": 3, "price": -100.0})


@pytest.mark.parametrize("fault", [higher_goal, dear_visits, one_side_withheld, cheap_routes_hidden, heavy_rows])
def test_evidence_that_is_wrong_proves_no_more_than_the_optimum(
    fault: Callable[[dict[str, Any]], None], proved: tuple[RoutingProblem, float, Evidence]
) -> None:
    problem, best, evidence = proved
    lie = json.loads(json.dumps(evidence.data))
    fault(lie)
    assert lie != evidence.data
    assert verified_bound(problem, Evidence(evidence.kind, "", 2.0 * best, lie)) <= best * (1.0 + 1e-9)


def withheld(every: Pool, cost: np.ndarray) -> Pool:
    """All routes but those of low cost a customer, which good answers have."""
    each = cost / np.array([len(route) for route in every.routes])
    kept = Pool()
    kept.add(every.drives(np.nonzero(each > np.quantile(each, 0.4))[0]))
    return kept


def test_a_search_that_withholds_routes_proves_nothing_that_is_false(
    proved: tuple[RoutingProblem, float, Evidence], monkeypatch: pytest.MonkeyPatch
) -> None:
    problem, best, _ = proved
    original, hidden = branch_price_cut.routes_below, list[int]()

    def fewer(columns: ColumnGeneration, part: Any, solved: Any, gap: float, most: int) -> Pool | None:
        every = original(columns, part, solved, gap, most)
        hidden.append(0 if every is None else len(every))
        return every if every is None else withheld(every, every.sums(columns.cost[0]))

    monkeypatch.setattr(branch_price_cut, "routes_below", fewer)
    evidence = branch_price_cut_bound(problem, Stop(HANG), target=1.2 * best)
    assert max(hidden) > 0
    assert verified_bound(problem, evidence) <= best * (1.0 + 1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_with_and_without_it_the_same_is_proved(seed: int) -> None:
    problem = plane(seed, 12, 25.0)
    found = [wb.solve(problem, "branch-price-cut", enumeration=most, bound_time=0) for most in (0, 50_000)]
    assert found[0].bound_kind == found[1].bound_kind == "verified"
    assert found[0].objective == pytest.approx(found[1].objective) == pytest.approx(found[1].bound)
