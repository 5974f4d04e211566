"""Selection problems: choose elements of a ground set so that a set function is largest."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...instances import number_arrays as arrays
from ...instances.errors import InputError, UsageError
from ...instances.instance import digest
from ...instances.sata.constraints import Cardinality, Constraint, PartitionMatroid
from ...instances.sata.selection import SelectionInstance
from ...instances.sata.sensing_graph import SensingGraph
from ...instances.sata.set_functions import Coverage, FacilityLocation, Floats, SetFunction
from ..evaluation import Check, Evaluation, Violation, judge
from ..problem import PROBLEMS, refuse_settings
from ..tolerance import EQUAL
from .decided_elements import FEATURE, DecidedElements
from .feasibility import spendable
from .selections import Selection, graph_for, judge_elements, selection_of

if TYPE_CHECKING:
    import pandas as pd


class SubmodularSelection(DecidedElements):
    """Maximise f(S) over the sets S that a constraint allows.

    Parameters
    ----------
    function : SetFunction
        What a set is worth.
    constraint : Constraint
        Which sets are allowed.
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
    senses = ("max",)

    def __init__(
        self,
        function: SetFunction,
        constraint: Constraint,
        *,
        element_names: tuple[str, ...] | None = None,
        name: str = "selection",
        problem: str = "selection",
        notes: tuple[str, ...] = (),
    ) -> None:
        function.check()
        constraint.check(function.num_elements)
        arrays.names("element", element_names, function.num_elements)
        self.function, self.constraint, self.element_names = function, constraint, element_names
        self.name, self.problem, self.notes = name, problem, notes
        if function.as_item_weights() is None:
            ends = np.zeros((2, function.num_elements), dtype=bool)
            ends[1] = True
            empty, everything = function.values(ends).tolist()
            if abs(empty) > EQUAL * abs(everything):
                raise InputError("the empty set must have value 0; subtract its value from the function", "unsupported", found=str(empty))

    @property
    def num_elements(self) -> int:
        return self.function.num_elements

    def to_instance(self) -> Any:
        return SelectionInstance(self.function, self.constraint, self.element_names, name=self.name, format="json", notes=self.notes)

    def element_name(self, element: int) -> str:
        return str(element + 1) if self.element_names is None else self.element_names[element]

    def digest(self) -> str:
        return self.digest_decided(digest("selection", *self.function.parts(), *self.constraint.parts()))

    def features(self) -> frozenset[str]:
        """Names of the function and the constraint, such as ``function:coverage`` and ``constraint:knapsack``."""
        return frozenset({self.function.feature, self.constraint.feature, *([FEATURE] if self.decided else ())})

    @property
    def size(self) -> int:
        return self.num_elements

    def linear_entries(self) -> int:
        weights = self.function.as_item_weights()
        return 0 if weights is None else len(weights.indices) or int(np.count_nonzero(weights.matrix))

    def facts(self) -> dict[str, Any]:
        """Facts of function and constraint."""
        return {"function": self.function.facts(), "constraint": self.constraint.facts()}

    def value(self, elements: ArrayLike) -> float:
        """f of a set of elements, from the data."""
        return self.function.value(np.unique(np.asarray(elements, dtype=np.int64)))

    def gains(self, elements: Sequence[int]) -> Floats:
        """Gain of each element over those before it, shape (elements,)."""
        return self.function.gains(elements)

    def answer_at_hand(self) -> Selection:
        """The empty set."""
        return Selection.of([])

    def evaluate(self, answer: Any) -> Evaluation:
        """Recompute the value, and test that the elements exist, none twice, and that the constraint holds."""
        if not isinstance(answer, Selection):
            raise UsageError(
                f"an answer to a selection problem is a Selection, not {type(answer).__name__}: Selection.of([0, 3]) makes one", "malformed"
            )
        chosen, (elements, faults) = judge_elements(answer, self.num_elements, "elements", "element", self.element_name)
        rule, broken = self._judge_constraint(chosen)
        quantities = {"elements": float(len(chosen))}
        evaluation = Evaluation((self.value(chosen),), (elements, rule), (*faults, *broken), quantities)
        return self.with_decided(evaluation, chosen)

    def _constraint_name(self) -> str:
        return self.constraint.name

    def _judge_constraint(self, chosen: NDArray[np.int64]) -> tuple[Check, list[Violation]]:
        c, n = self.constraint, self.num_elements
        excess, message = c.excess(chosen, n)
        rows = None if c.as_partition(n) is not None else c.rows(n)  # whole numbers are compared exactly
        return judge(self._constraint_name(), excess, message, 0.0 if rows is None else spendable(rows) - rows.limit)

    def answer_to_json(self, answer: Selection) -> dict[str, Any]:
        return {"kind": "selection", "elements": [self.element_name(e) for e in answer.elements]}

    def answer_from_json(self, data: Any) -> Selection:
        if not isinstance(data, Mapping) or data.get("kind") != "selection" or not isinstance(data.get("elements"), list):
            raise InputError("not an answer to a selection problem", expected='an object {"kind": "selection", "elements": [...]}')
        index = {self.element_name(e): e for e in range(self.num_elements)}
        for entry in data["elements"]:
            if str(entry) not in index:
                raise InputError(f"the answer chooses an unknown element {str(entry)[:80]!r}", "unknown-name")
        return Selection(tuple(index[str(e)] for e in data["elements"]))

    def answer_of(self, given: Any) -> Selection:
        """A ``Selection``, or a list of element indices or names."""
        return selection_of(given, lambda: {self.element_name(e): e for e in range(self.num_elements)}, "element")

    def answer_to_frame(self, answer: Selection) -> "pd.DataFrame":
        """One row per element, as the answer lists them: element, gain, value after it."""
        import pandas as pd

        gains = self.gains(answer.elements)
        return pd.DataFrame({"element": [self.element_name(e) for e in answer.elements], "gain": gains, "value": np.cumsum(gains)})

    def __repr__(self) -> str:
        return f"<SubmodularSelection {self.name}: {self.num_elements} elements, {self.function.name}, {self.constraint.name} constraint>"


def from_sensing(graph: SensingGraph, settings: dict[str, Any]) -> SubmodularSelection:
    """The selection of actions of a sensing graph.

    Settings: ``function`` (``facility-location`` or ``coverage`` of targets), ``constraint`` (``partition``: one action per robot, or
    ``cardinality`` with ``k``).
    """
    refuse_settings("selection", settings, ("function", "constraint", "k"))
    function, constraint, k = settings.get("function", "facility-location"), settings.get("constraint"), settings.get("k")
    if function not in ("facility-location", "coverage"):
        raise UsageError(f"function must be facility-location or coverage, not {function!r}", "unknown-name")
    constraint = constraint or ("partition" if k is None else "cardinality")
    known = constraint in ("partition", "cardinality")
    if not known or (constraint == "cardinality") != (k is not None):
        wanted = "constraint must be partition (one action a robot), or cardinality with k=NUMBER"
        raise UsageError(wanted, "contradiction" if known else "unknown-name")
    chosen: SetFunction = FacilityLocation(graph.indptr, graph.indices, graph.weights, graph.num_targets)
    if function == "coverage":
        chosen = Coverage(graph.indptr, graph.indices, np.ones(graph.num_targets))
    rule: Constraint = PartitionMatroid.of(graph.robot_of_action, np.ones(graph.num_robots, dtype=np.int32))
    if k is not None:
        try:
            rule = Cardinality(int(str(k)))
        except (ValueError, InputError):
            raise UsageError(f"k must be a whole number of at least 1, not {k!r}", "out-of-range") from None
    return SubmodularSelection(chosen, rule, element_names=graph.action_labels, name=graph.name, notes=graph.notes)


@PROBLEMS.register("selection")
def _build(instance: Any, problem: str, settings: dict[str, Any]) -> SubmodularSelection:
    if isinstance(instance, SensingGraph):
        return from_sensing(graph_for(instance, problem), settings)
    if not isinstance(instance, SelectionInstance):
        raise UsageError(f"{instance.name} holds neither a selection nor a sensing graph, so it cannot be read as {problem}", "foreign")
    refuse_settings(problem, settings)
    return SubmodularSelection(
        instance.function, instance.constraint, element_names=instance.element_names, name=instance.name, problem=problem,
        notes=instance.notes,
    )  # fmt: skip
