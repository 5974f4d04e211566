"""Selection problems: choose elements of a ground set so that a set function is largest."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...instances.errors import InputError, UsageError
from ...instances.instance import digest
from ...instances.selection import (
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
from ...instances.sensing import SensingGraph
from ..evaluation import Checklist, Evaluation
from ..problem import PROBLEMS, Problem
from ..selections import Selection

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
        found = np.asarray(self.evaluate(masks), dtype=np.float64)
        if found.shape != (len(masks),) or not np.isfinite(found).all():
            raise InputError(
                f"the set function {self.label} must return one finite number a set", expected=f"({len(masks)},)", found=str(found.shape)
            )
        return found

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
            empty = float(function.values(np.zeros((1, function.num_elements), dtype=bool))[0])
            if abs(empty) > 1e-12:
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
        best = np.zeros(f.num_items)
        for element in chosen.tolist():
            items = slice(f.indptr[element], f.indptr[element + 1])
            at = f.indices[items]
            given = f.item_weights[at] if isinstance(f, Coverage) else f.weights[items]
            best[at] = np.maximum(best[at], given)
        return best

    def evaluate(self, answer: Any) -> Evaluation:
        """Recompute the value, and test that the elements exist, none twice, and that the constraint holds."""
        if not isinstance(answer, Selection):
            raise UsageError(
                f"an answer to a selection problem is a Selection, not {type(answer).__name__}: Selection.of([0, 3]) makes one"
            )
        checks = Checklist()
        chosen = self._elements(answer, checks)
        self._test_constraint(chosen, checks)
        value = self.value(chosen)
        names = ["elements", self._constraint_name()]
        return Evaluation((value,), checks.checks(names), tuple(checks.violations), {"elements": float(len(chosen))})

    def _elements(self, answer: Selection, checks: Checklist) -> NDArray[np.int64]:
        seen: set[int] = set()
        for element in answer.elements:
            exists = 0 <= element < self.num_elements
            checks.test("elements", 0.0 if exists else 1.0, f"element {element} does not exist")
            if exists:
                checks.test("elements", float(element in seen), f"element {self.element_name(element)} is chosen twice")
                seen.add(element)
        return np.array(sorted(seen), dtype=np.int64)

    def _constraint_name(self) -> str:
        return self.constraint.name

    def _test_constraint(self, chosen: NDArray[np.int64], checks: Checklist) -> None:
        c, name = self.constraint, self._constraint_name()
        if isinstance(c, Cardinality):
            checks.test(name, float(len(chosen) - c.limit), f"{len(chosen)} elements are chosen, at most {c.limit} are allowed")
        elif isinstance(c, Knapsack):
            cost = math.fsum(c.costs[chosen])
            checks.test(name, cost - c.budget, f"the chosen elements cost {cost:.9g}, the budget is {c.budget:.9g}")
        else:
            counts = np.bincount(c.groups[chosen], minlength=len(c.limits))
            for group in np.unique(c.groups[chosen]).tolist():
                over = int(counts[group]) - int(c.limits[group])
                checks.test(
                    name, float(over), f"{counts[group]} elements of {self._group_name(group)} are chosen, {c.limits[group]} allowed"
                )

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

    def answer_to_frame(self, answer: Selection) -> pd.DataFrame:
        """One row an element in the order of choice: element, gain, value after it."""
        import pandas as pd

        totals = [self.value(answer.elements[: k + 1]) for k in range(len(answer))]
        gains = np.diff([0.0, *totals])
        return pd.DataFrame({"element": [self.element_name(e) for e in answer.elements], "gain": gains, "value": totals})

    def __repr__(self) -> str:
        return f"<SubmodularSelection {self.name}: {self.num_elements} elements, {self.function.name}, {self.constraint.name} constraint>"


def from_sensing(graph: SensingGraph, settings: dict[str, Any]) -> SubmodularSelection:
    """Actions as elements. Settings: ``function`` (``facility-location`` or ``coverage`` of targets), ``constraint`` (``partition``:
    one action a robot, or ``cardinality`` with ``k``)."""
    known = ("convention", "function", "constraint", "k")
    for key in settings:
        if key not in known:
            raise UsageError(f"a selection from a sensing graph has no setting {key!r}; it takes {', '.join(known[1:])}")
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
    names = tuple(graph.action_name(a) for a in range(graph.num_actions))
    return SubmodularSelection(chosen, rule, element_names=names, name=graph.name, notes=graph.notes)


@PROBLEMS.register("selection")
def _build(instance: Any, problem: str, settings: dict[str, Any]) -> SubmodularSelection:
    if isinstance(instance, SensingGraph):
        return from_sensing(instance, settings)
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
        if key == "convention" and value in (None, "exact"):
            continue
        if key not in known:
            raise UsageError(f"{problem} has no setting {key!r}" + (f"; it takes {', '.join(known)}" if known else ""))
