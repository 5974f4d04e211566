"""Circuits: binary columns tell which arcs of a graph are used, and used arcs make up closed walks."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...instances.number_arrays import Floats

Indices = NDArray[np.integer[Any]]


@dataclass(frozen=True, eq=False)
class Circuit:
    """One circuit, or ``several`` that have node 0 in common and nothing else.

    Every node is entered once and left once; by its own loop where it is not on the circuit. With ``several`` there are no loops, and node
    0 is left as often as it is entered, however often that is.

    Parameters
    ----------
    name : str
    nodes : int
        They are numbered from 0.
    tail, head : arrays of shape (arcs,)
        Nodes that each arc leaves and enters; no arc twice.
    column : array of shape (arcs,)
        The binary variable of the program that is 1 where the arc is used.
    several : bool
    """

    name: str
    nodes: int
    tail: Indices
    head: Indices
    column: Indices
    several: bool = False

    def excess(self, x: Floats) -> float:
        """Largest violation by the vector ``x`` of the balance of a node, or 1 for a second circuit; 0 where nothing is broken."""
        flow = x[self.column]
        leaving, entering = (np.bincount(end, flow, minlength=self.nodes) for end in (self.tail, self.head))
        asked = np.where(np.arange(self.nodes) < self.several, leaving, 1.0)
        worst = float(np.abs([leaving - asked, entering - asked]).max(initial=0.0))
        return max(1.0, worst) if np.isnan(worst) or self._apart(flow > 0.5) else worst

    def _apart(self, used: NDArray[np.bool_]) -> bool:
        """True if the used arcs other than loops fall apart, with ``several`` from node 0."""
        import scipy.sparse as sp
        from scipy.sparse.csgraph import connected_components

        used = used & (self.tail != self.head)
        tail, head = self.tail[used], self.head[used]
        part = connected_components(sp.coo_matrix((np.ones(len(tail)), (tail, head)), shape=(self.nodes, self.nodes)), directed=False)[1]
        return bool((part[tail] != (part[0] if self.several else part[tail[:1]])).any())

    def fault(self, lower: Floats, upper: Floats, integer: NDArray[np.bool_]) -> str:
        """A fault of the arrays in a program of these bounds and integrality; empty if they are sound."""
        tail, head, column = self.tail, self.head, self.column
        if self.nodes < 1 or not len(tail) == len(head) == len(column):
            return "there are no nodes, or the arrays have different lengths"
        if not len(tail):
            return ""
        ends = np.concatenate([tail, head])
        if ends.min() < 0 or ends.max() >= self.nodes:
            return f"an arc names a node that does not exist; nodes are 0 to {self.nodes - 1}"
        if self.several and (tail == head).any():
            return "several circuits leave out no node, so that there are no loops"
        if len(np.unique(tail.astype(np.int64) * self.nodes + head)) < len(tail):
            return "an arc stands there twice"
        if column.min() < 0 or column.max() >= len(lower):
            return f"an arc names a column that does not exist; columns are 0 to {len(lower) - 1}"
        if not (integer[column] & (lower[column] >= 0) & (upper[column] <= 1)).all():
            return "the column of an arc is not binary"
        return ""

    def parts(self) -> tuple[Any, ...]:
        """Data that a digest covers."""
        return (self.nodes, self.tail, self.head, self.column, self.several)
