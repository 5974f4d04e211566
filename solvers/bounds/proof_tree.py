"""Trees that grow node by node until what their leaves prove reaches a target, whatever the nodes are proved by."""

import heapq
import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from ...formulations.evidence import Evidence
from ...formulations.problem import Decision, Problem
from ...formulations.stop import Stop, until
from ...formulations.tolerance import same
from ...formulations.verified_bounds import verified_bound
from ...instances.errors import InputError

MOST_NUMBERS = 4_000_000
"""In the evidence of all nodes together, some 200 megabytes: then the tree is handed over as it is."""

ROOT = 0.5
"""Share of the budget within which the root must usually be solved; else no tree of it would be worth having."""

SWEEP = 256
"""Nodes after which evidence that no leaf can need any more is dropped."""


@dataclass(eq=False)
class Node:
    """A node; bounds are those of a minimisation.

    It adds ``decision`` to the decisions of its parent; its ``evidence`` proves ``own``, and ``bound`` is the best of its own and those
    above it. Of its children that comes first for which its statement holds.
    """

    parent: "Node | None"
    decision: Decision | None = None
    bound: float = -math.inf
    evidence: Evidence | None = None
    own: float = -math.inf
    children: "tuple[Node, ...]" = ()

    def above(self) -> Iterator[Any]:
        """The node and all above it but the root, upwards."""
        node = self
        while node.parent is not None:
            yield node
            node = node.parent

    def decisions(self) -> list[Decision]:
        """The branchings from the root to this node."""
        return [n.decision for n in self.above() if n.decision is not None][::-1]


N = TypeVar("N", bound=Node)


class ProofTree(ABC, Generic[N]):
    """Best bound first.

    ``target``: value of a known answer. ``share``: part of the time for the root.
    """

    def __init__(self, problem: Problem, root: N, target: float | None, stop: Stop, share: float = ROOT) -> None:
        self.problem, self.stop, self.root, self.share = problem, stop, root, share
        self.sign = 1.0 if problem.sense == "min" else -1.0
        self.target = math.inf if target is None else self.sign * target
        self.nodes: list[N] = []
        self.open: list[tuple[float, int, N]] = []
        self.closed = math.inf
        self.numbers = 0
        self.count = itertools.count()

    @abstractmethod
    def look(self, node: N) -> bool:
        """Solve and prove a node, and ``close`` it or let it ``wait``; False where there was no time for it."""

    @abstractmethod
    def branch(self, node: N) -> bool:
        """Give a node two children by ``look_at_all`` or ``divide``; False where there was no time for both."""

    def release(self, node: N) -> None:
        """Drop what only branching on the node needed."""

    def grow(self) -> None:
        """Branch until nothing is open."""
        whole, self.stop = self.stop, self.stop.within(self.share * self.stop.seconds_left)
        if not self.look(self.root):
            self.closed = -math.inf
        self.stop = whole
        while self.open and not self.full and not self.stop.reached():
            if self.reached(self.open[0][0]):  # by an answer that was found later
                break
            node = heapq.heappop(self.open)[-1]
            if not self.branch(node):
                self.wait(node)
                break
            self.release(node)

    @property
    def full(self) -> bool:
        """Whether it is handed over as it is, because it holds so much."""
        return self.numbers > MOST_NUMBERS

    @property
    def bound(self) -> float:
        """The bound that the tree proves."""
        return min(self.closed, self.open[0][0] if self.open else math.inf)

    def wait(self, node: N) -> None:
        heapq.heappush(self.open, (node.bound, next(self.count), node))

    def close(self, node: N) -> None:
        self.closed = min(self.closed, node.bound)

    def reached(self, bound: float) -> bool:
        return bound >= self.target or same(bound, self.target)

    def begin(self, node: N) -> None:
        """Take a node in, with what is proved above it."""
        self.nodes.append(node)
        if len(self.nodes) % SWEEP == 0:
            self._sweep()
        if node.parent is not None:
            node.bound = node.parent.bound

    def look_at_all(self, node: N, children: tuple[N, ...]) -> Iterator[N]:
        """Look at children one after the other; where there is no time for one, none is left, and the iteration ends early."""
        before, count = self.closed, len(self.open)
        for child in children:
            if not self.look(child):
                self.closed = before
                if len(self.open) > count:
                    self.open = [entry for entry in self.open if entry[-1].parent is not node]
                    heapq.heapify(self.open)
                return
            yield child

    def divide(self, node: N, statement: Any) -> bool:
        """Give a node two children, by whether a statement holds; False where there was no time for both."""
        children = type(node)(node, (statement, True)), type(node)(node, (statement, False))
        if sum(1 for _ in self.look_at_all(node, children)) < 2:
            return False
        node.children = children
        return True

    def restricted(self, node: N) -> Problem:
        """The problem that a node is about."""
        path = node.decisions()
        return self.problem.restricted(path) if path else self.problem

    def prove(self, node: N, problem: Problem, found: Iterable[Evidence]) -> float:
        """Keep the evidence that proves most of ``problem``, that of the node; returns the most that any of it proves."""
        most = -math.inf
        for evidence in found:
            for given in _shortened(evidence):
                bound = self._verified(problem, given)
                most = max(most, bound)
                if bound > node.own:
                    node.own, node.evidence = bound, given
                if self.reached(bound) or given is evidence:
                    break
            if self.reached(node.own):
                break
        if node.evidence is not None:
            self.numbers += _size(node.evidence.data)
        node.bound = max(node.bound, node.own)
        return most

    def _verified(self, problem: Problem, evidence: Evidence) -> float:
        try:
            with until(self.stop):
                bound = self.sign * verified_bound(problem, evidence)
        except (InputError, MemoryError):
            return -math.inf
        return -math.inf if math.isnan(bound) else bound

    def _sweep(self) -> None:
        """Drop the evidence of nodes that can be no leaf of what is handed over."""
        least, kept = self.bound, []
        for node in self.nodes:
            if node.children and node.bound < least:
                if node.evidence is not None:
                    self.numbers -= _size(node.evidence.data)
                    node.evidence, node.own = None, -math.inf
            else:
                kept.append(node)
        self.nodes = kept

    def evidence(self, over: str) -> Evidence | None:
        """The smallest tree that proves the bound, and says that it branched ``over`` something; None where nothing is proved."""
        bound = self.bound
        if bound == -math.inf:
            return None
        listed, leaves = [], 0
        waiting: list[Node] = [self.root]
        while waiting:
            node = waiting.pop()
            entry: dict[str, Any] = {}
            if node.own >= bound and node.evidence is not None:
                entry = {"kind": node.evidence.kind, "data": node.evidence.data}
                leaves += 1
                if node is self.root:
                    return Evidence(node.evidence.kind, node.evidence.source, self.sign * bound, node.evidence.data)
            elif node.children:
                first = node.children[0]
                assert first.decision is not None
                entry = {"branch": first.decision[0]}
                waiting.extend(reversed(node.children))
            listed.append(entry)
        source = f"branch and bound over {over}, {leaves} leaves, each with evidence of its own"
        return Evidence("branching-tree", source, self.sign * bound, {"nodes": listed})


def _shortened(evidence: Evidence) -> Iterator[Evidence]:
    """Evidence with numbers of few digits and without its zeros, which may prove as much; then the evidence itself."""
    short = _short(evidence.data)
    if short != evidence.data:
        yield Evidence(evidence.kind, evidence.source, evidence.value, short)
    yield evidence


def _short(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _short(value) for key, value in data.items()}
    if not isinstance(data, list) or len(data) < 2 or not all(type(v) is float for v in data):
        return data
    given = np.array(data)
    largest = float(np.abs(given).max())
    if not 0.0 < largest < math.inf:
        return {"at": [], "values": []} if largest == 0.0 else data
    values = np.round(given, 9 - math.floor(math.log10(largest))) if 1e-200 < largest < 1e200 else given
    used = np.nonzero(values)[0]
    if 2 * len(used) > len(values):
        return values.tolist()
    return {"at": used.tolist(), "values": values[used].tolist()}


def _size(data: Any) -> int:
    """The number of numbers in the data of evidence."""
    if isinstance(data, dict):
        return sum(map(_size, data.values()))
    if not isinstance(data, list):
        return 1
    return sum(map(_size, data)) if data and isinstance(data[0], dict | list) else len(data)
