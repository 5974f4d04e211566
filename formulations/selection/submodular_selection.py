"""Selection problems: choose elements of a ground set so that a set function is largest."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...instances.errors import InputError, UsageError
from ...instances.instance import digest
from ...instances.selection.instance import (
    Cardinality,
    Constraint,
    Coverage,
    DenseFacilityLocation,
    FacilityLocation,
    Knapsack,
    PartitionMatroid,
    SelectionInstance,
    SetFunction,
    check_selection,
)
from ...instances.sensing.graph import SensingGraph
from ..evaluation import Check, Evaluation, Violation, judge
from ..problem import PROBLEMS, Problem
from ..tolerance import EQUAL, room
from .assignments import graph_for
from .selections import Selection, entries_of, judge_elements, selection_of

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class UserFunction:
    """A set function of the user's own, evaluated for many sets at once.

    Parameters
    ----------
    evaluate : callable
        From a boolean array of shape (sets, elements) to the values, shape (sets,).
    num_elements : int
    monotone, submodular : bool
        What the user declares; guarantees and bounds rest on it and say so. ``check_submodular`` samples it.
    label : str
        What names the function, for the digest of the problem.
    """

    name: ClassVar[str] = "user"
    evaluate: Callable[[NDArray[np.bool_]], ArrayLike]
    num_elements: int
    monotone: bool = False
    submodular: bool = False
    label: str = "user function"

    def values(self, masks: NDArray[np.bool_]) -> Floats:
        """Values of the sets given by the rows of ``masks``.

        Raises
        ------
        InputError
            If the function returns anything but one finite number a set.
        """
        returned = self.evaluate(masks)
        try:
            found = np.asarray(returned, dtype=np.float64)
        except (TypeError, ValueError):
            kind = type(returned).__name__
            raise InputError(f"the set function {self.label} must return numbers", expected=f"({len(masks)},)", found=kind) from None
        if found.shape != (len(masks),):
            raise InputError(
                f"the set function {self.label} must return one number a set", expected=f"({len(masks)},)", found=str(found.shape)
            )
        if not np.isfinite(found).all():
            raise InputError(f"the set function {self.label} must return finite numbers", found=str(found[~np.isfinite(found)][0]))
        return found

    def facts(self) -> dict[str, Any]:
        """Kind and size, as plain JSON values."""
        return {"kind": self.name, "elements": self.num_elements}

    def parts(self) -> tuple[Any, ...]:
        """What the digest covers: the function itself cannot be hashed."""
        return (self.name, self.label, self.num_elements, self.monotone, self.submodular)


class SubmodularSelection(Problem):
    """Maximise f(S) over the sets S that a constraint allows.

    Parameters
    ----------
    function : Coverage, FacilityLocation, DenseFacilityLocation or UserFunction
    constraint : Cardinality, PartitionMatroid or Knapsack
    element_names : sequence of str, optional
        None stands for "1", "2", ...
    name, problem, notes
        See ``Problem``.

    Raises
    ------
    InputError
        If function and constraint do not fit each other, or the empty set's value is not 0.
    """

    family: ClassVar[str] = "selection"

    def __init__(
        self,
        function: SetFunction | UserFunction,
        constraint: Constraint,
        *,
        element_names: tuple[str, ...] | None = None,
        name: str = "selection",
        problem: str = "selection",
        notes: tuple[str, ...] = (),
    ) -> None:
        check_selection(function.num_elements, constraint, element_names)
        self.function, self.constraint, self.element_names = function, constraint, element_names
        self.name, self.problem, self.notes = name, problem, notes
        if isinstance(function, UserFunction):
            ends = np.zeros((2, function.num_elements), dtype=bool)
            ends[1] = True
            empty, everything = function.values(ends).tolist()
            if abs(empty) > EQUAL * abs(everything):
                raise InputError("the empty set must have value 0; subtract its value from the function", found=str(empty))

    @property
    def num_elements(self) -> int:
        return self.function.num_elements

    def element_name(self, element: int) -> str:
        return str(element + 1) if self.element_names is None else self.element_names[element]

    @property
    def senses(self) -> tuple[str, ...]:
        return ("max",)

    @property
    def convention(self) -> str:
        return "exact"

    def digest(self) -> str:
        return digest("selection", *self.function.parts(), *self.constraint.parts())

    def features(self) -> frozenset[str]:
        """``function:coverage``, ``function:facility-location`` or ``function:user``, and ``constraint:cardinality``,
        ``constraint:partition`` or ``constraint:knapsack``."""
        return frozenset({f"function:{self.function.name}", f"constraint:{self.constraint.name}"})

    def facts(self) -> dict[str, Any]:
        """Function and constraint."""
        return {"function": self.function.facts(), "constraint": self.constraint.facts()}

    def value(self, elements: ArrayLike) -> float:
        """f of a set of elements, from the data."""
        chosen = np.unique(np.asarray(elements, dtype=np.int64))
        f = self.function
        if isinstance(f, UserFunction):
            mask = np.zeros((1, f.num_elements), dtype=bool)
            mask[0, chosen] = True
            return float(f.values(mask)[0])
        if not len(chosen):
            return 0.0
        if isinstance(f, DenseFacilityLocation):
            return math.fsum(f.matrix[chosen].max(axis=0, initial=0.0).astype(np.float64))
        return math.fsum(self._best(chosen))

    def _best(self, chosen: NDArray[np.int64]) -> Floats:
        f = self.function
        assert isinstance(f, Coverage | FacilityLocation)
        best, entries = np.zeros(f.num_items), entries_of(f.indptr, chosen)
        at = f.indices[entries]
        np.maximum.at(best, at, f.item_weights[at] if isinstance(f, Coverage) else f.weights[entries])
        return best

    def gains(self, elements: Sequence[int]) -> Floats:
        """What each element adds to the value of those before it, shape (elements,)."""
        f, added = self.function, np.zeros(len(elements))
        if isinstance(f, UserFunction):
            mask, value = np.zeros((1, f.num_elements), dtype=bool), 0.0
            for k, element in enumerate(elements):
                mask[0, element] = True
                after = float(f.values(mask)[0])
                added[k], value = after - value, after
            return added
        best = np.zeros(f.num_items)
        for k, element in enumerate(elements):
            at: Any = slice(None)
            if isinstance(f, DenseFacilityLocation):
                given = f.matrix[element].astype(np.float64)
            else:
                entries = slice(f.indptr[element], f.indptr[element + 1])
                at = f.indices[entries]
                given = f.item_weights[at] if isinstance(f, Coverage) else f.weights[entries]
            more = np.maximum(given, best[at])
            added[k] = math.fsum(more - best[at])
            best[at] = more
        return added

    def evaluate(self, answer: Any) -> Evaluation:
        """Recompute the value, and test that the elements exist, none twice, and that the constraint holds."""
        if not isinstance(answer, Selection):
            raise UsageError(
                f"an answer to a selection problem is a Selection, not {type(answer).__name__}: Selection.of([0, 3]) makes one"
            )
        chosen, (elements, faults) = judge_elements(answer, self.num_elements, "elements", "element", self.element_name)
        rule, broken = self._judge_constraint(chosen)
        quantities = {"elements": float(len(chosen))}
        return Evaluation((self.value(chosen),), (elements, rule), (*faults, *broken), quantities)

    def _constraint_name(self) -> str:
        return self.constraint.name

    def _judge_constraint(self, chosen: NDArray[np.int64]) -> tuple[Check, list[Violation]]:
        c, name = self.constraint, self._constraint_name()
        if isinstance(c, Cardinality):
            message = f"{len(chosen)} elements are chosen, at most {c.limit} are allowed"
            return judge(name, np.array([float(len(chosen) - c.limit)]), lambda _: message)
        if isinstance(c, Knapsack):
            cost = math.fsum(c.costs[chosen])
            message = f"the chosen elements cost {cost:.12g}, the budget is {c.budget:.12g}"
            return judge(name, np.array([cost - c.budget]), lambda _: message, room(c.costs, c.budget) - c.budget)
        used, counts = np.unique(c.groups[chosen], return_counts=True)
        return judge(
            name, counts.astype(np.float64) - c.limits[used],
            lambda k: f"{counts[k]} elements of {self._group_name(int(used[k]))} are chosen, {c.limits[used[k]]} allowed",
        )  # fmt: skip

    def _group_name(self, group: int) -> str:
        return f"group {group + 1}"

    # -- answers as files and tables ---------------------------------------------------------------------------------

    def answer_to_json(self, answer: Selection) -> dict[str, Any]:
        return {"kind": "selection", "elements": [self.element_name(e) for e in answer.elements]}

    def answer_from_json(self, data: Any) -> Selection:
        if not isinstance(data, Mapping) or data.get("kind") != "selection" or not isinstance(data.get("elements"), list):
            raise InputError("not an answer to a selection problem", expected='an object {"kind": "selection", "elements": [...]}')
        index = {self.element_name(e): e for e in range(self.num_elements)}
        for entry in data["elements"]:
            if str(entry) not in index:
                raise InputError(f"the answer chooses an unknown element {str(entry)[:80]!r}")
        return Selection(tuple(index[str(e)] for e in data["elements"]))

    def answer_of(self, given: Any) -> Selection:
        """A ``Selection``, or a list of element indices or names."""
        return selection_of(given, lambda: {self.element_name(e): e for e in range(self.num_elements)}, "element")

    def answer_to_frame(self, answer: Selection) -> pd.DataFrame:
        """One row an element, as the answer lists them: element, gain, value after it."""
        import pandas as pd

        gains = self.gains(answer.elements)
        return pd.DataFrame({"element": [self.element_name(e) for e in answer.elements], "gain": gains, "value": np.cumsum(gains)})

    def __repr__(self) -> str:
        return f"<SubmodularSelection {self.name}: {self.num_elements} elements, {self.function.name}, {self.constraint.name} constraint>"


def from_sensing(graph: SensingGraph, settings: dict[str, Any]) -> SubmodularSelection:
    """Actions as elements. Settings: ``function`` (``facility-location`` or ``coverage`` of targets), ``constraint`` (``partition``:
    one action a robot, or ``cardinality`` with ``k``)."""
    refuse_settings("selection", settings, ("function", "constraint", "k"))
    function, constraint, k = settings.get("function", "facility-location"), settings.get("constraint"), settings.get("k")
    if function not in ("facility-location", "coverage"):
        raise UsageError(f"function must be facility-location or coverage, not {function!r}")
    constraint = constraint or ("partition" if k is None else "cardinality")
    if constraint not in ("partition", "cardinality") or (constraint == "cardinality") != (k is not None):
        raise UsageError("constraint must be partition (one action a robot), or cardinality with k=NUMBER")
    chosen: SetFunction = FacilityLocation(graph.indptr, graph.indices, graph.weights, graph.num_targets)
    if function == "coverage":
        chosen = Coverage(graph.indptr, graph.indices, np.ones(graph.num_targets))
    rule: Constraint = PartitionMatroid.of(graph.robot_of_action, np.ones(graph.num_robots, dtype=np.int32))
    if k is not None:
        try:
            rule = Cardinality(int(str(k)))
        except (ValueError, InputError):
            raise UsageError(f"k must be a whole number of at least 1, not {k!r}") from None
    return SubmodularSelection(chosen, rule, element_names=graph.action_labels, name=graph.name, notes=graph.notes)


@PROBLEMS.register("selection")
def _build(instance: Any, problem: str, settings: dict[str, Any]) -> SubmodularSelection:
    if isinstance(instance, SensingGraph):
        return from_sensing(graph_for(instance, problem), settings)
    if not isinstance(instance, SelectionInstance):
        raise UsageError(f"{instance.name} holds neither a selection nor a sensing graph, so it cannot be read as {problem}")
    refuse_settings(problem, settings)
    return SubmodularSelection(
        instance.function, instance.constraint, element_names=instance.element_names, name=instance.name, problem=problem,
        notes=instance.notes,
    )  # fmt: skip


def refuse_settings(problem: str, settings: Mapping[str, Any], known: tuple[str, ...] = ()) -> None:
    """Raise UsageError for a setting that ``problem`` does not have; ``convention`` may be ``exact`` everywhere."""
    for key, value in settings.items():
        if key == "convention":
            if value not in (None, "exact"):
                raise UsageError(f"{problem} problems have no distances to round: the convention can only be exact, not {value!r}")
            continue
        if key not in known:
            raise UsageError(f"{problem} has no setting {key!r}" + (f"; it takes {', '.join(known)}" if known else ""))
