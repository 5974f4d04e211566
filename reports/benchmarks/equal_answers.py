"""Every solver and form against enumeration on random problems of the whole routing family.

With ``--out`` each problem is a line of JSON there as soon as it is done, those that are there already are not done again, and the tables
are of all of them. With ``--risky`` durations are uncertain, with risks of overrunning limits. Exits with 1 where an exact solver disagrees
beyond 1e-6 of the optimum, a certificate does not hold, or the judge refuses an answer.

Problems of up to seven customers are drawn by ``routing_variants``; which solvers and forms take one, their declarations say. Engines and
heuristics are run once, for few iterations: they may miss the optimum, but never beat it nor break a limit.
"""

import json
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import waybound as wb
from waybound.extending import HEURISTICS, ProgramBackend

from ...formulations.certificate import Certificate, certify, check_certificate
from ...formulations.tolerance import EQUAL
from ...solvers.backend import BACKENDS, Control, Engine, Options, solver_named
from ...solving.bounding import find_bounds
from ...solving.method import missing_features
from ...solving.request import Request
from ...solving.solve import solve
from ._harness import Option, command, find_tests, markdown
from .routing_variants import drawn, features_of, risky as at_risk

find_tests()

from truth.routing import RoutingTruth  # noqa: E402

AGREE = 1e-6
"""Share of the optimum by which an exact solver's value may differ."""

TIME_LIMIT = 10.0
"""Seconds for one program, which mostly takes hundredths of one; what is unfinished then is counted as such."""

WORK = {"pyvrp": 100, "ortools": 30}
"""Iterations of engines."""

WHOLE = 5
"""One in so many problems goes all the way through ``solve``, with its solvers and forms in turn."""

ENGINE_TIME = 4.0
"""Seconds for an engine, should its iterations take longer."""

OURS = ("bounds", "solve")
"""Names of what is examined beside solvers: evidence for bounds, and all of ``solve`` with one solver."""

BOUND_TIME = 0.25
"""Seconds to look for evidence."""

AGREES, DIFFERS, UNFINISHED, REFUSED = "agrees", "differs", "unfinished", "refused"
OPTIMUM, WORSE, NOTHING, FALSE = "optimum", "worse", "no answer", "false"
EXACT, FREE = (AGREES, DIFFERS, UNFINISHED, REFUSED), (OPTIMUM, WORSE, NOTHING, FALSE)
"""Verdicts on exact solvers, and on engines and heuristics. ``refused``: the program has what the solver does not take, and it says so."""


@dataclass
class Record:
    """The results on one problem: ``outcomes`` are solver, form (or none), verdict and seconds; ``faults`` what is false, in words."""

    number: int
    name: str
    customers: int
    features: list[str]
    optimum: list[float] | None
    outcomes: list[tuple[str, str, str, float]] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)


class _Examined:
    """One problem, its truth, and the record of what is said of it."""

    def __init__(self, number: int, problem: wb.RoutingProblem) -> None:
        self.problem, self.truth = problem, RoutingTruth(problem)
        best = self.truth.lenient
        values = None if best is None else [float(v) for v in best]
        self.record = Record(number, problem.name, len(problem.customers), sorted(features_of(problem)), values)

    def note(self, who: str, form: str, act: Callable[[], tuple[str, str] | None], failing: str = FALSE, how: str = "") -> None:
        """Record verdict, fault and seconds of ``act``, which breaks down with the verdict ``failing``; nothing where it returns None."""
        began = time.perf_counter()
        try:
            outcome = act()
        except Exception as error:
            outcome = failing, f"{type(error).__name__}{how}: {error}"
        if outcome is not None:
            verdict, fault = outcome
            self.record.outcomes.append((who, form, verdict, round(time.perf_counter() - began, 4)))
            self.record.faults += [f"{who} {form}: {fault}".replace(" : ", ": ")] if fault else []

    def equal(self, values: Sequence[float]) -> bool:
        """Compare with the values of the optimum, all levels."""
        optima = [b for b in (self.truth.best, self.truth.lenient) if b is not None]
        sizes = [float(self.truth.size) if self.truth.mixed else 0.0, *[0.0] * (len(values) - 1)]
        return any(
            all(abs(v - float(t)) <= AGREE * max(abs(float(t)), s) for v, t, s in zip(values, best, sizes, strict=True)) for best in optima
        )

    def beats(self, values: Sequence[float]) -> bool:
        best = self.record.optimum
        if best is None or self.equal(values):
            return best is None
        signs = [1.0 if s == "min" else -1.0 for s in self.problem.senses]
        return [s * v for s, v in zip(signs, values, strict=True)] < [s * v for s, v in zip(signs, best, strict=True)]

    def judged(self, answer: Any, evaluation: wb.Evaluation) -> str:
        """The fault in the judge's word on an answer; empty where there is none."""
        exact = self.truth.value(answer)
        if evaluation.feasible != (exact is not None):
            return f"the judge and enumeration differ on {answer}"
        if exact is not None and any(
            abs(a - float(b)) > EQUAL * max(abs(float(b)), float(self.truth.size)) for a, b in zip(evaluation.values, exact, strict=True)
        ):
            return f"the judge says {evaluation.values}, it is {[float(v) for v in exact]}"
        return "" if evaluation.feasible else f"refused by the judge: {evaluation.violations[0].message}"

    def certified(self, certificate: Certificate, evaluation: wb.Evaluation | None) -> str:
        """The fault in a certificate, read back as from a file; empty where there is none."""
        try:
            checked = check_certificate(self.problem, json.loads(json.dumps(certificate.to_json(with_evidence=True))), evaluation)
        except wb.CheckFailedError as error:
            return f"its certificate does not hold: {error}"
        best, bound = self.truth.lenient, checked.bound
        if checked.infeasible and best is not None:
            return f"there is no answer, says {checked.bound_source}"
        if bound is None or best is None:
            return ""
        over = bound - float(best[0]) if self.problem.sense == "min" else float(best[0]) - bound
        return f"false bound {bound!r} by {checked.bound_source}" if over > EQUAL * max(abs(float(best[0])), float(self.truth.size)) else ""

    # -- methods -----------------------------------------------------------------------------------------------------

    def bounds(self) -> tuple[str, str]:
        """All evidence that is found in a moment, beside an optimum."""
        best = self.problem.evaluate(self.truth.samples[0]) if self.truth.samples else None
        unable: list[str] = []
        try:
            fault = self.certified(certify(self.problem, best, find_bounds(self.problem, BOUND_TIME, unable=unable)), best)
        except wb.CheckFailedError as contradiction:
            fault = str(contradiction)
        fault = "; ".join(([fault] if fault else []) + unable)
        return FALSE if fault else AGREES, fault

    def exact(self, solver: str, model: wb.Compiled) -> tuple[str, str]:
        """A program as its solver is given it, and what it answers before anybody else has a word."""
        backend = solver_named(solver)
        assert isinstance(backend, ProgramBackend)
        try:
            result = backend.run(model.program, Options(time_limit=TIME_LIMIT), Control())
        except wb.UnsupportedError:
            return REFUSED, ""
        values: tuple[float, ...] = ()
        fault = ""
        if result.answer is not None:
            answer = model.decode(result.answer)
            evaluation = self.problem.evaluate(answer)
            values, fault = evaluation.values, self.judged(answer, evaluation)
        same = {"optimal": bool(values) and self.equal(values), "infeasible": self.record.optimum is None}.get(result.status)
        if fault or same is False:
            return DIFFERS, fault or f"{result.status} {list(values)}, enumeration says {self.record.optimum}"
        return AGREES if same else UNFINISHED, ""

    def whole(self, solver: str, form: str) -> tuple[str, str] | None:
        """All of ``solve``: the answer, what is claimed of it, and its certificate."""
        try:
            solution = solve(self.problem, Request(solver=solver, form=form, time_limit=TIME_LIMIT, bound_time=BOUND_TIME))
        except wb.UnsupportedError:
            return None
        fault = self.certified(solution.certificate, solution.evaluation) or "; ".join(solution.faults)
        values = solution.objective if isinstance(solution.objective, list) else [solution.objective]
        if solution.status == "infeasible" and self.record.optimum is not None:
            fault = fault or f"infeasible by {solver} through {form}, optimum {self.record.optimum}"
        if solution.status == "optimal" and (None in values or not self.equal(values)):  # type: ignore[arg-type]
            fault = fault or f"optimal {values} by {solver} through {form}, enumeration says {self.record.optimum}"
        return FALSE if fault else AGREES, fault

    def engine(self, solver: str) -> tuple[str, str]:
        """Its search ends where it has published an optimum, or when its work is done."""
        engine, control = solver_named(solver), Control()
        assert isinstance(engine, Engine)
        control.goal = lambda answer, objective: self.equal(self.problem.evaluate(answer).values)
        work: dict[str, Any] = {"iterations": WORK.get(solver, 200)} if "iterations" in engine.honours else {}
        result = engine.run(self.problem, Options(time_limit=ENGINE_TIME, **work), control)
        if result.answer is not None:
            return self.free(result.answer, self.problem.evaluate(result.answer))
        if result.status == "infeasible" and self.record.optimum:
            return FALSE, f"says infeasible, optimum {self.record.optimum}"
        return NOTHING if self.record.optimum else OPTIMUM, ""

    def heuristic(self, name: str) -> tuple[str, str]:
        solution = solve(self.problem, Request(heuristic=name, time_limit=TIME_LIMIT, bound_time=0.0))
        if solution.answer is None or solution.evaluation is None:
            return NOTHING if self.record.optimum else OPTIMUM, ""
        stated, best = solution.certificate.guarantee, self.record.optimum
        fault = self.certified(solution.certificate, solution.evaluation)
        if stated is not None and best is not None and solution.evaluation.values[0] > stated.ratio * best[0] * (1.0 + AGREE):
            fault = fault or f"{solution.evaluation.values[0]} is not within {stated.ratio} of {best[0]}"
        return self.free(solution.answer, solution.evaluation, fault)

    def free(self, answer: Any, evaluation: wb.Evaluation, fault: str = "") -> tuple[str, str]:
        """The verdict on an answer of a method that claims no optimum."""
        fault = fault or self.judged(answer, evaluation)
        if not fault and self.beats(evaluation.values):
            fault = f"{evaluation.values} beats enumeration's {self.record.optimum}"
        return FALSE if fault else OPTIMUM if self.equal(evaluation.values) else WORSE, fault


def examined(number: int, problem: wb.RoutingProblem, solvers: Sequence[str] = (), heuristics: bool = True) -> Record:
    """One problem given to everything that takes it by its declarations, or to some of the solvers."""
    this, pairs = _Examined(number, problem), []
    this.note("bounds", "", this.bounds)
    compiled = {form: problem.compile(form) for form in problem.forms()}
    for name in solvers or [name for name in BACKENDS if BACKENDS[name].installed()]:
        lacks, forms = missing_features(name, problem)
        if lacks:
            continue
        if issubclass(BACKENDS[name], Engine):
            this.note(name, "", partial(this.engine, name))
        for form in forms:
            this.note(name, form, partial(this.exact, name, compiled[form]), DIFFERS)
            pairs.append((name, form))
    if pairs and number % WHOLE == 0:
        solver, form = pairs[number // WHOLE % len(pairs)]
        this.note("solve", "", partial(this.whole, solver, form), how=f" by {solver} through {form}")
    for name in HEURISTICS if heuristics else ():
        if not HEURISTICS[name].missing(problem):
            this.note(name, "", partial(this.heuristic, name))
    return this.record


def records(
    seed: int, numbers: Sequence[int], file: Path | None = None, draw: Callable[[int, int], wb.RoutingProblem] = drawn
) -> Iterator[Record]:
    """One a problem; those that ``file`` has are not made again, and new ones are written there at once."""
    known = {}
    if file is not None and file.exists():
        lines = file.read_text(encoding="utf-8").splitlines()
        known = {one.number: one for one in (Record(**json.loads(line)) for line in lines)}
    for number in numbers:
        record = known.get(number)
        if record is None:
            record = examined(number, draw(seed, number))
            if file is not None:
                with file.open("a", encoding="utf-8") as out:
                    out.write(json.dumps(asdict(record)) + "\n")
        yield record


def tables(listed: Sequence[Record]) -> list[str]:
    """Lines of Markdown: features, exact solvers through each form, engines and heuristics."""
    none = sum(r.optimum is None for r in listed)
    sizes = [r.customers for r in listed]
    lines = [f"{len(listed)} problems of {min(sizes)} to {max(sizes)} customers, {none} without an answer", ""]
    counts = Counter(name for r in listed for name in r.features)
    lines += [*markdown(("feature", "problems"), sorted(counts.items(), key=lambda item: (item[1], item[0]))), ""]
    by: dict[tuple[str, str], list[tuple[str, float]]] = defaultdict(list)
    for record in listed:
        for who, form, verdict, seconds in record.outcomes:
            by[who, form].append((verdict, seconds))

    def rows(verdicts: Sequence[str], formed: bool) -> list[list[object]]:
        cells: list[list[object]] = []
        for (who, form), outcomes in sorted(by.items()):
            if bool(form) == formed and who not in OURS:
                counted = Counter(verdict for verdict, _ in outcomes)
                spent = f"{sum(seconds for _, seconds in outcomes):.0f}"
                cells.append([who, *([form] if form else []), len(outcomes), *(counted[v] for v in verdicts), spent])
        return cells

    lines += [*markdown(("solver", "form", "problems", *EXACT, "seconds"), rows(EXACT, True)), ""]
    lines += [*markdown(("engine or heuristic", "problems", *FREE, "seconds"), rows(FREE, False)), ""]
    through = sum(any(form and verdict == AGREES for _, form, verdict, _ in r.outcomes) for r in listed)
    wrong = sum(bool(r.faults) for r in listed)
    return [*lines, f"{through} problems on which an exact solver agrees, {wrong} on which anything said was false"]


@command
def main(
    instances: int = 3000,
    first: Annotated[int, Option(help="number of the first problem")] = 0,
    seed: int = 1,
    risky: Annotated[bool, Option(help="with uncertain durations, and risks")] = False,
    out: Annotated[Path | None, Option(type=Path, help="a file of JSON lines, for runs in parts")] = None,
) -> bool:
    listed = []
    for record in records(seed, range(first, first + instances), out, at_risk if risky else drawn):
        listed.append(record)
        for fault in record.faults:
            print(f"{record.number} {record.name}: {fault}", file=sys.stderr, flush=True)
    print("\n".join(tables(listed)))
    return not any(record.faults for record in listed)
