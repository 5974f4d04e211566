"""OR-Tools CP-SAT: programs over integers, products of variables and circuits included, counted exactly in 64 bits."""

import math
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from ...formulations.programs.circuits import Circuit
from ...formulations.programs.program import CIRCUITS, INTEGERS, QUADRATIC
from ...formulations.programs.reductions.whole_numbers import UNLIMITED, WHOLE_NUMBERS, IntegerProgram
from ...instances.errors import UnsupportedError, UsageError
from ..backend import BACKENDS, Control, Options, RawResult
from ..own_options import own_options
from ..program_backend import ProgramBackend, takers

STATUS_MAP = {
    "UNKNOWN": "unknown", "MODEL_INVALID": "error", "FEASIBLE": "feasible", "INFEASIBLE": "infeasible", "OPTIMAL": "optimal",
}  # fmt: skip

COMMON_PARAMETERS = {
    "max_time_in_seconds": "the time limit",
    "relative_gap_limit": "the gap",
    "num_workers": "the threads",
    "num_search_workers": "the threads",
    "random_seed": "the seed",
    "max_number_of_conflicts": "the iterations",
    "log_search_progress": "the verbosity",
    "log_to_stdout": "the verbosity",
    "catch_sigint_signal": "Ctrl-C",
}
"""CP-SAT's parameters that have a name common to all solvers."""

UNSOUND = ("instantiate_all_variables", "fill_tightened_domains_in_response", "stop_after_presolve", "enumerate_all_solutions")
"""Parameters that change the meaning of the answer or the bound."""

ASK_AGAIN = 0.05
"""Seconds between two requests to stop: one that comes before the search begins is lost."""


@BACKENDS.register("cpsat")
class CpSat(ProgramBackend):
    """OR-Tools CP-SAT (Perron & Didier): lazy clause generation with linear relaxations.

    It takes mixed-integer programs whose continuous variables can be counted in steps, products of variables, and circuits; every
    variable needs bounds, given or implied. ``WholeNumbers`` says how data become integers. ``iterations`` counts conflicts. One
    thread repeats to the bit. Extra options are CP-SAT's parameters by name.
    """

    name, title = "cpsat", "CP-SAT"
    engine = "CP-SAT"
    package = "ortools"
    summary = "OR-Tools CP-SAT: integer programs, products of variables and circuits included, counted in 64 bits"
    options = None
    order = 60
    programs = (INTEGERS | QUADRATIC | CIRCUITS,)
    only_integers = True
    reductions = (WHOLE_NUMBERS,)
    feasible_tolerance = 1e-6

    def search(self, program: IntegerProgram, options: Options, control: Control) -> RawResult:
        from ortools.sat.python import cp_model

        solver = cp_model.CpSolver()
        _configure(solver.parameters, options)
        if (program.lower > program.upper).any():
            name = program.source.variable_name(int(np.argmax(program.lower > program.upper)))
            return RawResult("infeasible", message=f"no whole number is within the bounds of {name}")
        model = cp_model.CpModel()
        _fill(model.proto, program)
        if options.start is not None:
            known = np.nonzero(np.isfinite(options.start))[0]  # products are left for CP-SAT to complete
            model.proto.solution_hint.vars.extend(known.tolist())
            model.proto.solution_hint.values.extend(options.start[known].astype(np.int64).tolist())
        wrong = model.validate()
        if wrong:
            lacking = f"programs that 64 bits do not hold ({wrong.splitlines()[0]})"
            raise UnsupportedError(self.name, {lacking}, takers(program.source.features(), self.name))
        began = time.perf_counter()
        response = _search(solver, model, program, control)
        return _said(response, program, options, control, time.perf_counter() - began)


def set_limits(parameters: Any, options: Options) -> None:
    """Limits, threads, seed and gap."""
    parameters.max_time_in_seconds = max(0.0, float(options.time_limit))
    parameters.num_workers = int(options.threads)
    parameters.random_seed = int(options.seed) % (2**31 - 1)
    parameters.relative_gap_limit = float(options.gap)
    parameters.absolute_gap_limit = 0.0
    parameters.catch_sigint_signal = False  # its handler knows what to do in the searching thread alone, and aborts in any other
    if options.iterations is not None:
        parameters.max_number_of_conflicts = int(options.iterations)


def _configure(parameters: Any, options: Options) -> None:
    set_limits(parameters, options)
    if options.threads == 1:  # more of them share these out among themselves
        parameters.linearization_level = 2  # rows of two binaries too: 0.1 s against a bound 43 % off on products of SATA
        parameters.add_lp_constraints_lazily = False  # else the search may creep up in fine steps without seeing the whole LP
    known = {n: getattr(parameters, n) for n in dir(parameters) if not n.startswith(("_", "clear_", "has_", "Has", "Clear"))}
    for name, value in own_options("cpsat", options.extra, known, COMMON_PARAMETERS, "parameter").items():
        if name in UNSOUND:
            raise UsageError(f"cpsat: with {name} set otherwise, what CP-SAT calls optimal need not be", "unsupported")
        try:
            setattr(parameters, name, value)
        except (TypeError, ValueError):
            raise UsageError(f"cpsat: {value!r} is no value for parameter {name}", "out-of-range") from None


def _fill(proto: Any, counted: IntegerProgram) -> None:
    """The integer program as CP-SAT's message."""
    top = 2**62
    variables, constraints = proto.variables, proto.constraints
    for low, high in zip(counted.lower.tolist(), counted.upper.tolist(), strict=True):
        variables.add().domain.extend([low, high])
    indptr, indices, data = counted.indptr.tolist(), counted.indices.tolist(), counted.data.tolist()
    for i, (low, high) in enumerate(zip(counted.row_lower.tolist(), counted.row_upper.tolist(), strict=True)):
        if low == -UNLIMITED and high == UNLIMITED:
            continue
        linear = constraints.add().linear
        linear.vars.extend(indices[indptr[i] : indptr[i + 1]])
        linear.coeffs.extend(data[indptr[i] : indptr[i + 1]])
        linear.domain.extend([-top if low == -UNLIMITED else low, top if high == UNLIMITED else high])
    for graph in counted.source.circuits:
        _connect(constraints, counted, graph)
    objective = [(j, c) for j, c in enumerate(counted.cost.tolist()) if c]
    products = [_product(proto, counted, i, j) for i, j in counted.pairs.tolist()]
    objective += [(column, factor) for column, factor in zip(products, counted.factors.tolist(), strict=True) if factor]
    proto.objective.vars.extend([j for j, _ in objective])
    proto.objective.coeffs.extend([c for _, c in objective])


def _connect(constraints: Any, counted: IntegerProgram, graph: Circuit) -> None:
    """Add a circuit, or several. A node without arcs makes the program infeasible, and CP-SAT would not know of it.

    Its constraint on routes takes loops too, but calls feasible models infeasible then (9.15: its presolve forgets them where a node is
    not joined to node 0 in both directions).
    """
    if graph.nodes > max(int(graph.several), len(np.intersect1d(graph.tail, graph.head))):
        constraints.add().bool_or.literals.extend([])  # none of which is true
    elif len(graph.tail):
        constraint = constraints.add()
        constraint = constraint.routes if graph.several else constraint.circuit
        ones = counted.shift[graph.column] == 1.0  # what is fixed to 1 is counted from there
        constraint.tails.extend(graph.tail.tolist())
        constraint.heads.extend(graph.head.tolist())
        constraint.literals.extend(np.where(ones, -graph.column - 1, graph.column).tolist())  # -k-1 is the negation of k


def _product(proto: Any, counted: IntegerProgram, i: int, j: int) -> int:
    """Number of a variable that equals the product of two."""
    low, high = counted.lower[[i, j]].tolist(), counted.upper[[i, j]].tolist()
    number = len(proto.variables)
    if low == [0, 0] and high == [1, 1] and i != j:
        proto.variables.add().domain.extend([0, 1])
        both = proto.constraints.add()
        both.enforcement_literal.extend([number])
        both.bool_and.literals.extend([i, j])
        proto.constraints.add().bool_or.literals.extend([number, -i - 1, -j - 1])
        return number
    corners = [a * b for a in (low[0], high[0]) for b in (low[1], high[1])]
    least = 0 if i == j and low[0] <= 0 <= high[0] else min(corners)
    proto.variables.add().domain.extend([least, max(corners)])
    product = proto.constraints.add().int_prod
    product.target.vars.extend([number])
    product.target.coeffs.extend([1])
    for k in (i, j):
        factor = product.exprs.add()
        factor.vars.extend([k])
        factor.coeffs.extend([1])
    return number


def _search(solver: Any, model: Any, program: IntegerProgram, control: Control) -> Any:
    """Run, and publish incumbents and bounds."""

    def hear(found: Any) -> None:
        values = found.response_proto.solution
        control.publish(np.array([values[k] for k in range(program.num_variables)]))

    def hear_bound(least: float) -> None:
        if abs(least) < float(UNLIMITED):
            control.publish(bound=least - 4 * math.ulp(1.0) * abs(least))

    search_until_stopped(solver, model, control, hear, hear_bound)
    return solver.response_proto


def search_until_stopped(
    solver: Any, model: Any, control: Control, on_answer: Callable[[Any], None], on_bound: Callable[[float], None]
) -> Any:
    """CP-SAT's status after a search that hears of the wish to stop; ``on_answer`` gets the callback object for each answer."""
    from ortools.sat.python import cp_model

    over = threading.Event()

    class Hear(cp_model.CpSolverSolutionCallback):  # type: ignore[misc]
        def on_solution_callback(self) -> None:
            on_answer(self)

    def stop() -> None:
        while not over.is_set():
            solver.stop_search()
            over.wait(ASK_AGAIN)

    solver.best_bound_callback = on_bound
    control.on_stop(lambda: threading.Thread(target=stop, daemon=True).start())
    try:
        return solver.solve(model, Hear())
    finally:
        over.set()


def _said(response: Any, program: IntegerProgram, options: Options, control: Control, seconds: float) -> RawResult:
    status = STATUS_MAP[response.status.name]
    statistics = {
        "conflicts": int(response.num_conflicts), "branches": int(response.num_branches),
        "scale": {"objective": program.scale, "exact": program.exact},
    }  # fmt: skip
    if options.start is not None:
        statistics["start"] = "used"
    limit = "none"
    if status in ("unknown", "feasible"):
        if control.stopped:
            limit = "interrupt"
        elif seconds >= 0.98 * options.time_limit:
            limit = "time"
        elif options.iterations is not None and response.num_conflicts >= options.iterations:
            limit = "nodes"
        elif not options.extra:  # nothing else ends it; on a busy machine its clock is ahead of ours
            limit = "time"
    least = float(response.inner_objective_lower_bound)
    values = response.solution
    return RawResult(
        status, limit, np.array([values[k] for k in range(program.num_variables)]) if status in ("optimal", "feasible") else None,
        bound=least if abs(least) < UNLIMITED else None, statistics=statistics,
        message="CP-SAT calls the model invalid" if status == "error" else "",
    )  # fmt: skip
