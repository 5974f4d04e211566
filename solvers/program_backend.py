"""Base class of solvers that take programs: reduce the program, run the solver, and check what it returns."""

import time
import weakref
from abc import abstractmethod
from collections.abc import Iterable
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from ..formulations.evidence import Evidence
from ..formulations.programs.exactness import Exactness
from ..formulations.programs.program import CIRCUITS, CONES, INTEGERS, LINEAR, QUADRATIC, Program, described
from ..formulations.programs.reductions.reduction import Chain, Irreducible, Reduction
from ..formulations.programs.reductions.sound_arrays import UNIQUE_ENTRIES, WHOLE_BOUNDS
from ..formulations.programs.reductions.units import UNITS, Scaled
from ..formulations.programs.soundness import refuse_numbers
from ..instances.errors import UnsupportedError
from .backend import BACKENDS, Backend, Control, Options, RawResult, solver_named
from .priorities import by_priority

FEASIBLE_TOLERANCE = 1e-5
"""Residual up to which a point that a solver calls feasible, mostly by 1e-6, is handed on; ``solve`` judges it in the problem's words."""

EQUAL_TOLERANCE = 1e-6
"""Relative difference up to which value and bound are the same."""

WITHOUT_OBJECTIVE = {
    "optimal": "unbounded", "feasible": "unbounded", "infeasible": "infeasible", "infeasible_or_unbounded": "infeasible",
}  # fmt: skip
"""Status of a program that is infeasible or unbounded, by the status of the same program without its objective."""


class ProgramBackend(Backend):
    """Solves programs of the features it declares.

    A backend says what it takes, which reductions get a program there, and how it is searched (``search``); ``run`` does the rest.

    Class attributes
    ----------------
    title : str
        What messages call it; its name by default.
    engine : str
        Whose algorithms do the work, so that a second opinion is one: several solvers hand programs to HiGHS. Its name by default.
    programs : tuple of sets of features
        What it takes together (see ``Program.features``): a program's features must be among those of one set.
    only_integers : bool
        Whether it takes no program without integers.
    reductions : tuple of Reduction
        Applied in this order to a program in ordinary units.
    library : str, optional
        Distribution that brings the solver itself, where it is another one than ``package``.
    """

    takes = "program"
    title: str = ""
    engine: str = ""
    programs: tuple[frozenset[str], ...] = (LINEAR,)
    only_integers: bool = False
    reductions: tuple[Reduction, ...] = ()
    library: str | None = None
    feasible_tolerance: ClassVar[float] = FEASIBLE_TOLERANCE

    def __init__(self, variant: str = "") -> None:
        super().__init__(variant)
        self.engine = self.engine or self.label

    @classmethod
    def available(cls) -> tuple[str, ...]:
        """Names of this solver and of those within it that can be used on this machine."""
        return (cls.name, *(f"{cls.name}:{variant}" for variant in cls.variants))

    @classmethod
    def takers(cls, features: frozenset[str]) -> tuple[str, ...]:
        """Names of the solvers within this one, itself first, that take programs of ``features``."""
        return (cls.name,) if cls().able(features) else ()

    def able(self, features: frozenset[str]) -> bool:
        """Whether it takes programs of these features, once they are reduced; the numbers may still forbid it."""
        for reduction in self.reductions:
            features = reduction.features(features)
        return any(features <= most for most in self.programs) and (not self.only_integers or features >= INTEGERS)

    def lacking(self, program: Program) -> frozenset[str]:
        """Features of ``program`` that the solver lacks, whatever its numbers; a program without variables needs no solver."""
        features = program.features()
        if self.able(features) or not program.num_variables:
            return frozenset()
        return CIRCUITS if features >= CIRCUITS and self.able(features - CIRCUITS) else frozenset({f"{program.kind} programs"})

    def missing(self, program: Program) -> frozenset[str]:
        """Features of ``program`` that the solver lacks, its numbers included; empty if it can take it."""
        lacking = self.lacking(program)
        try:
            if not lacking and any(reduction.may_refuse for reduction in self.reductions):
                with np.errstate(all="ignore"):  # ``run`` refuses numbers that mean nothing
                    for level in program.levels():
                        self.chain(level)
        except Irreducible as fault:
            return frozenset({str(fault)})
        return lacking

    def chain(self, program: Program) -> Chain:
        """The steps from ``program`` to what is searched; raises Irreducible."""
        return self._reduced(_tidied(program))

    def _reduced(self, tidied: Chain) -> Chain:
        return tidied.then((UNITS, *self.reductions))

    def refusal(self, missing: Iterable[str], program: Program) -> UnsupportedError:
        """The error that says why ``program`` cannot be taken, and names the solvers that can."""
        able = [name for name in takers(program.features(), self.label) if not solver_named(name).missing(program)]  # type: ignore[attr-defined]
        return UnsupportedError(self.label, set(missing), able)

    def run(self, program: Program, options: Options, control: Control) -> RawResult:
        """Search a program as it is given, one level of its objective after the other; all results are in its own units.

        ``RawResult.answer`` is a vector of shape (variables,); ``options.start`` is one too.

        Raises
        ------
        InputError, UnsupportedError, UsageError
        """
        if program.further:
            return by_priority(self.label, self.run, program, options, control)
        refuse_numbers(program)
        options = self.converted(options)
        lacking = self.lacking(program)
        if lacking:
            raise self.refusal(lacking, program)
        tidied = _tidied(program)
        result = settled(tidied.program)
        if result is not None:
            return result
        try:
            chain = self._reduced(tidied)
        except Irreducible as fault:
            raise self.refusal({str(fault)}, program) from None
        start = None if options.start is None else chain.encoded(np.asarray(options.start, dtype=np.float64))
        relay, began = _Relay(control, chain), time.perf_counter()
        raw = self.search(chain.program, replace(options, start=start), relay)
        if raw.status == "infeasible_or_unbounded":
            seconds_left = options.time_limit - (time.perf_counter() - began)
            raw = replace(raw, status=self._which(chain.program, replace(options, time_limit=seconds_left), control))
        result = self._concluded(chain.program, raw, relay)
        answer = None if result.answer is None else np.asarray(chain.vector(result.answer), dtype=np.float64)
        objective = None if answer is None else program.value(answer)
        bound = None if result.bound is None else chain.bound(result.bound)
        units = next((step for step in chain.steps if isinstance(step, Scaled)), None)
        counted = [v if v is None or units is None else units.counted(v) for v in (objective, bound)]
        if bound is not None and result.status == "optimal" and chain.exactness is Exactness.EXACT and not _meet(*counted):
            # What is near without a constant need not be near with one.
            result = replace(result, status="feasible", limit=raw.limit if raw.limit != "none" else "gap")
        if result.status == "feasible" and not program.is_integer:
            objective = None  # on no vertex, a point is as good as its residuals: what it is worth is for the judge to say
        return replace(
            result,
            answer=answer,
            objective=objective if raw.objective is None else chain.value(raw.objective),
            bound=bound,
            row_duals=None if result.row_duals is None else chain.duals(result.row_duals),
            holds=chain.exactness,
            links=chain.links,
        )

    @abstractmethod
    def search(self, program: Any, options: Options, control: Control) -> RawResult:
        """The solver's result for a program that went through the chain, in that program's units.

        ``answer`` may be any point that it left behind, ``status`` its own word: points are checked, objectives computed, a claim of an
        optimum without a bound that meets it taken back, and ``infeasible_or_unbounded`` told apart by ``run``. Who states ``objective``
        vouches for status and point, which are handed on as claims.
        """

    def _which(self, program: Any, options: Options, control: Control) -> str:
        if options.time_limit <= 0 or control.stopped:
            return "infeasible_or_unbounded"
        bare = replace(program, quadratic=None, offset=0.0, variables=tuple(replace(b, cost=np.zeros(b.size)) for b in program.variables))
        again = self.search(bare, replace(options, start=None, iterations=None, extra={}), _Relay(control, None))
        return WITHOUT_OBJECTIVE.get(again.status, "infeasible_or_unbounded")

    def _concluded(self, program: Any, said: RawResult, control: Control) -> RawResult:
        """The solver's result without the claims that its point or bound does not support."""
        if said.status not in ("optimal", "feasible", "unknown"):
            return replace(said, limit="none" if said.status != "error" else said.limit, answer=None, bound=None, row_duals=None)
        status, limit, bound, message = said.status, said.limit, said.bound, said.message
        if limit == "iterations" and program.is_integer:
            limit = "nodes"
        points = (said.answer, control.answer)
        x = next((p for p in points if p is not None and program.residual(p) <= self.feasible_tolerance), None)
        if x is None and said.objective is not None:
            return said
        if x is None:
            if not message and (status != "unknown" or said.answer is not None):
                message = f"{self.title or self.label} reports a point that is not feasible within {self.feasible_tolerance:g}"
            elif not message:
                end = {"none": "", "interrupt": " before it was interrupted"}.get(limit, f" within the {limit} limit")
                message = f"{self.title or self.label} found no feasible point{end}"
            bound = None if status == "optimal" else bound  # an optimum that nobody can show says nothing of what is better
            return replace(said, status="unknown", limit=limit, answer=None, bound=bound, message=message)
        value = program.value(x)
        if status == "optimal" and bound is None and not program.is_integer:
            bound = value
        vouched = status == "optimal" and bound is None and said.objective is not None
        if vouched or _meet(value, bound):
            status, limit = "optimal", "none"
        else:
            status, limit = "feasible", "gap" if status == "optimal" else limit
        return replace(said, status=status, limit=limit, answer=x, bound=bound, message=message)


def _tidied(program: Program) -> Chain:
    return Chain(program).then((UNIQUE_ENTRIES, WHOLE_BOUNDS))


def _meet(value: float | None, bound: float | None) -> bool:
    return value is not None and bound is not None and abs(bound - value) <= EQUAL_TOLERANCE * max(1.0, abs(value))


class _Relay(Control):
    """Passes on what a backend publishes, translated from the last program of a chain to the first; nothing without a chain."""

    def __init__(self, outer: Control, chain: Chain | None) -> None:
        super().__init__()
        self._outer, self._chain, self._counts_for = outer, chain, outer
        mine = weakref.ref(self)

        def end() -> None:  # the outer one may live for many programs
            inner = mine()
            if inner is not None:
                inner.stop()

        outer.on_stop(end)

    def publish(
        self, answer: Any = None, objective: float | None = None, bound: float | None = None, evidence: tuple[Evidence, ...] = ()
    ) -> None:
        super().publish(answer, objective, bound, evidence)
        chain = self._chain
        if chain is not None:
            vector = None if answer is None else np.asarray(chain.vector(answer), dtype=np.float64)
            value = None if vector is None else chain.source.value(vector)
            self._outer.publish(vector, value, None if bound is None else chain.bound(bound), evidence)


def settled(program: Program) -> RawResult | None:
    """The result where no search is needed: crossed limits, empty rows that exclude 0, no variables; else None."""
    for lower, upper, name, what in (
        (program.lower, program.upper, program.variable_name, "bounds of"),
        (program.row_lower, program.row_upper, program.row_name, "sides of row"),
    ):
        crossed = lower > upper
        if crossed.any():
            at = int(np.argmax(crossed))
            return RawResult("infeasible", message=f"the {what} {name(at)} cross: {lower[at]:g} > {upper[at]:g}")
    empty = np.ones(program.num_rows, dtype=bool)
    empty[np.repeat(np.arange(program.num_rows), np.diff(program.indptr))[program.data != 0]] = False
    fails = empty & ((program.row_lower > 0) | (program.row_upper < 0))  # by less than a solver's tolerance, too
    if fails.any():
        return RawResult("infeasible", message=f"row {program.row_name(int(np.argmax(fails)))} adds up nothing and excludes 0")
    if program.num_variables:
        return None
    duals = np.zeros(program.num_rows)
    return RawResult("optimal", answer=np.zeros(0), objective=program.offset, bound=program.offset, row_duals=duals)


def kinds_of(backend: type[ProgramBackend]) -> list[str]:
    """Classes of programs that a backend takes: ``LP``, ``MILP``, ..."""
    further = [LINEAR, CIRCUITS, *(frozenset({cone}) for cone in CONES)]
    asked = (f | more for f in (LINEAR, INTEGERS, QUADRATIC, INTEGERS | QUADRATIC) for more in further)
    return sorted({described(f) for f in asked if backend.takers(f)})


def takers(features: frozenset[str], but: str = "") -> list[str]:
    """Installed solvers that take programs of ``features``, other than ``but``."""
    backends = [BACKENDS[name] for name in BACKENDS]
    able = [n for b in backends if issubclass(b, ProgramBackend) and b.installed() for n in b.takers(features)]
    return [name for name in able if name != but]
