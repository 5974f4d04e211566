"""Trees that grow: what they drop, and that a branching for which there was no time leaves nothing behind."""

import math

import pytest
from branching_programs import hard, knapsack, random_program
from patience import HANG
from truth.families import truth

from waybound import Evidence, Problem
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.bounds import proof_tree
from waybound.solvers.bounds.branching_tree import branching_tree_bound
from waybound.solvers.bounds.proof_tree import Node, ProofTree


class Halves(ProofTree[Node]):
    """Branches on the first variable of a problem, and has time for a number of nodes only."""

    def __init__(self, problem: Problem, nodes: int) -> None:
        super().__init__(problem, Node(None), None, Stop(60.0))
        self.left = nodes

    def look(self, node: Node) -> bool:
        self.left -= 1
        if self.left < 0:
            return False
        self.begin(node)
        self.prove(node, self.restricted(node), [Evidence("lp-dual", "", 0.0, {"duals": [0.5, 1.0, 0.0]})])
        if len(node.decisions()) < 3:
            self.wait(node)
        else:
            self.close(node)
        return True

    def branch(self, node: Node) -> bool:
        return self.divide(node, {"variable": 0, "most": 2 * len(node.decisions())})


@pytest.mark.parametrize("nodes", range(16))
def test_a_tree_that_ends_anywhere_hands_over_what_its_leaves_prove(nodes: int) -> None:
    tree = Halves(knapsack(), nodes)
    tree.grow()
    evidence = tree.evidence("halves")
    if nodes == 0:
        assert evidence is None and tree.bound == -math.inf
        return
    assert evidence is not None and evidence.value == -tree.bound
    assert verified_bound(knapsack(), evidence) == evidence.value >= 14.0
    # A node whose second child had no time is open once more, and neither child is.
    children = sum(2 for node in tree.nodes if node.children)
    assert len(tree.open) + sum(not n.children and len(n.decisions()) == 3 for n in _kept(tree)) == children / 2 + 1


def _kept(tree: Halves) -> list[Node]:
    return [n for n in tree.nodes if n.parent is None or n in n.parent.children]


def test_it_ends_where_its_evidence_outgrows_the_memory_that_it_may_take(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(proof_tree, "MOST_NUMBERS", 500)
    stop = Stop(HANG)
    evidence = branching_tree_bound(hard(), stop)
    assert not stop.reached()
    assert evidence is not None and math.isfinite(verified_bound(hard(), evidence))


@pytest.mark.slow
def test_evidence_that_no_leaf_can_need_is_dropped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(proof_tree, "SWEEP", 4)
    for seed in range(40):
        problem = random_program(seed)
        known = truth(problem).best
        evidence = branching_tree_bound(problem, Stop(30.0))
        if known is not None and evidence is not None:
            assert verified_bound(problem, evidence) == pytest.approx(float(known[0]), rel=1e-9, abs=1e-9)


def test_the_size_of_evidence_counts_the_numbers_in_lists_of_lists_and_of_objects() -> None:
    assert proof_tree._size({"visits": [1.0, 2.0], "remembered": [[], [1, 2], [3]], "rows": [{"sites": [1, 2, 3], "price": -1.0}]}) == 9
