"""All answers of small routing problems, what is stated of them, and prices that are worth trying."""

import itertools
import math
from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import linprog
from truth.base import Values
from truth.routing import RoutingTruth

from waybound import Routes, RoutingProblem
from waybound.formulations.routing.objective import PEAKS, Objective

Decision = tuple[dict[str, Any], bool]


class Answers(RoutingTruth):
    """Every answer that keeps the limits, with the value of its first level."""

    def __init__(self, problem: RoutingProblem) -> None:
        self.all: list[tuple[Routes, float]] = []
        super().__init__(problem)

    def meet(self, values: Values, strict: bool, answer: Any) -> None:
        self.all.append((answer, float(values[0])))
        super().meet(values, strict, answer)


def holds(problem: RoutingProblem, answer: Routes, statement: dict[str, Any]) -> bool:
    """Whether a statement is true of an answer."""
    index = problem.site_index
    if "term" in statement:
        asked = replace(problem, objective=Objective.of(statement["term"]))
        return asked.evaluate(answer).values[0] <= statement["at_most"]
    if "routes" in statement:
        return len(answer) <= statement["routes"]
    if "visited" in statement:
        by = statement.get("by", range(len(problem.fleet)))
        return any(index[statement["visited"]] in route.visits and route.vehicle in by for route in answer)
    made = set()
    for route in answer:
        kind = problem.fleet[route.vehicle]
        made |= set(itertools.pairwise([kind.start, *route.visits, kind.end]))
    pairs = [statement["arc"]] if "arc" in statement else [(a, b) for a, heads in statement["moves"].items() for b in heads]
    return any((index[a], index[b]) in made for a, b in pairs)


def best_of(problem: RoutingProblem, answers: Sequence[tuple[Routes, float]], decisions: Sequence[Decision]) -> float:
    """The best value of the answers of which all is as decided; infinite, as of no answer, without one."""
    left = [value for answer, value in answers if all(holds(problem, answer, s) is truth for s, truth in decisions)]
    return min(left, default=math.inf) if problem.sense == "min" else max(left, default=-math.inf)


def drawn_statement(problem: RoutingProblem, rng: np.random.Generator) -> dict[str, Any]:
    """One of any kind."""
    ids, customers = problem.sites.ids, [problem.sites.ids[k] for k in problem.customers]
    site, other = (str(s) for s in (rng.choice(customers), rng.choice(ids)))
    kinds = rng.permutation(len(problem.fleet))[: int(rng.integers(1, len(problem.fleet) + 1))].tolist()
    tail, head = (site, other) if rng.random() < 0.5 else (other, site)
    arc = {"arc": [tail, head]} if tail != head else {"visited": site}
    moves = {a: heads for a in ids if (heads := [b for b in ids if a != b and rng.random() < 0.3])} or {ids[0]: [ids[-1]]}
    into = {a: [site] for a, depot in zip(ids, problem.sites.depot, strict=True) if a != site and (depot or rng.random() < 0.6)}
    choices: list[dict[str, Any]] = [
        {"visited": site}, {"visited": site, "by": kinds}, arc, {"moves": moves}, {"moves": into},
        {"routes": int(rng.integers(1, len(ids)))}, drawn_limit(problem, rng),
    ]  # fmt: skip
    return choices[int(rng.choice(len(choices), p=[0.2, 0.2, 0.2, 0.1, 0.1, 0.1, 0.1]))]


def drawn_limit(problem: RoutingProblem, rng: np.random.Generator) -> dict[str, Any]:
    """A limit of the largest route, in the midst of what routes of a few visits take."""
    opens = max(float(problem.sites.ready[v.start]) for v in problem.fleet)
    size = float(problem.travel.distances.max()) * float(rng.choice([0.5, 1.5, 2.5, 4.0]))
    return {"term": str(rng.choice(PEAKS)), "at_most": float(opens + np.round(size, int(rng.integers(0, 3))))}


def drawn_evidence(problem: RoutingProblem, rng: np.random.Generator, scale: float) -> dict[str, Any]:
    """Prices of visits, rows and loads, memories, and now and then a claim."""
    customers, n = problem.customers, len(problem.sites)

    def some(least: int) -> list[int]:
        return rng.choice(customers, int(rng.integers(least, len(customers) + 1)), replace=False).tolist()

    data: dict[str, Any] = {"visits": (scale * rng.normal(rng.choice([-0.5, 0.0, 0.7]), 1.0, n)).tolist(), "apart": True}
    if rng.random() < 0.5:
        data["memory"] = int(rng.integers(0, n))
    else:
        data["remembered"] = [[] if problem.sites.depot[k] else some(0) for k in range(n)]
    if len(customers) >= 3 and rng.random() < 0.6:
        sites = rng.choice(customers, 3, replace=False).tolist()
        data["rows"] = [{"sites": sites, "memory": sorted({*sites, *some(0)}), "price": -scale * float(rng.random())}]
    if rng.random() < 0.6:
        data["loads"] = [{"sites": some(1), "price": scale * float(rng.random())} for _ in range(2)]
    if rng.random() < 0.2:
        data |= {"least": scale * float(rng.normal()), "least_needed": scale * float(rng.normal())}
    return data


class Partition(NamedTuple):
    """The linear relaxation of set partitioning: its value, a price a site, and its routes, each with its share."""

    value: float
    prices: list[float]
    routes: list[tuple[int, tuple[int, ...], float]]


def partition(problem: RoutingProblem, visited: Collection[int] = (), *, ray: bool = False) -> Partition:
    """Of a minimisation of what adds up along routes; those ``visited`` are so as well as the required ones. Infinite without a point.

    A ray counts what is missing of visits and routes, and no costs: its value is above 0 where there is no point.
    """
    truth, sites, kinds = RoutingTruth(problem), problem.sites, range(len(problem.fleet))
    nothing, sign = truth.values([])[0], 1.0 if problem.sense == "min" else -1.0
    groups = [(list(group.sites), group.required) for group in sites.groups]
    never = {k for members, _ in groups if {*members} & {*visited} for k in members} - {*visited}
    rows = [(members, required) for members, required in groups if not {*members} & {*visited}]
    single = {*problem.customers.tolist()} - never - {k for members, _ in rows for k in members}
    rows += [([k], bool(sites.required[k]) or k in visited) for k in sorted(single)]
    routes = [route for route in truth.driven if route[1] and not never & {*route[1]}]
    costs = [0.0 if ray else sign * float(truth.values([route])[0] - nothing) for route in routes]
    uses = np.array([[len({*members} & {*visits}) for _, visits in routes] for members, _ in rows]).reshape(len(rows), len(routes))
    counts = [len(problem.customers) if v.count is None else v.count for v in problem.fleet]
    used = np.array([[float(kind == k) for kind, _ in routes] for k in kinds]).reshape(len(kinds), len(routes))
    must, slack = np.array([required for _, required in rows]), np.eye(len(rows) + 1)
    keep = [*np.flatnonzero(must), len(rows)]  # what is missing of visits, and of routes
    equal = np.hstack([uses, slack[:-1, keep]])
    below = np.hstack([np.vstack([used, -np.ones(len(routes))]), np.vstack([np.zeros((len(kinds), len(keep))), -slack[-1, keep]])])
    found = linprog(
        [*costs, *np.ones(len(keep))], np.vstack([equal[~must], below]), [*np.ones((~must).sum()), *counts, -problem.min_vehicles],
        equal[must], np.ones(must.sum()), [(0.0, None)] * len(routes) + [(0.0, None if ray else 0.0)] * len(keep),
    )  # fmt: skip
    prices = np.zeros(len(sites))
    if found.status != 0:
        return Partition(math.inf, prices.tolist(), [])
    duals = np.zeros(len(rows))
    duals[must], duals[~must] = found.eqlin.marginals, found.ineqlin.marginals[: (~must).sum()]
    for (members, _), dual in zip(rows, duals, strict=True):
        prices[members] = dual
    value = float(found.fun) + (0.0 if ray else sign * float(nothing))
    return Partition(value, prices.tolist(), [(*route, float(share)) for route, share in zip(routes, found.x, strict=False)])


def grown(problem: RoutingProblem, best: float, decisions: Sequence[Decision] = ()) -> list[dict[str, Any]]:
    """Nodes of a tree that proves a best value, infinite without an answer: it divides by visits, then by types, then by moves."""
    part, ids, index = problem.restricted(decisions), problem.sites.ids, problem.site_index
    told = [site for s, truth in decisions if truth for site in (s.get("arc") or [s["visited"]])]
    visited = {index[site] for site in told} - {*problem.sites.depots.tolist()}
    relaxed, sign = partition(part, visited), 1.0 if problem.sense == "min" else -1.0
    lists = [[] if problem.sites.depot[k] else problem.customers.tolist() for k in range(len(ids))]
    data: dict[str, Any] = {"visits": relaxed.prices, "remembered": lists, "apart": True}
    if math.isinf(relaxed.value):
        data |= {"visits": partition(part, visited, ray=True).prices, "ray": True}
    leaf = {"kind": "set-partitioning-duals", "data": data}
    if relaxed.value >= sign * best - 1e-7 * max(1.0, abs(best)):
        return [leaf]
    statement = _divided(problem, relaxed)
    sides = [grown(problem, best, [*decisions, (statement, truth)]) for truth in (True, False)]
    return [{"branch": statement, **leaf}, *sides[0], *sides[1]]


def _divided(problem: RoutingProblem, relaxed: Partition) -> dict[str, Any]:
    """A statement that is partly true of the routes of a relaxation."""
    ids, fleet = problem.sites.ids, problem.fleet
    visits, kinds, moves = Counter[Any](), Counter[Any](), Counter[Any]()
    for kind, stops, share in relaxed.routes:
        for k in stops:
            visits[k,] += share
            kinds[k, kind] += share
        for move in itertools.pairwise([fleet[kind].start, *stops, fleet[kind].end]):
            moves[move] += share
    for tally, told in (
        (visits, lambda k: {"visited": ids[k]}), (kinds, lambda k, kind: {"visited": ids[k], "by": [kind]}),
        (moves, lambda i, j: {"arc": [ids[i], ids[j]]}),
    ):  # fmt: skip
        for key, share in tally.items():
            if abs(share - round(share)) > 1e-6:
                return told(*key)
    raise AssertionError("an answer is better than the best")
