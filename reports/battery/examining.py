"""Solvers on the battery: what each says of programs whose truth is known, through waybound's own backends."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from ...formulations.programs.program import Program
from ...formulations.programs.reductions.units import scaled
from ...instances.errors import UnsupportedError, UsageError, WayboundError
from ...solvers.backend import BACKENDS, Control, Options, RawResult, solver_named
from ...solvers.isolation import run_in_process
from ...solvers.program_backend import ProgramBackend
from .cases import Case, Draw, cases

EQUAL = 1e-5
"""Share of what an objective adds up, or of the unit in which solvers count it, by which an optimum may differ: solvers let rows be
exceeded by 1e-6 and more."""

TIME_LIMIT = 10.0
"""Seconds for one case, which takes milliseconds."""

PROCESS_CASES = 250
"""Cases that one process gets: a crash costs one case, and what a library leaks is given back."""

RIGHT, REFUSED = "right", "refused"
WRONG = ("wrong optimum", "false infeasible", "false unbounded")
GAVE_UP = "gave up"
VERDICTS = (RIGHT, *WRONG, GAVE_UP, REFUSED)


@dataclass(frozen=True)
class Outcome:
    """A solver's word on one case, and one of ``VERDICTS`` on it: ``refused`` where the solver does not take such programs.

    ``number`` is that of the case in its draw, ``seconds`` the wall time of reductions and search.
    """

    number: int
    kind: str
    form: str
    truth: str
    verdict: str
    said: str
    seconds: float


@dataclass(frozen=True)
class Examination:
    """The outcomes of one solver on a draw."""

    solver: str
    version: str
    outcomes: tuple[Outcome, ...]
    interrupted: bool = False

    @property
    def taken(self) -> list[Outcome]:
        """Outcomes of the cases that the solver takes."""
        return [o for o in self.outcomes if o.verdict != REFUSED]

    @property
    def wrong(self) -> list[Outcome]:
        """Outcomes that are false."""
        return [o for o in self.outcomes if o.verdict in WRONG]


def examine(
    solver: str,
    draw: Draw,
    own: dict[str, Any] | None = None,
    *,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Examination:
    """Give a solver of ``examinable()`` the cases of a draw, in processes of their own, with ``time_limit`` seconds for each.

    ``own`` holds options of the solver's own, which go before waybound's; ``progress(done, total)`` hears how far it is. Ctrl-C ends the
    examination, and what it has until then is returned. Raises UsageError or MissingPackageError if there is no such solver, it takes no
    programs, or refuses an option.
    """
    backend = solver_named(solver)
    if not isinstance(backend, ProgramBackend):
        raise UsageError(f"{solver} takes problems, not programs; the battery is for {', '.join(examinable())}", "unsupported")
    outcomes, interrupted = list[Outcome](), False
    while len(outcomes) < draw.count and not interrupted:
        begun = len(outcomes)
        numbers = range(begun, min(draw.count, begun + PROCESS_CASES))

        def hear(event: dict[str, Any], begun: int = begun) -> None:
            progress(begun + int(event["objective"] or 0), draw.count)

        control = Control(hear)
        work = ExaminationWork(solver, draw, numbers, Options(time_limit=time_limit, extra=dict(own or {})))
        try:
            message = run_in_process(work, Options(time_limit=(time_limit + 1.0) * len(numbers)), control).message
        except KeyboardInterrupt:
            interrupted = True
        outcomes += control.answer or ()
        if len(outcomes) < numbers.stop and not interrupted:
            (case,) = cases(draw, range(len(outcomes), len(outcomes) + 1))
            outcomes.append(_outcome(case, GAVE_UP, message, 0.0))
    return Examination(solver, version_of(backend), tuple(outcomes), interrupted)


@dataclass(frozen=True)
class ExaminationWork:
    """Some cases of a draw for one solver: picklable, publishes all outcomes so far after each case."""

    solver: str
    draw: Draw
    numbers: range
    options: Options

    @property
    def modules(self) -> tuple[str, ...]:
        """Modules that are loaded before time is counted."""
        return solver_named(self.solver).modules

    def __call__(self, control: Control) -> RawResult:
        outcomes: list[Outcome] = []
        for case in cases(self.draw, self.numbers):
            outcomes.append(outcome(self.solver, case, self.options))
            control.publish(tuple(outcomes), float(len(outcomes)))
        return RawResult("feasible")


def outcome(solver: str, case: Case, options: Options) -> Outcome:
    """Give a solver one case; raises UsageError for options that it refuses."""
    backend = solver_named(solver)
    assert isinstance(backend, ProgramBackend)
    began = time.perf_counter()
    try:
        result = backend.run(case.program, options, Control())
    except UnsupportedError as fault:
        return _outcome(case, REFUSED, str(fault), time.perf_counter() - began)
    except UsageError:
        raise
    except Exception as fault:
        kind = "" if isinstance(fault, WayboundError) else f"{type(fault).__name__}: "
        return _outcome(case, GAVE_UP, f"{kind}{fault}", time.perf_counter() - began)
    seconds = time.perf_counter() - began
    return _outcome(case, verdict(case, result), said(result), seconds)


def _outcome(case: Case, judged: str, words: str, seconds: float) -> Outcome:
    return Outcome(case.number, case.kind, case.form, str(case.truth), judged, words, seconds)


def said(result: RawResult) -> str:
    """A solver's word in one line."""
    parts = [result.status]
    if result.objective is not None:
        parts.append(f"at {result.objective:.12g}")
    if result.bound is not None:
        parts.append(f"bound {result.bound:.12g}")
    return " ".join(parts) + (f": {result.message}" if result.message else "")


def verdict(case: Case, result: RawResult) -> str:
    """Hold a solver's last word against the truth."""
    known, status = case.truth, result.status
    if status == "infeasible_or_unbounded":
        return "false infeasible" if known.status == "optimal" else GAVE_UP
    if status == "infeasible":
        return RIGHT if known.status == "infeasible" else "false infeasible"
    if status == "unbounded":
        return RIGHT if known.status == "unbounded" else "false unbounded"
    if status not in ("optimal", "feasible"):
        return GAVE_UP
    if known.status != "optimal":  # a point is no contradiction in an unbounded program, an optimum is
        return "wrong optimum" if known.status == "infeasible" or status == "optimal" else GAVE_UP
    assert known.value is not None
    sign, room = 1 if case.program.sense == "min" else -1, Fraction(EQUAL) * _size(case.program, result.answer, known.value)
    if result.bound is not None and np.isfinite(result.bound) and sign * (Fraction(result.bound) - known.value) > room:
        return "wrong optimum"
    if result.objective is None:  # a limit left a vector of which nothing is claimed
        return GAVE_UP
    if sign * (Fraction(result.objective) - known.value) < -room:
        return "wrong optimum"
    if status == "feasible":
        return GAVE_UP
    return RIGHT if sign * (Fraction(result.objective) - known.value) <= room else "wrong optimum"


def _size(program: Program, x: Any, value: Fraction) -> Fraction:
    """The size of the objective's terms at ``x``, added up without signs, or the unit of its program once it is scaled."""
    total = float(np.abs(program.cost) @ np.abs(x)) + abs(program.offset)
    if program.quadratic is not None:
        total += float(np.abs(x) @ (abs(program.quadratic) @ np.abs(x))) / 2
    unit = abs(scaled(program).value(1.0))
    return max(Fraction(total), abs(value), Fraction(unit))


def examinable() -> list[str]:
    """Names of the installed solvers that take programs, and of those within them."""
    names: list[str] = []
    for name in BACKENDS:
        backend = BACKENDS[name]
        if issubclass(backend, ProgramBackend) and backend.installed():
            names += backend.available()
    return names


def version_of(backend: ProgramBackend) -> str:
    """Version of the package, and of the library that a solver within it comes in where that is another one."""
    from importlib.metadata import PackageNotFoundError, version

    own = backend.version()
    if backend.library is None:
        return own
    try:
        return f"{own}, {backend.library} {version(backend.library)}"
    except PackageNotFoundError:
        return own
