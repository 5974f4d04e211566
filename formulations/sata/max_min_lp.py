"""General max-min and min-max linear programs: packing rows against covering rows; and those that are bottleneck problems of robots."""

import math
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ...instances.errors import InputError, UnsupportedError, UsageError
from ...instances.number_arrays import Floats
from ...instances.sata.max_min_lp import MaxMinInstance, SparseMatrix
from ...instances.sata.sensing_graph import SensingGraph
from ..evaluation import Evaluation, judge
from ..evidence import Evidence
from ..problem import PROBLEMS, Problem, refuse_settings
from ..references import is_number, vector_of
from ..tolerance import VECTOR
from .bottleneck_sata import BottleneckSATA

if TYPE_CHECKING:
    import pandas as pd


class MaxMinLP(Problem):
    """``max``: maximise the least entry of C x subject to A x <= 1, x >= 0. ``min``: minimise the largest of A x subject to C x >= 1.

    Parameters
    ----------
    packing, covering : SparseMatrix, or any matrix of shape (rows, variables)
        A and C, nonnegative.
    sense : str
        ``max`` or ``min``.
    name : str
        For tables and files.
    notes : sequence of str
        What a user should be told.
    variable_names : sequence of str, optional
        One a column; None stands for "1", "2", ...

    Raises
    ------
    InputError
        If the matrices do not fit each other, or the program is unbounded or infeasible by its pattern.

    Notes
    -----
    Source: Floréen, Hassinen, Kaasinen, Kaski, Musto and Suomela (2011), Local approximability of max-min and min-max linear
    programs; docs/formulations/bottleneck.md#max-min-and-min-max-linear-programs. The bottleneck problem of robots is the member with one
    packing row a variable.
    """

    family: ClassVar[str] = "max-min"

    def __init__(
        self,
        packing: Any,
        covering: Any,
        *,
        sense: str = "max",
        name: str = "max-min-lp",
        variable_names: tuple[str, ...] | None = None,
        notes: tuple[str, ...] = (),
    ) -> None:
        a, c = (m if isinstance(m, SparseMatrix) else SparseMatrix.of(m) for m in (packing, covering))
        self.instance = MaxMinInstance(a, c, sense, variable_names, name=name, notes=notes)
        self.packing, self.covering = a, c
        self.name, self.problem, self.notes = name, "max-min-lp", notes

    @property
    def num_variables(self) -> int:
        return self.packing.columns

    @property
    def senses(self) -> tuple[str, ...]:
        return (self.instance.sense,)

    def digest(self) -> str:
        return self.instance.digest()

    @cached_property
    def one_packing_row(self) -> bool:
        """True if every variable that covers stands in exactly one packing row, as the actions of robots do."""
        rows = np.bincount(self.packing.indices, minlength=self.num_variables)
        return bool((rows[np.unique(self.covering.indices)] == 1).all())

    def features(self) -> frozenset[str]:
        """``packing-covering`` always; ``min-max`` and ``several-packing-rows`` where it is or has them."""
        marks = {"min-max": self.sense == "min", "several-packing-rows": not self.one_packing_row}
        return frozenset({"packing-covering", *(name for name, present in marks.items() if present)})

    def facts(self) -> dict[str, Any]:
        """Sizes of the two matrices, and whether each variable stands in one packing row."""
        return {
            "variables": self.num_variables,
            "packing": self.packing.facts(),
            "covering": self.covering.facts(),
            "one_packing_row": self.one_packing_row,
        }

    def variable_name(self, variable: int) -> str:
        names = self.instance.variable_names
        return str(variable + 1) if names is None else names[variable]

    def evaluate(self, answer: Any) -> Evaluation:
        """Recompute every row of the vector ``answer`` of shape (variables,).

        What passes is priced at the nearest multiple of its nonnegative part that breaks no row, so that nothing is gained by what the
        tests let pass. A negative entry is tested by what it adds to a row.
        """
        x = self._vector(answer)
        maximise = self.sense == "max"
        with np.errstate(invalid="ignore", over="ignore"):
            packed, covered = _rows(self.packing, x), _rows(self.covering, x)
            row, excess = ("packing", packed - 1.0) if maximise else ("covering", 1.0 - covered)
            negative = np.where(np.isfinite(x), -x * self._heaviest, math.inf)
            value = float(covered.min()) if maximise else float(packed.max())
        judged = (
            judge("variables", negative, lambda k: f"variable {self.variable_name(k)} is {x[k]:.9g}, not 0 or more", VECTOR),
            judge(row, excess, lambda k: f"{row} row {k + 1} is broken, by {excess[k]:.9g}", VECTOR),
        )
        violations = tuple(v for _, faults in judged for v in faults)
        priced = value if violations else self._price(np.maximum(x, 0.0))
        return Evaluation((priced,), tuple(check for check, _ in judged), violations, {}, precision=VECTOR)

    def answer_at_hand(self) -> Floats | None:
        """All variables alike, as large (``max``) or small (``min``) as the rows let them be."""
        matrix, worst = (self.packing, np.max) if self.sense == "max" else (self.covering, np.min)
        limit = float(worst(_rows(matrix, np.ones(self.num_variables))))
        return np.full(self.num_variables, 1.0 / limit) if 0.0 < limit < math.inf else None

    def _price(self, x: Floats) -> float:
        """The objective at the nearest multiple of ``x`` that breaks no row."""
        most, least = float(_rows(self.packing, x).max()), float(_rows(self.covering, x).min())
        return least / max(1.0, most) if self.sense == "max" else most / min(1.0, least)

    @cached_property
    def _heaviest(self) -> Floats:
        """Largest coefficient of each variable in the rows that limit it; 1 where it stands in none."""
        rows = self.packing if self.sense == "max" else self.covering
        heaviest = np.zeros(self.num_variables)
        np.maximum.at(heaviest, rows.indices, rows.data)
        return np.where(heaviest > 0, heaviest, 1.0)

    def _vector(self, answer: Any) -> Floats:
        x = vector_of(answer)
        if x.shape != (self.num_variables,):
            raise UsageError(f"an answer to {self.problem} is a vector of {self.num_variables} numbers", "wrong-shape")
        return x

    def answer_to_json(self, answer: Any) -> dict[str, Any]:
        x = np.asarray(answer, dtype=np.float64)
        return {"kind": "values", "values": {self.variable_name(k): float(x[k]) for k in np.nonzero(x)[0].tolist()}}

    def answer_from_json(self, data: Any) -> Floats:
        if not isinstance(data, Mapping) or data.get("kind") != "values" or not isinstance(data.get("values"), Mapping):
            raise InputError("not an answer to a max-min LP", expected='an object {"kind": "values", "values": {"1": 0.5, ...}}')
        index, x = {self.variable_name(k): k for k in range(self.num_variables)}, np.zeros(self.num_variables)
        for name, value in data["values"].items():
            if name not in index:
                raise InputError(f"the answer names an unknown variable {str(name)[:80]!r}", "unknown-name")
            if not is_number(value):
                raise InputError(f"the value of variable {name} is not a number", found=str(value)[:80])
            x[index[name]] = value
        return x

    def answer_of(self, given: Any) -> Floats:
        """A vector of shape (variables,)."""
        return self._vector(given)

    def answer_to_frame(self, answer: Any) -> "pd.DataFrame":
        """One row per variable that is not 0: variable, value."""
        import pandas as pd

        x = np.asarray(answer, dtype=np.float64)
        used = np.nonzero(x)[0].tolist()
        return pd.DataFrame({"variable": [self.variable_name(k) for k in used], "value": x[used]})

    def to_instance(self) -> MaxMinInstance:
        return self.instance

    def __repr__(self) -> str:
        kind = "max-min" if self.sense == "max" else "min-max"
        rows = f"{self.packing.rows} packing and {self.covering.rows} covering rows"
        return f"<MaxMinLP {self.name}: {kind}, {self.num_variables} variables, {rows}>"


def _rows(matrix: SparseMatrix, x: Floats) -> Floats:
    row = np.repeat(np.arange(matrix.rows), np.diff(matrix.indptr))
    return np.asarray(np.bincount(row, matrix.data * x[matrix.indices], minlength=matrix.rows), dtype=np.float64)


@PROBLEMS.register("max-min-lp")
def _build(instance: Any, problem: str, settings: dict[str, Any]) -> MaxMinLP:
    if not isinstance(instance, MaxMinInstance):
        raise UsageError(f"{instance.name} holds no packing and covering rows, so it cannot be read as {problem}", "foreign")
    refuse_settings(problem, settings)
    return MaxMinLP(
        instance.packing, instance.covering, sense=instance.sense, name=instance.name, variable_names=instance.variable_names,
        notes=instance.notes,
    )  # fmt: skip


# -- one packing row a variable ---------------------------------------------------------------------------------------


class RobotsOf:
    """A max-min problem as one of robots and targets, and the way back for its answers and evidence.

    ``scale`` is that of ``as_sensing``, or None where the problem is one of robots as it stands.
    """

    def __init__(self, problem: BottleneckSATA | MaxMinLP) -> None:
        self.graph: SensingGraph
        self.scale: Floats | None = None
        if isinstance(problem, MaxMinLP):
            self.graph, self.scale = as_sensing(problem)
        else:
            self.graph = problem.graph

    def answer(self, shares: Floats) -> Floats:
        """The problem's own answer that shares of actions stand for."""
        return shares if self.scale is None else shares / self.scale

    def evidence(self, evidence: Evidence) -> Evidence:
        """Evidence ``target-weights`` for the graph, as evidence for the problem."""
        return evidence if self.scale is None else as_row_prices(self.graph, evidence)


def as_sensing(problem: MaxMinLP) -> tuple[SensingGraph, Floats]:
    """Packing rows as robots, variables as actions, covering rows as targets; of a maximum.

    With ``x'_v = a_v x_v``, where a_v is the coefficient of v in its packing row, rows read ``sum x' <= 1`` and the weight of v for a
    target is ``c_v / a_v``: values are the same. Returns the graph, with one action per variable in their order, and the scale of shape
    (variables,) with ``x = x' / scale``, infinite for variables that cover nothing, which makes them 0. Raises UnsupportedError where a
    variable that covers stands in several packing rows, the sense is ``min``, or a quotient overflows or vanishes.

    Source: Sung (2019), section 3.4.1 and (3.5); docs/formulations/bottleneck.md#one-packing-row-a-variable.
    """
    missing = problem.features() & {"min-max", "several-packing-rows"}
    if missing:
        raise UnsupportedError("the reduction to robots", missing)
    a, c = problem.packing, problem.covering
    n = problem.num_variables
    covering = np.zeros(n, dtype=bool)
    covering[c.indices] = True
    robot, scale = np.zeros(n, dtype=np.int32), np.full(n, np.inf)
    rows = np.repeat(np.arange(a.rows, dtype=np.int32), np.diff(a.indptr))
    robot[a.indices] = rows
    single = covering[a.indices]
    scale[a.indices[single]] = a.data[single]
    order = np.argsort(c.indices, kind="stable")  # rows ascend within a column, as they do in the matrix
    indptr = np.zeros(n + 1, dtype=np.int32)
    np.cumsum(np.bincount(c.indices, minlength=n), out=indptr[1:])
    targets = np.repeat(np.arange(c.rows, dtype=np.int32), np.diff(c.indptr))[order]
    with np.errstate(over="ignore", under="ignore"):
        weights = (c.data / scale[c.indices])[order]
    if not (np.isfinite(weights) & (weights > 0)).all():
        raise far_apart("the reduction to robots", problem)
    return SensingGraph(robot, indptr, targets, weights, a.rows, c.rows, name=problem.name), scale


def far_apart(who: str, problem: MaxMinLP) -> UnsupportedError:
    """The refusal of coefficients whose quotients are too large, too small or too far apart: it names the extreme ones."""
    a, c = problem.packing, problem.covering
    largest = np.zeros(problem.num_variables)
    np.maximum.at(largest, a.indices, a.data)
    with np.errstate(divide="ignore"):
        quotients = np.log(c.data) - np.log(largest[c.indices])
    least, most = (
        f"{c.data[k]:g} in covering and {largest[c.indices[k]]:g} in packing of variable {problem.variable_name(int(c.indices[k]))}"
        for k in (int(np.argmin(quotients)), int(np.argmax(quotients)))
    )
    extremes = most if least == most else f"{least}, and {most}"
    return UnsupportedError(
        who,
        {f"coefficients whose quotients no double holds beside each other ({extremes})"},
        advice="divide all covering rows by one number, or leave out what is negligible beside the rest",
    )


def as_row_prices(graph: SensingGraph, evidence: Evidence) -> Evidence:
    """Evidence ``target-weights`` for the graph of ``as_sensing`` as evidence ``packing-covering-duals`` for its program.

    Weights y of the targets price the packing rows: a robot is worth its best action's weighted sum.
    """
    y = np.zeros(graph.num_targets)
    y[np.asarray(evidence.data["targets"], dtype=np.int64)] = evidence.data["weights"]
    worth = np.bincount(graph.action_of_edge, graph.weights * y[graph.indices], minlength=graph.num_actions)
    z = np.zeros(graph.num_robots)
    np.maximum.at(z, graph.robot_of_action, worth)
    return Evidence("packing-covering-duals", evidence.source, evidence.value, {"covering": y.tolist(), "packing": z.tolist()})
