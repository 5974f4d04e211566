"""SCIP through PySCIPOpt: linear and quadratic programs, convex or not, and second-order cones, with integers or without."""

import math
import time
from typing import Any

import numpy as np

from ...formulations.programs.cones import Cones
from ...formulations.programs.program import CONES, INTEGERS, LINEAR, QUADRATIC, Floats, Program
from ...formulations.programs.reductions.reduction import Irreducible, Reduction, Step
from ...instances.errors import UsageError
from ..backend import BACKENDS, Control, Options, RawResult
from ..own_options import own_options
from ..program_backend import FEASIBLE_TOLERANCE, ProgramBackend

DUAL_TOLERANCE = 1e-7

SECOND_ORDER = frozenset(kind for kind in CONES if kind.startswith("second-order"))

INFINITE = 1e20
"""Numbers from which on SCIP takes them for infinite."""

LIMITS = {
    "timelimit": "time", "nodelimit": "nodes", "totalnodelimit": "nodes", "memlimit": "memory", "userinterrupt": "interrupt",
    "terminate": "interrupt", "gaplimit": "gap", "stallnodelimit": "nodes", "sollimit": "none", "bestsollimit": "none",
}  # fmt: skip
"""SCIP's statuses that name a limit."""

COMMON_PARAMETERS = {
    "limits/time": "the time limit", "limits/gap": "the gap", "limits/nodes": "the iterations", "limits/totalnodes": "the iterations",
    "lp/threads": "the threads", "randomization/randomseedshift": "the seed", "display/verblevel": "the verbosity",
    "misc/catchctrlc": "Ctrl-C",
}  # fmt: skip
"""SCIP's parameters that have a name common to all solvers."""


class FiniteNumbers(Reduction):
    """Changes nothing, and refuses programs with finite numbers of ``INFINITE`` and more."""

    may_refuse = True

    def apply(self, program: Program) -> tuple[Step, ...]:
        parts = [program.cost, program.data, program.lower, program.upper, program.row_lower, program.row_upper]
        if program.quadratic is not None:
            parts.append(program.quadratic.data)
        if any((np.isfinite(part) & (np.abs(part) >= INFINITE)).any() for part in parts):
            raise Irreducible(f"numbers of {INFINITE:g} and more")
        return ()


@BACKENDS.register("scip")
class Scip(ProgramBackend):
    """SCIP (Bolusani et al. 2024): branch, cut and price, with spatial branching for nonconvex quadratic objectives.

    ``iterations`` counts nodes; there is no such limit for a continuous linear program. Extra options are SCIP's parameters by name.
    """

    name, title = "scip", "SCIP"
    engine = "SCIP"
    package = "pyscipopt"
    summary = "SCIP through PySCIPOpt: MILP, second-order cones, and quadratic programs, convex or not"
    options = None
    order = 40
    programs = (INTEGERS | QUADRATIC | SECOND_ORDER,)
    reductions = (FiniteNumbers(),)

    def search(self, program: Program, options: Options, control: Control) -> RawResult:
        if options.iterations is not None and program.features() == LINEAR:
            raise UsageError("SCIP has no limit on the iterations of a linear program; use a time limit", "unsupported")
        import pyscipopt  # noqa: F401 - loading it is not counted against the limit

        end = time.perf_counter() + options.time_limit
        search = _Search(program, options, control)
        search.run(end)
        return search.said()


class _Search:
    """A search in SCIP, and the part of its outcome that is believed."""

    def __init__(self, program: Program, options: Options, control: Control) -> None:
        import pyscipopt

        self.program, self.options, self.control = program, options, control
        self.model = model = pyscipopt.Model(program.name)
        model.hideOutput()
        model.setParam("misc/catchctrlc", False)  # Ctrl-C is Python's to hear
        model.setParam("limits/gap", float(options.gap))
        model.setParam("lp/threads", min(64, int(options.threads)))
        model.setParam("randomization/randomseedshift", int(options.seed) % (2**31 - 1))
        if options.iterations is not None:
            model.setParam("limits/nodes", int(options.iterations))
        if program.features() == LINEAR:
            # Duals are those of the program only where presolving left it as it was.
            model.setPresolve(pyscipopt.SCIP_PARAMSETTING.OFF)
            model.setHeuristics(pyscipopt.SCIP_PARAMSETTING.OFF)
            model.disablePropagation()
        _set_own(model, options.extra)
        self.columns, self.constraints = _fill(model, program)
        self.start = ""
        if options.start is not None:
            self.start = "used" if program.is_integer and self._give(options.start) else "ignored"
        self.solving = False

    def _give(self, start: Floats) -> bool:
        """Hand over a start, whose NaN are for SCIP to complete; whether SCIP takes it."""
        model, known = self.model, np.isfinite(start)
        whole = bool(known.all()) and not self.program.cones  # whose tips are variables of the model alone
        solution = model.createSol() if whole else model.createPartialSol()
        for k in np.nonzero(known)[0].tolist():
            model.setSolVal(solution, self.columns[k], float(start[k]))
        if whole and self.program.quadratic is not None:
            model.setSolVal(solution, self.columns[-1], _product_part(self.program, start))
        return bool(model.addSol(solution))

    def stop(self) -> None:
        """Ask SCIP to end its search."""
        if self.solving:
            self.model.interruptSolve()

    def run(self, end: float) -> None:
        """Search until ``end``."""
        from pyscipopt import SCIP_EVENTTYPE, Eventhdlr

        search, kinds = self, (SCIP_EVENTTYPE.BESTSOLFOUND, SCIP_EVENTTYPE.DUALBOUNDIMPROVED, SCIP_EVENTTYPE.NODESOLVED)

        class Listener(Eventhdlr):  # type: ignore[misc]
            def eventinit(self) -> None:
                for kind in kinds:
                    self.model.catchEvent(kind, self)

            def eventexit(self) -> None:
                for kind in kinds:
                    self.model.dropEvent(kind, self)

            def eventexec(self, event: Any) -> None:
                search.control.count(int(self.model.getNTotalNodes()))
                if search.control.stopped:
                    self.model.interruptSolve()
                elif event.getType() == SCIP_EVENTTYPE.BESTSOLFOUND:
                    search.hear()
                else:
                    search.control.publish(bound=search.bound())

        if self.program.features() != LINEAR:
            self.model.includeEventhdlr(Listener(), "waybound", "publishes incumbents and bounds")
        self.model.setParam("limits/time", max(0.0, end - time.perf_counter()))
        self.solving = True
        self.control.on_stop(self.stop)
        if not self.control.stopped:
            self.model.optimizeNogil()
        self.solving = False

    def hear(self) -> None:
        """Publish the incumbent."""
        x = self._values(self.model.getBestSol())
        if self.program.residual(x) <= FEASIBLE_TOLERANCE:
            self.control.publish(x, self.program.value(x), self.bound())

    def _values(self, solution: Any) -> Floats:
        model = self.model
        return np.array([model.getSolVal(solution, v) for v in self.columns[: self.program.num_variables]], dtype=np.float64)

    def bound(self) -> float | None:
        """SCIP's dual bound, None where it has none."""
        bound = float(self.model.getDualbound())
        return bound if abs(bound) < self.model.infinity() else None

    def said(self) -> RawResult:
        """SCIP's last word."""
        program, model = self.program, self.model
        said = model.getStatus()
        statistics: dict[str, Any] = {"said": said}
        if self.start:
            statistics["start"] = self.start
        limit = "interrupt" if self.control.stopped and said != "optimal" else LIMITS.get(said, "none")
        if said in ("infeasible", "unbounded", "inforunbd"):
            return RawResult("infeasible" if said == "infeasible" else "infeasible_or_unbounded", statistics=statistics)
        if model.getStage() < 3:  # it was stopped before it began
            return RawResult("unknown", limit, statistics=statistics)
        statistics.update(nodes=int(model.getNTotalNodes()), iterations=int(model.getNLPIterations()))
        linear, optimal = program.features() == LINEAR, said == "optimal"
        bound = self.bound() if not linear or optimal else None
        x = self._values(model.getBestSol()) if model.getNSols() else None
        duals = None if x is None or not linear or not optimal else _row_duals(program, model, self.constraints, x)
        return RawResult("optimal" if optimal else "unknown", limit, x, None, bound, duals, statistics)


def _fill(model: Any, program: Program) -> tuple[list[Any], list[Any]]:
    """Put the program into the model; a quadratic objective becomes a row with a variable of its own, the last column."""
    from pyscipopt.scip import Expr, ExprCons, Term

    blocks = zip(program.lower.tolist(), program.upper.tolist(), program.integer.tolist(), program.cost.tolist(), strict=True)
    columns = [model.addVar(vtype="I" if whole else "C", lb=low, ub=high, obj=cost) for low, high, whole, cost in blocks]
    terms = [Term(v) for v in columns]
    constraints: list[Any] = []
    starts, indices, data = program.indptr.tolist(), program.indices.tolist(), program.data.tolist()
    for i, (low, high) in enumerate(zip(program.row_lower.tolist(), program.row_upper.tolist(), strict=True)):
        if low == -math.inf and high == math.inf:
            constraints.append(None)
            continue
        row = Expr({terms[indices[k]]: data[k] for k in range(starts[i], starts[i + 1])})
        sides = {"lhs": None if low == -math.inf else low, "rhs": None if high == math.inf else high}
        constraints.append(model.addCons(ExprCons(row, **sides)))
    for cones in program.cones:
        _add_cones(model, cones, columns)
    if program.quadratic is not None:
        import scipy.sparse as sp

        upper = sp.coo_matrix(sp.triu(program.quadratic))
        part = model.addVar(vtype="C", lb=None, ub=None, obj=1.0)
        products = {Term(part): -1.0}
        for i, j, q in zip(upper.row.tolist(), upper.col.tolist(), upper.data.tolist(), strict=True):
            product = Term(columns[i], columns[j])
            products[product] = products.get(product, 0.0) + (q / 2.0 if i == j else q)
        sides = {"lhs": 0.0, "rhs": None} if program.sense == "max" else {"lhs": None, "rhs": 0.0}
        model.addCons(ExprCons(Expr(products), **sides))
        columns.append(part)
    if program.sense == "max":
        model.setMaximize()
    model.addObjoffset(program.offset)
    return columns, constraints


def _add_cones(model: Any, cones: Cones, columns: list[Any]) -> None:
    """Add rows ``norm of v <= t``, with a variable for each affine t and v, which SCIP takes out again."""
    import pyscipopt

    def image(row: int) -> Any:
        at = range(cones.indptr[row], cones.indptr[row + 1])
        return pyscipopt.quicksum(float(cones.data[k]) * columns[cones.indices[k]] for k in at) + float(cones.offset[row])

    for first in range(0, len(cones.offset), cones.width):
        tip = model.addVar(vtype="C", lb=0.0, ub=None)
        model.addCons(tip == image(first))
        squares = pyscipopt.quicksum(image(row) ** 2 for row in range(first + 1, first + cones.width))
        model.addCons(pyscipopt.sqrt(squares) <= tip)


def _product_part(program: Program, x: Floats) -> float:
    assert program.quadratic is not None
    return float(x @ (program.quadratic @ x)) / 2.0


def _set_own(model: Any, extra: dict[str, Any]) -> None:
    for name, value in own_options("scip", extra, model.getParams() if extra else {}, COMMON_PARAMETERS, "parameter").items():
        try:
            model.setParam(name, value)
        except (TypeError, ValueError, LookupError):
            raise UsageError(f"scip: {value!r} is no value for parameter {name}", "out-of-range") from None


def _row_duals(program: Program, model: Any, constraints: list[Any], x: Floats) -> Floats | None:
    """Row duals of a linear program, d objective / d right side; None where they do not prove its optimum.

    SCIP makes rows of one variable bounds, and minimises: what such a row is worth is found in the variable's reduced cost, and the
    sign of all is that of the minimisation.
    """
    sign = 1.0 if program.sense == "min" else -1.0
    y = np.array([0.0 if c is None else model.getDualsolLinear(c) for c in constraints], dtype=np.float64)
    cost, matrix = sign * program.cost, program.matrix
    alone = np.nonzero(np.diff(program.indptr) == 1)[0]
    alone = alone[program.data[program.indptr[alone]] != 0]
    if len(alone):
        y[alone] = 0.0
        column, value = program.indices[program.indptr[alone]], program.data[program.indptr[alone]]
        reduced, activity = cost - matrix.T @ y, value * x[column]
        at_lower = np.abs(activity - program.row_lower[alone]) <= DUAL_TOLERANCE * np.maximum(1.0, np.abs(activity))
        at_upper = np.abs(activity - program.row_upper[alone]) <= DUAL_TOLERANCE * np.maximum(1.0, np.abs(activity))
        own = ((reduced > 0) & (x - program.lower <= DUAL_TOLERANCE)) | ((reduced < 0) & (program.upper - x <= DUAL_TOLERANCE))
        wanted = reduced[column] / value
        use = ~own[column] & (((wanted > 0) & at_lower) | ((wanted < 0) & at_upper))
        _, first = np.unique(column[use], return_index=True)
        y[alone[use][first]] = wanted[use][first]
    reduced, activity = cost - matrix.T @ y, matrix @ x
    for price, level, low, high in ((y, activity, program.row_lower, program.row_upper), (reduced, x, program.lower, program.upper)):
        slack = np.where(price > 0, level - low, np.where(price < 0, high - level, 0.0))
        if (np.minimum(np.abs(price), slack) > DUAL_TOLERANCE * np.maximum(1.0, np.abs(level))).any():
            return None
    return sign * y
