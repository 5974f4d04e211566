import itertools
import json
import math
from typing import Any

import numpy as np
import pytest
from branching_programs import knapsack, random_program, without_answer
from coded import coded
from draws import draws
from programs import program
from random_sensing import random_graph
from truth.families import truth

from waybound import CheckFailedError, Evidence, InputError, Problem, WayboundError
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.certificate import certify, check_certificate
from waybound.formulations.checking.branching_tree import DEEPEST
from waybound.formulations.sata.bottleneck_sata import BottleneckSATA
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.bounds.branching_tree import branching_tree_bound

NO_DUALS = {"duals": {"at": [], "values": []}}


def tree(*nodes: dict[str, Any]) -> Evidence:
    return Evidence("branching-tree", "a test", 0.0, {"nodes": list(nodes)})


def at_most(column: int, most: int) -> dict[str, Any]:
    return {"branch": {"variable": column, "most": most}}


def leaf(**data: Any) -> dict[str, Any]:
    return {"kind": "lp-dual", "data": data or NO_DUALS}


def bound(problem: Problem, *nodes: dict[str, Any]) -> float:
    return verified_bound(problem, tree(*nodes))


def test_the_bound_of_a_tree_is_that_of_its_worst_leaf() -> None:
    problem = knapsack()  # without duals, a bound is that of the box: 5 x + 4 y + 3 z with x, y, z <= 9
    assert bound(problem, leaf()) == 108.0
    assert bound(problem, at_most(0, 2), leaf(), leaf()) == 108.0
    assert bound(problem, at_most(0, 2), leaf(), leaf(duals=[2.5, 0.0, 0.0])) == 73.0
    both = at_most(0, 2), at_most(2, 1), leaf(), leaf(duals=[0.0, 0.0, 1.5]), leaf(duals=[2.5, 0.0, 0.0])
    assert bound(problem, *both) == 49.0


def test_an_open_leaf_is_bounded_by_what_stands_above_it() -> None:
    problem = knapsack()
    assert bound(problem, {}) == math.inf
    assert bound(problem, at_most(0, 2), {}, leaf(duals=[2.5, 0.0, 0.0])) == math.inf
    assert bound(problem, {**at_most(0, 2), **leaf()}, {}, leaf(duals=[2.5, 0.0, 0.0])) == 108.0
    above = {**at_most(0, 2), **leaf(duals=[2.5, 0.0, 0.0])}
    assert bound(problem, above, leaf(), leaf()) == bound(problem, leaf(duals=[2.5, 0.0, 0.0])), "worse evidence below costs nothing"


def test_leaves_without_answers_prove_that_there_is_none() -> None:
    problem = without_answer()
    step = [0.0, 1.0]
    # 2 x + 2 y + 2 z = 3: with x at most 0, y at most 0 and z at most 0 too little, and so on.
    nodes: list[dict[str, Any]] = []

    def grow(k: int, used: int) -> None:
        if k == 3 or 2 * used > 3 or 2 * (used + 3 - k) < 3:
            nodes.append(leaf(ray=[1.0 if 2 * (used + 3 - k) < 3 else -1.0]))
            return
        nodes.append(at_most(k, 0))
        for more in step:
            grow(k + 1, used + int(more))

    grow(0, 0)
    evidence = tree(*nodes)
    assert verified_bound(problem, evidence) == math.inf
    made = certify(problem, None, [evidence])
    assert made.infeasible and made.bound is None
    again = check_certificate(problem, json.loads(json.dumps(made.to_json(with_evidence=True))), None)
    assert again.infeasible
    nodes[-1] = {}
    assert verified_bound(problem, tree(*nodes)) == -math.inf


def test_limits_that_cross_leave_no_answer() -> None:
    assert bound(knapsack(), at_most(0, 3), at_most(0, 4), leaf(), leaf(), leaf()) == 108.0
    assert verified_bound(knapsack().restricted([({"variable": 0, "most": 3}, True), ({"variable": 0, "most": 3}, False)]),
                          Evidence("lp-dual", "", 0.0, NO_DUALS)) == -math.inf  # fmt: skip


@pytest.mark.parametrize(
    ("nodes", "words"),
    [
        ([], "of one at least"),
        (None, "list of nodes"),
        ([at_most(0, 2), leaf()], "lacks nodes"),
        ([at_most(0, 2)], "lacks nodes"),
        ([leaf(), leaf()], "more nodes"),
        ([at_most(0, 2), leaf(), leaf(), leaf()], "more nodes"),
        ([{"kind": "lp-dual"}], "malformed"),
        ([{"data": {}}], "malformed"),
        (["leaf"], "malformed"),
        ([None], "malformed"),
        ([{**leaf(), "children": [0]}], "malformed"),
        ([{"kind": 3, "data": {}}], "malformed"),
        ([{"kind": "lp-dual", "data": []}], "malformed"),
        ([{"kind": "branching-tree", "data": {"nodes": [leaf()]}}], "a tree itself"),
        ([{"kind": "nobody", "data": {}}], "unknown kind of evidence"),
        ([{"branch": None}, leaf(), leaf()], "statement"),
        ([{"branch": {"variable": 0}}, leaf(), leaf()], "statement"),
        ([{"branch": {"variable": 0, "most": 2.5}}, leaf(), leaf()], "statement"),
        ([{"branch": {"variable": 0, "most": True}}, leaf(), leaf()], "statement"),
        ([{"branch": {"variable": 0, "most": 2**60}}, leaf(), leaf()], "statement"),
        ([{"branch": {"variable": 3, "most": 2}}, leaf(), leaf()], "statement"),
        ([{"branch": {"variable": -1, "most": 2}}, leaf(), leaf()], "statement"),
        ([{"branch": {"variable": 0, "most": 2, "least": 4}}, leaf(), leaf()], "statement"),
        ([leaf(duals=[math.nan, 0.0, 0.0])], "finite"),
        ([leaf(duals=[math.inf, 0.0, 0.0])], "finite"),
        ([leaf(duals=[0.0, 0.0])], "length"),
        ([leaf(duals={"at": [0, 0], "values": [1.0, 1.0]})], "twice"),
        ([leaf(duals={"at": [3], "values": [1.0]})], "does not exist"),
        ([leaf(duals={"at": [True], "values": [1.0]})], "does not exist"),
        ([leaf(duals={"at": [1], "values": [1.0, 2.0]})], "of one length"),
        ([leaf(duals={"at": [1], "values": ["1"]})], "numbers"),
    ],
)
def test_what_is_no_tree_is_refused(nodes: Any, words: str) -> None:
    with pytest.raises(WayboundError, match=words):
        verified_bound(knapsack(), Evidence("branching-tree", "", 0.0, {"nodes": nodes}))


def test_a_branching_on_a_variable_that_need_not_be_whole_is_refused() -> None:
    problem = ArrayProblem(_with_continuous())
    with pytest.raises(InputError, match="no integer"):
        bound(problem, at_most(1, 2), leaf(), leaf())


def _with_continuous() -> Any:
    return program([1, 1], [[1, 1]], 1.5, math.inf, 0.0, 9.0, integer=[0])


def test_a_tree_that_is_too_deep_is_refused_before_it_is_walked() -> None:
    chain = list(itertools.chain.from_iterable(((at_most(0, k)),) for k in range(DEEPEST + 1)))
    with pytest.raises(InputError, check=coded("too-large")):
        bound(knapsack(), *chain)


def test_families_without_statements_refuse_trees() -> None:
    shares = BottleneckSATA(random_graph(1, robots=2, targets=2), fractional=True)
    with pytest.raises(InputError, match="nothing can be stated"):
        verified_bound(shares, tree({"branch": {"taken": 0}}, {}, {}))


@pytest.mark.share(2)
@pytest.mark.parametrize("seed", range(draws(150)))
def test_trees_whose_leaves_say_anything_never_prove_more_than_the_optimum(seed: int) -> None:
    problem, rng = random_program(seed), np.random.default_rng(seed)
    best = truth(problem).best
    sign = 1.0 if problem.sense == "min" else -1.0
    whole = np.nonzero(problem.program.integer)[0].tolist()

    def nodes(depth: int) -> list[dict[str, Any]]:
        made: dict[str, Any] = {}
        if rng.random() < 0.8:
            values = (rng.integers(-30, 31, problem.program.num_rows) / 8.0).tolist()
            made = leaf(**{"ray" if rng.random() < 0.3 else "duals": values})
        if not whole or depth == 4 or rng.random() < 0.2:
            return [made]
        column = int(rng.choice(whole))
        return [{**made, **at_most(column, int(rng.integers(-4, 5)))}, *nodes(depth + 1), *nodes(depth + 1)]

    for _ in range(5):
        proved = sign * bound(problem, *nodes(0))
        if best is not None:
            assert proved <= sign * float(best[0]) + 1e-9


@pytest.mark.slow
def test_a_tree_of_another_program_proves_no_more_of_this_one_than_is_true() -> None:
    problems = [p for p in map(random_program, range(60)) if p.program.num_rows == 3 and p.program.integer.all()]
    trees = [e for p in problems if (e := branching_tree_bound(p, Stop(60.0))) is not None]
    pairs = 0
    for problem, evidence in itertools.product(problems, trees):
        best, sign = truth(problem).best, 1.0 if problem.sense == "min" else -1.0
        try:
            proved = sign * verified_bound(problem, evidence)
        except InputError:
            continue
        pairs += 1
        assert best is None or proved <= sign * float(best[0]) + 1e-9
    assert pairs > 20


def test_a_certificate_whose_tree_was_cut_no_longer_holds() -> None:
    problem = knapsack()
    evidence = branching_tree_bound(problem, Stop(60.0))
    assert evidence is not None and evidence.kind == "branching-tree"
    judged = problem.evaluate(np.array([1.0, 0.0, 3.0]))
    made = certify(problem, judged, [evidence])
    assert made.bound == pytest.approx(14.0) and made.gap == 0.0
    data = json.loads(json.dumps(made.to_json(with_evidence=True)))
    check_certificate(problem, data, judged)
    nodes = data["evidence"][0]["data"]["nodes"]
    lost = next(k for k, node in enumerate(nodes) if "branch" not in node)

    def with_nodes(changed: list[dict[str, Any]]) -> dict[str, Any]:
        return {**data, "evidence": [{**data["evidence"][0], "data": {"nodes": changed}}]}

    with pytest.raises(InputError, check=coded("missing")):
        check_certificate(problem, with_nodes(nodes[:lost] + nodes[lost + 1 :]), judged)
    with pytest.raises(CheckFailedError, match="states the bound"):
        check_certificate(problem, with_nodes([*nodes[:lost], {}, *nodes[lost + 1 :]]), judged)
