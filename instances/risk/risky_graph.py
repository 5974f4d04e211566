"""Graphs whose states and moves carry risk, as a file gives them."""

import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import number_arrays as arrays
from ..declared import Declared, NameOf, Names
from ..document import array, json_number, json_numbers, kind_of, matrix, real, string, wholes
from ..errors import InputError
from ..instance import digest
from ..number_arrays import Floats
from ..parts import Axis, Count, Numbers, Whole, Wholes
from ..text import shown
from .element import RiskElement, TraverseElement
from .element_files import read_element, written_element
from .obstacles import boxes_of

if TYPE_CHECKING:
    import networkx as nx

Indices = NDArray[np.integer[Any]]

OBJECTIVES = ("risk", "hazard", "reward-per-risk")
LARGEST_FLOAT = sys.float_info.max


@dataclass(frozen=True, eq=False, repr=False)
class RiskyGraph(Declared):
    """States, moves between them, and what puts a path at risk.

    Parameters
    ----------
    num_states : int
        States are numbered from 0.
    tail, head : array-like of int, shape (arcs,)
        Moves, in any order, none twice, none from a state to itself.
    elements : sequence of RiskElement
        What puts a path at risk; each looks at a state, at three in a row, or at the whole path.
    start : int
        The first state; its risk counts.
    conditional : bool
        Whether risks are given as probabilities under the condition that nothing failed before, whose product is exact; else the product
        holds for independent failures only, and answers are told so.
    goals : sequence of int
        Where a path may end; none stands for anywhere, the start alone included.
    rewards : array-like, shape (states,), optional
        Not negative; 0 by default.
    discount : float
        In [0, 1]: what a reward keeps at each move that follows; 0 counts that of the last state alone.
    objective : str
        ``risk``, ``hazard`` or ``reward-per-risk``; by default the last where there are rewards and no goals, else the first.
    positions : array-like, shape (states, 2) or (states, 3), optional
        For pictures.
    obstacles : array-like, shape (boxes, 4) or (boxes, 6)
        For pictures.
    state_names : sequence of str, optional
        None stands for "1", "2", ...
    name, format, problem, problems, notes
        See ``Instance``.
    """

    kind = "risky-graph"
    problem_names = ("risky-path",)
    content = "graphs with risk"
    lists_problems = True
    axes = (Axis("state", positions="positions", dimensions=3), Axis("move", least=0, counted=False))
    keys = ("states", "moves", "start", "goals", "objective", "discount", "conditional", "elements", "obstacles")
    own_keys = ("conditional", "elements")
    num_states: Annotated[int, Count("state")]
    tail: Annotated[Indices, Wholes("move", "state", "tail of move {}")]
    head: Annotated[Indices, Wholes("move", "state", "head of move {}")]
    elements: tuple[RiskElement, ...]
    start: Annotated[int, Whole(0, "state")]
    conditional: bool
    goals: tuple[int, ...] = ()
    rewards: Annotated[Floats | None, Numbers("state", high=LARGEST_FLOAT, default=0.0, key="reward", what="reward")] = None
    discount: float = 1.0
    objective: str = ""
    positions: Floats | None = None
    obstacles: Floats | None = None
    state_names: Names = None
    state_name = NameOf("state")

    def refuse_counts(self) -> None:
        super().refuse_counts()
        arrays.refuse_unused("states", self.num_states, len(self.tail), "moves")

    def check_rest(self) -> None:
        n = self.num_states
        self._order_moves()
        if not isinstance(self.conditional, bool):
            raise InputError("it must be said whether risks are conditional, true or false", found=shown(str(self.conditional)))
        goals = tuple(dict.fromkeys(arrays.whole_numbers("goals", self.goals).tolist()))
        outside = next((goal for goal in goals if not 0 <= goal < n), None)
        if outside is not None:
            raise InputError("the goal must be a state", "unknown-name", expected=f"0 to {n - 1}", found=shown(str(outside)))
        rewards = np.asarray(self.rewards)
        arrays.refuse_overflow("rewards", rewards)
        if isinstance(self.discount, bool) or not isinstance(self.discount, int | float) or not 0.0 <= self.discount <= 1.0:
            raise InputError("the discount must lie in [0, 1]", "out-of-range", found=shown(str(self.discount)))
        self.put(goals=goals, objective=self.objective or ("reward-per-risk" if rewards.any() and not goals else "risk"))
        if self.objective not in OBJECTIVES:
            raise InputError("the objective is unknown", "unknown-name", expected=", ".join(OBJECTIVES), found=shown(self.objective))
        if self.obstacles is not None:
            boxes = boxes_of(self.obstacles)
            self.put(obstacles=boxes.reshape(len(boxes), -1) if len(boxes) else None)
        self.put(elements=tuple(self.elements))
        labels: set[str] = set()
        for element in self.elements:
            if not isinstance(element, RiskElement):
                raise InputError("elements must be risk elements", found=type(element).__name__)
            if element.label in labels or labels.add(element.label):  # type: ignore[func-returns-value]
                raise InputError(f"two risk elements are labelled {shown(element.label)}", "duplicate", expected="different labels")
            element.check(self)
        if not self.conditional:
            warning = "risks are not conditional: their product is the risk of a path if failures are independent; their sum is safe anyway"
            self.put(notes=tuple(dict.fromkeys((*self.notes, warning))))

    def _order_moves(self) -> None:
        tail, head = self.tail, self.head
        if (tail == head).any():
            raise InputError(f"move {int(np.argmax(tail == head))} leads from a state to itself", "contradiction")
        order = np.lexsort([head, tail])
        tail, head = tail[order], head[order]
        twice = np.nonzero((np.diff(tail) == 0) & (np.diff(head) == 0))[0]
        if len(twice):
            raise InputError(f"two moves lead from state {tail[twice[0]]} to state {head[twice[0]]}", "duplicate")
        self.put(tail=tail.astype(np.int32), head=head.astype(np.int32))

    @classmethod
    def from_networkx(
        cls, graph: "nx.DiGraph", elements: Iterable[RiskElement], start: Any, *, conditional: bool, goals: Iterable[Any] = (),
        reward: str = "reward", position: str = "pos", **further: Any,
    ) -> "RiskyGraph":  # fmt: skip
        """An instance from a networkx graph, directed or not; states are its nodes in their order.

        Parameters
        ----------
        graph : networkx.Graph or DiGraph
            Nodes are states, edges moves, undirected ones both ways.
        elements, start, conditional, goals
            See the class; ``start`` and ``goals`` are nodes.
        reward, position : str
            Attributes of nodes, used where they are there.
        **further
            As of the class.
        """
        nodes = list(graph)
        index = {node: k for k, node in enumerate(nodes)}
        for node in (start, *goals):
            if node not in index:
                raise InputError("the graph has no such node", "unknown-name", found=shown(str(node)))
        ends = [(index[a], index[b]) for a, b in graph.edges]
        if not graph.is_directed():
            ends += [(b, a) for a, b in ends]
        tail, head = np.array(ends, dtype=np.int64).reshape(-1, 2).T
        points = [data.get(position) for _, data in graph.nodes(data=True)]
        return cls(
            len(nodes), tail, head, tuple(elements), index[start], conditional, tuple(index[g] for g in goals),
            np.array([data.get(reward, 0.0) for _, data in graph.nodes(data=True)]),
            positions=None if None in points else np.array(points, dtype=np.float64),
            state_names=tuple(map(str, nodes)), **further,
        )  # fmt: skip

    @cached_property
    def indptr(self) -> Indices:
        """First move out of each state, shape (states + 1,)."""
        return arrays.row_starts(self.tail, self.num_states).astype(np.int32)

    def neighbours(self, state: int) -> list[int]:
        """States that a move leads to."""
        states: list[int] = self.head[self.indptr[state] : self.indptr[state + 1]].tolist()
        return states

    @property
    def traverse(self) -> tuple[TraverseElement, ...]:
        """Elements that depend on the whole path."""
        return tuple(e for e in self.elements if isinstance(e, TraverseElement))

    def least_risks(self, element: RiskElement, before: ArrayLike, state: ArrayLike, after: ArrayLike) -> Floats:
        """``element.least``, refused where it is no probability.

        Parameters
        ----------
        element : RiskElement
            One of ``elements``.
        before, state, after : array-like of int, shape (moves,)
            States; -1 stands for none.
        """
        b, s, a = (np.asarray(x, dtype=np.int64) for x in (before, state, after))
        risk = np.asarray(element.least(self, b, s, a), dtype=np.float64)
        wrong = ~((risk >= 0.0) & (risk <= 1.0))
        if wrong.any():
            k = int(np.argmax(wrong))
            where = " ".join(self.state_name(x) for x in (int(b[k]), int(s[k]), int(a[k])) if x >= 0)
            raise InputError(f"the risk of {element.label} must lie in [0, 1]", "out-of-range", found=f"{risk[k]:g} at {where}")
        return risk

    def digest(self) -> str:
        """Hash of everything that values depend on."""
        of_elements = [part for element in self.elements for part in ("element", *element.parts())]
        return digest(
            self.kind, self.num_states, self.tail, self.head, self.start, self.conditional, self.goals, self.rewards, self.discount,
            self.objective, "" if self.positions is None else self.positions, *of_elements,
        )  # fmt: skip

    def summary(self) -> Iterable[str]:
        labels = ", ".join(element.label for element in self.elements) or "nothing"
        return (*super().summary(), f"risk of {labels}")

    def write_own(self) -> dict[str, Any]:
        data: dict[str, Any] = {
            "goals": list(self.goals), "objective": self.objective, "discount": json_number(self.discount),
            "conditional": self.conditional, "elements": [written_element(element) for element in self.elements],
        }  # fmt: skip
        return data if self.obstacles is None else {**data, "obstacles": json_numbers(self.obstacles)}

    @classmethod
    def read_own(cls, data: Mapping[str, Any], counts: Mapping[str, int]) -> dict[str, Any]:
        if not isinstance(data["conditional"], bool):
            raise InputError("conditional must be true or false", found=kind_of(data["conditional"]))
        elements = enumerate(array(data["elements"], "elements"))
        return {
            "conditional": data["conditional"], "goals": tuple(wholes(data.get("goals", []), "goals").tolist()),
            "elements": tuple(read_element(item, f"elements[{k}]", counts["state"]) for k, item in elements),
            "discount": real(data.get("discount", 1), "discount"),
            "objective": string(data["objective"], "objective") if "objective" in data else "",
            "obstacles": matrix(data["obstacles"], "obstacles") if "obstacles" in data else None,
        }  # fmt: skip


def named_states(names: Sequence[str], chosen: Iterable[str], what: str) -> tuple[int, ...]:
    """The indices of states by name; raises InputError for one that does not exist."""
    index: Mapping[str, int] = {name: k for k, name in enumerate(names)}
    states = []
    for name in chosen:
        if name not in index:
            raise InputError(f"the {what} {shown(name)} is no state", "unknown-name")
        states.append(index[name])
    return tuple(states)
