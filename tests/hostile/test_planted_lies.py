"""Lies planted in trees that prove optima of every family: each is refused, or proves nothing that is false, and never what it states."""

import copy
import json
import math
import random
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import selection_problems
from branching_programs import random_program, without_answer
from draws import ALL, draws
from random_sensing import random_graph
from routing_answers import grown as prices_tree
from sata_cases import selections
from small_routing import drawn, plane, small
from truth.families import truth
from truth.routing import best_values

from waybound import BottleneckSATA, Evidence, Problem, RoutingProblem, WayboundError
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.certificate import certify, check_certificate
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.reports.battery.kinds import KINDS
from waybound.reports.battery.truth import program_truth
from waybound.solvers.bounds.branching_tree import branching_tree_bound
from waybound.solvers.bounds.routing.branch_price_cut import branch_price_cut_bound
from waybound.solvers.engines.routing.ruin_recreate_steps.near_kernels import nearest
from waybound.solvers.engines.routing.ruin_recreate_steps.search_kernels import anneal

Data = dict[str, Any]
Lie = Callable[[Data, random.Random], bool]

pytestmark = pytest.mark.slow  # proving the optima of so many takes several seconds

MANY = 40 if ALL else 24
"""Programs, and problems with products, whose optima are proved."""


@cache
def cases() -> list[tuple[Problem, float | None, str]]:
    """Problems, their optima (None: no answer), and a certificate file with a tree for each."""
    found: list[tuple[Problem, float | None]] = [(without_answer(), None)]
    for seed in range(MANY):
        program = random_program(seed)
        best = truth(program).best
        found.append((program, None if best is None else float(best[0])))
    for seed in range(MANY):
        product = KINDS["products"](np.random.default_rng([seed, 5]))
        value = program_truth(product.program).value  # type: ignore[attr-defined]
        found.append((product, None if value is None else float(value)))
    rng = np.random.default_rng(3)
    for _ in range(draws(15)):
        chosen = selection_problems.random_problem(rng, "dense", "knapsack", 8)
        found.append((chosen, selection_problems.optimum(chosen)))
    for seed in range(6):
        sensed = BottleneckSATA(random_graph(seed, robots=4, targets=4, most_actions=3))
        found.append((sensed, max(sensed.evaluate(s).values[0] for s in selections(sensed.graph))))
    for feature in ("capacity", "time-windows", "limited-fleet"):
        for seed in range(4):
            routed = small(feature, seed, "exact")
            values = best_values(routed)
            found.append((routed, None if values is None else values[0]))
    grown = [(problem, best, branching_tree_bound(problem, Stop(20.0))) for problem, best in found]
    for kernel in (nearest, anneal):  # the proofs begin with an answer only where these are compiled
        kernel.make()
    for seed in (0, 6, 9, 10):
        routed = plane(seed, 7, 17.0)
        values = best_values(routed)
        grown.append((routed, None if values is None else values[0], branch_price_cut_bound(routed, Stop(20.0))))
    for feature, seeds in (("heterogeneous-fleet", (8, 13)), ("prizes", (10,)), ("groups", (5, 6))):
        for seed in seeds:
            grown.append(apart(drawn(feature, seed)))
    made = []
    for problem, best, evidence in grown:
        if evidence is not None and evidence.kind == "branching-tree":
            made.append((problem, best, json.dumps(certify(problem, None, [evidence]).to_json(with_evidence=True))))
    assert {problem.family for problem, *_ in made} == {"arrays", "selection", "max-min", "routing"}
    assert sum(best is None for _, best, _ in made) >= 3
    assert sum('"quadratic-duals"' in text for *_, text in made) >= 5
    assert sum("set-partitioning-duals" in text for *_, text in made) >= 3
    assert sum('"apart"' in text for *_, text in made) >= 4 and sum('"by"' in text for *_, text in made) >= 2
    return made


def apart(problem: RoutingProblem) -> tuple[Problem, float | None, Evidence]:
    """A tree of statements on visits whose leaves keep types of vehicle apart."""
    values = best_values(problem)
    told = prices_tree(problem, values[0])
    tree = [{"branch": node["branch"]} if "branch" in node else node for node in told]
    evidence = Evidence("branching-tree", "by hand", 0.0, {"nodes": tree})
    return problem, values[0], replace(evidence, value=verified_bound(problem, evidence))


def nodes(data: Data) -> list[Data]:
    return data["evidence"][0]["data"]["nodes"]  # type: ignore[no-any-return]


def leaves(data: Data) -> list[Data]:
    return [node for node in nodes(data) if "branch" not in node]


def numbers(data: Any) -> Iterator[tuple[Any, Any]]:
    """Every place of a number that is not 0 within evidence, as a container and a key."""
    for key, value in data.items() if isinstance(data, dict) else enumerate(data):
        if isinstance(value, dict | list):
            yield from numbers(value)
        elif isinstance(value, float) and value != 0.0:
            yield data, key


def changed_numbers(change: Callable[[float], Any]) -> Lie:
    def lie(data: Data, rng: random.Random) -> bool:
        places = [place for leaf in leaves(data) for place in numbers(leaf)]
        for container, key in places:
            container[key] = change(container[key])
        return bool(places)

    return lie


def one_number(value: Any) -> Lie:
    def lie(data: Data, rng: random.Random) -> bool:
        places = [place for leaf in leaves(data) for place in numbers(leaf)]
        if places:
            container, key = rng.choice(places)
            container[key] = value
        return bool(places)

    return lie


def lost_leaf(data: Data, rng: random.Random) -> bool:
    nodes(data).remove(rng.choice(leaves(data)))
    return True


def lost_branching(data: Data, rng: random.Random) -> bool:
    nodes(data).pop(0)
    return True


def one_leaf_more(data: Data, rng: random.Random) -> bool:
    nodes(data).append(copy.deepcopy(rng.choice(leaves(data))))
    return True


def lost_subtree(data: Data, rng: random.Random) -> bool:
    del nodes(data)[-1]
    del nodes(data)[0]
    return True


def opened_leaves(data: Data, rng: random.Random) -> bool:
    for leaf in leaves(data):
        leaf.clear()
    return True


def swapped_sides(data: Data, rng: random.Random) -> bool:
    """The leaves in the opposite order: each proves something of the wrong part."""
    given = leaves(data)
    contents = [dict(leaf) for leaf in reversed(given)]
    for leaf, content in zip(given, contents, strict=True):
        leaf.clear()
        leaf.update(content)
    return contents != list(reversed(contents))


def same_evidence_everywhere(data: Data, rng: random.Random) -> bool:
    best = copy.deepcopy(leaves(data)[0])
    for leaf in leaves(data):
        leaf.clear()
        leaf.update(copy.deepcopy(best))
    return True


def rays_everywhere(data: Data, rng: random.Random) -> bool:
    """Every leaf is said to have no answer, by the multipliers that bound it."""
    done = False
    for leaf in leaves(data):
        if leaf.get("kind") == "lp-dual" and "duals" in leaf["data"]:
            leaf["data"] = {"ray": leaf["data"]["duals"]}
            done = True
        elif leaf.get("kind") in ("arc-multipliers", "set-partitioning-duals"):
            leaf["data"]["ray"] = True
            done = True
    return done


def rounded_up(data: Data, rng: random.Random) -> bool:
    """A bound a little better than the one that is proved."""
    if data["bound"] is None:
        return False
    better = 1.0 if data["sense"] == "min" else -1.0
    for holder, key in ((data, "bound"), (data["evidence"][0], "value")):
        holder[key] = data["bound"] + better * 1e-6 * max(1.0, abs(data["bound"])) if key == "bound" else holder[key]
    return True


def said_to_be_infeasible(data: Data, rng: random.Random) -> bool:
    known = bool(data["infeasible"])
    data["infeasible"] = True
    return not known


def skipping_branch(data: Data, rng: random.Random) -> bool:
    """A statement that is none, for which neither side might hold."""
    node = rng.choice([n for n in nodes(data) if "branch" in n])
    node["branch"] = {**node["branch"], "least": 7}
    return True


def forgotten_nobody(data: Data, rng: random.Random) -> bool:
    """Memories that are no numbers of neighbours."""
    chosen = priced(data)
    for held in chosen:
        held.pop("remembered")
        held["memory"] = rng.choice([-1, 0.5, "8", None, True])
    return bool(chosen)


def fewer_remembered(data: Data, rng: random.Random) -> bool:
    chosen = priced(data)
    for held in chosen:
        held.pop("remembered")
        held["memory"] = rng.choice([0, 1, 10**9])
    return bool(chosen)


def priced(data: Data) -> list[Data]:
    """The evidence of leaves that price visits."""
    return [leaf["data"] for leaf in leaves(data) if leaf.get("kind") == "set-partitioning-duals"]


def with_rows(data: Data, rng: random.Random, **wrong: Any) -> bool:
    """Subset rows and loads that nobody looked for, some of which may be wrong."""
    for held in priced(data):
        customers = range(1, len(held["visits"]) if isinstance(held["visits"], list) else 1 + max(held["visits"]["at"]))
        rows, loads = [], []
        for _ in range(rng.randint(1, 6)):
            sites = rng.sample(customers, 3)
            memory = sorted({*sites, *rng.sample(customers, rng.randint(0, len(customers)))})
            rows.append({"sites": sites, "memory": memory, "price": -rng.choice([0.1, 5.0, 50.0]), **wrong})
            loads.append({"sites": rng.sample(customers, rng.randint(1, len(customers))), "price": rng.choice([0.1, 5.0, 50.0])})
        held |= {"rows": rows, "loads": loads}
    return bool(priced(data))


def with_rows_that_pay(data: Data, rng: random.Random) -> bool:
    return with_rows(data, rng, price=rng.choice([1e-9, 3.0]))


def with_forgotten_rows(data: Data, rng: random.Random) -> bool:
    return with_rows(data, rng, memory=[1])


def with_rows_of_depots(data: Data, rng: random.Random) -> bool:
    return with_rows(data, rng, sites=[0, 1, 2], memory=[0, 1, 2])


def with_rows_of_no_weight(data: Data, rng: random.Random) -> bool:
    """As if no route might have any of them."""
    return with_rows(data, rng, most=0)


def claimed_least(data: Data, rng: random.Random) -> bool:
    for held in priced(data):
        held |= {"least": rng.choice([0.0, 1e9, -1.0]), "least_needed": 1e9}
    return bool(priced(data))


def branched(data: Data) -> list[tuple[Data, str, str]]:
    """Nodes of trees of routes that branch on moves, and a move of each."""
    found = []
    for node in nodes(data) if priced(data) else []:
        branch = node.get("branch", {})
        tail, head = branch.get("arc") or next(((t, h[0]) for t, h in branch.get("moves", {}).items()), ("", ""))
        if tail:
            found.append((node, tail, head))
    return found


def sets_of_moves(data: Data, rng: random.Random) -> bool:
    """Statements on one move are turned into such on many, with the evidence as it was."""
    ids = [str(k) for k in range(8)]
    told = branched(data)
    for node, tail, head in told:
        node["branch"] = {"moves": {tail: [head], **{a: [b for b in ids if b != a] for a in rng.sample(ids, 3) if a != tail}}}
    return bool(told)


def half_a_set(data: Data, rng: random.Random) -> bool:
    told = branched(data)
    for node, tail, head in told:
        node["branch"] = {
            "moves": rng.choice([{}, {tail: head}, {tail: []}, {tail: [head, head]}, {tail: [tail]}, [tail, head], {tail: ["?"]}])
        }
    return bool(told)


def visits(data: Data) -> list[Data]:
    """Statements on visits."""
    return [node["branch"] for node in nodes(data) if "visited" in node.get("branch", {})]


def visits_by_nobody(data: Data, rng: random.Random) -> bool:
    for told in visits(data):
        told["by"] = rng.choice([[], [99], [-1], [0, 0], [0.0], [True], "0", 0, None])
    return bool(visits(data))


def visits_to_nobody(data: Data, rng: random.Random) -> bool:
    for told in visits(data):
        told["visited"] = rng.choice(["0", "nobody", 1, None])
    return bool(visits(data))


def other_visits(data: Data, rng: random.Random) -> bool:
    told = visits(data)
    for statement in told:
        statement |= rng.choice([{"visited": str(rng.randint(1, 3))}, {"by": [0]}])
    return bool(told)


def half_apart(data: Data, rng: random.Random) -> bool:
    for held in priced(data):
        held["apart"] = rng.choice([1, 0, "true", None, [0]])
    return bool(priced(data))


def all_apart(data: Data, rng: random.Random) -> bool:
    for held in priced(data):
        held["apart"] = not held.get("apart", False)
    return bool(priced(data))


def fractional_branch(data: Data, rng: random.Random) -> bool:
    node = rng.choice([n for n in nodes(data) if "branch" in n])
    key = next(k for k in node["branch"])
    node["branch"] = {key: 0.5} if len(node["branch"]) == 1 else {**node["branch"], "most": node["branch"].get("most", 0) + 0.5}
    return True


def nested(data: Data, rng: random.Random) -> bool:
    leaf = rng.choice(leaves(data))
    inner = copy.deepcopy(nodes(data))
    leaf.clear()
    leaf.update(kind="branching-tree", data={"nodes": inner})
    return True


def unknown_kind(data: Data, rng: random.Random) -> bool:
    rng.choice([leaf for leaf in leaves(data) if leaf])["kind"] = "my-word"
    return True


def deep(data: Data, rng: random.Random) -> bool:
    branch = next(n["branch"] for n in nodes(data) if "branch" in n)
    nodes(data)[:0] = [{"branch": branch}] * 3000
    return True


LIES: dict[str, Lie] = {
    "a leaf is lost": lost_leaf, "a branching is lost": lost_branching, "a leaf too many": one_leaf_more,
    "all leaves are open": opened_leaves, "a bound is rounded up": rounded_up, "no answer, it says": said_to_be_infeasible,
    "a branching skips": skipping_branch, "a branching at a half": fractional_branch, "a tree in a tree": nested,
    "an unknown kind": unknown_kind, "too deep": deep, "half a memory": forgotten_nobody, "rows that pay": with_rows_that_pay,
    "rows that are forgotten": with_forgotten_rows, "rows of depots": with_rows_of_depots, "rows of no weight": with_rows_of_no_weight,
    "half a set of moves": half_a_set, "visits by nobody": visits_by_nobody, "visits to nobody": visits_to_nobody, "half apart": half_apart,
    "NaN": one_number(math.nan), "infinity": one_number(math.inf), "overflow": one_number(10**400), "a text": one_number("1"),
    "true": one_number(True), "null": one_number(None), "a list": one_number([1.0]),
}  # fmt: skip
"""What must be refused wherever it can be told."""

HARMLESS: dict[str, Lie] = {
    "signs turned": changed_numbers(lambda v: -v), "ten times as much": changed_numbers(lambda v: 10.0 * v),
    "next to nothing": changed_numbers(lambda v: 1e-300 * v), "next to infinity": changed_numbers(lambda v: 1e300 * v),
    "sides swapped": swapped_sides, "one for all": same_evidence_everywhere, "rays that are none": rays_everywhere,
    "other memories": fewer_remembered, "rows and loads": with_rows, "a least walk": claimed_least, "sets of moves": sets_of_moves,
    "apart or together": all_apart, "other visits": other_visits, "a branching and a leaf are lost": lost_subtree,
}  # fmt: skip
"""What may prove something, though never anything false."""


FEWEST = {
    "half a memory": 3, "other memories": 3, "rows that pay": 3, "rows that are forgotten": 3, "rows of depots": 3, "rows of no weight": 3,
    "half a set of moves": 2, "rows and loads": 3, "a least walk": 3, "sets of moves": 2, "visits by nobody": 3, "visits to nobody": 3,
    "half apart": 3, "apart or together": 3, "other visits": 3,
}  # fmt: skip
"""Cases in which a lie must have been told, where not 20: the trees of routes."""


def planted(lie: Lie) -> Iterator[tuple[Problem, float | None, Data]]:
    for k, (problem, best, text) in enumerate(cases()):
        data = json.loads(text)
        if lie(data, random.Random(k)):
            yield problem, best, data


@pytest.mark.parametrize("name", LIES)
def test_lies_that_can_be_told_are_refused(name: str) -> None:
    told = 0
    for problem, _, data in planted(LIES[name]):
        told += 1
        with pytest.raises(WayboundError):
            check_certificate(problem, data, None)
    assert told >= FEWEST.get(name, 20)


@pytest.mark.parametrize("name", HARMLESS)
def test_what_other_numbers_prove_is_true(name: str) -> None:
    told = 0
    for problem, best, data in planted(HARMLESS[name]):
        told += 1
        try:
            made = check_certificate(problem, data, None)
        except WayboundError:
            continue
        assert made.infeasible is (best is None)
        if best is not None and made.bound is not None:
            sign = 1.0 if problem.sense == "min" else -1.0
            assert sign * made.bound <= sign * best + 1e-9 * max(1.0, abs(best))
    assert told >= FEWEST.get(name, 20)


def test_a_tree_of_another_problem_is_refused() -> None:
    every = cases()
    told = 0
    for (problem, _, _), (_, _, text) in zip(every, every[1:] + every[:1], strict=True):
        told += 1
        with pytest.raises(WayboundError, match="another instance"):
            check_certificate(problem, json.loads(text), None)
    assert told >= 20


def test_a_tree_of_another_problem_under_a_stolen_name_proves_nothing_false() -> None:
    every = cases()
    for (problem, best, own), (_, _, text) in zip(every, every[1:] + every[:1], strict=True):
        data = {**json.loads(own), "evidence": json.loads(text)["evidence"]}
        try:
            made = check_certificate(problem, data, None)
        except WayboundError:
            continue
        assert made.infeasible is (best is None)


def test_an_honest_tree_passes() -> None:
    for problem, best, text in cases():
        made = check_certificate(problem, json.loads(text), None)
        assert made.infeasible is (best is None)
        if best is not None:
            assert made.bound == pytest.approx(best, rel=1e-9, abs=1e-9)


def test_a_statement_about_a_variable_that_is_no_integer_is_refused() -> None:
    assert any(isinstance(problem, ArrayProblem) and not problem.program.integer.all() for problem, *_ in cases())
    for problem, _, text in cases():
        if isinstance(problem, ArrayProblem) and not problem.program.integer.all():
            data = json.loads(text)
            column = int(np.nonzero(~problem.program.integer)[0][0])
            for node in nodes(data):
                if "branch" in node:
                    node["branch"]["variable"] = column
            with pytest.raises(WayboundError, match="no integer"):
                check_certificate(problem, data, None)
