"""Evidence ``branching-tree``: cases that cover all answers, and evidence for each of them.

A statement about an answer holds or does not. A tree asks one statement after the other, and so sorts every answer into one of its leaves;
what is proved of the problem at each leaf, restricted to the answers that belong there, is proved of the whole::

    bound  =  the worst, over the leaves, of the best bound that evidence at the leaf or above it proves of the problem restricted so

No leaf is trusted, whatever found it: its problem is made of the problem's own data (``Problem.restricted``), and its evidence is read by
the checker of its kind. A tree whose leaves all have no answer proves that there is none.
"""

import math
from collections.abc import Mapping
from typing import Any

from ...instances.errors import InputError
from ...instances.printable import printable
from ..evidence import CHECKERS, Evidence
from ..verified_bounds import verified_bound

KIND = "branching-tree"

DEEPEST = 2_000
"""Statements on a way from the root to a leaf; more are refused, for each is read again at each leaf."""

_KEYS = frozenset({"branch", "kind", "data"})


@CHECKERS.register(KIND)
def check_branching_tree(problem: Any, data: Mapping[str, Any]) -> float:
    """Bound that the leaves of a tree of statements prove together.

    Returns the worst bound of all leaves; infinite with the sign of no proof where a leaf has none at all. Raises InputError if nodes are
    missing or left over, if a statement or a piece of evidence is malformed or a tree itself, or if the tree is too deep.

    Source: Land and Doig (1960), with leaves as in Applegate, Bixby, Chvátal, Cook (2009), "Certification of an optimal TSP tour through
    85,900 cities"; docs/proofs.md#branching-trees.

    Parameters
    ----------
    problem : Problem
        Of a family that restricts its problems.
    data : dict
        ``nodes``: a list of objects, each node before its subtrees. One that branches has ``branch``, a statement in the problem's
        words; the subtree of the answers for which it holds follows, then that of the others. Any node may have ``kind`` and ``data``:
        evidence on the problem restricted so. A leaf without it is open, and is bounded by what stands above it.
    """
    nodes = data["nodes"]
    if not isinstance(nodes, list) or not nodes:
        raise InputError("a branching tree is a list of nodes, of one at least", found=type(nodes).__name__)
    best, worst = (max, min) if problem.sense == "min" else (min, max)
    nothing = -math.inf if problem.sense == "min" else math.inf
    found = -nothing
    waiting: list[tuple[int, Any, bool, float]] = [(0, None, True, nothing)]  # depth, statement, whether it holds, bound above
    path: list[tuple[Any, bool]] = []
    for node in nodes:
        if not waiting:
            raise InputError("the branching tree has more nodes than its branchings lead to", "wrong-shape", found=f"{len(nodes)} nodes")
        depth, statement, holds, bound = waiting.pop()
        del path[max(0, depth - 1) :]
        if depth:
            path.append((statement, holds))
        if not isinstance(node, Mapping) or not _KEYS.issuperset(node) or ("kind" in node) != ("data" in node):
            raise InputError("a node of a branching tree is malformed", expected="branch, or kind and data, or both", found=_told(node))
        if "kind" in node:
            bound = best(bound, _proved(problem, path, node))
        if "branch" not in node:
            found = worst(found, bound)
            continue
        if depth == DEEPEST:
            raise InputError("the branching tree is too deep", "too-large", expected=f"at most {DEEPEST} branchings on a way")
        problem.check_statement(node["branch"])
        waiting.append((depth + 1, node["branch"], False, bound))
        waiting.append((depth + 1, node["branch"], True, bound))
    if waiting:
        raise InputError("the branching tree lacks nodes", "missing", expected=f"{len(waiting)} subtrees more")
    return found


def _proved(problem: Any, path: list[tuple[Any, bool]], node: Mapping[str, Any]) -> float:
    """Bound that the evidence at a node proves of the problem restricted by the statements above it; no number is no proof."""
    kind, data = node["kind"], node["data"]
    if not isinstance(kind, str) or kind == KIND or not isinstance(data, Mapping):
        raise InputError("evidence in a branching tree is malformed, or a tree itself", found=_told(node))
    bound = verified_bound(problem.restricted(path) if path else problem, Evidence(kind, "", 0.0, dict(data)))
    return (-math.inf if problem.sense == "min" else math.inf) if math.isnan(bound) else bound


def _told(node: object) -> str:
    return printable(str(node), 80)
