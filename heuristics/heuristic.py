"""The contract of heuristics: approximations that solve a problem directly and say what they guarantee."""

import inspect
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any, ClassVar, TypeVar

import numpy as np

from ..formulations.evidence import Evidence, Guarantee
from ..formulations.problem import Problem
from ..formulations.programs.exactness import Exactness
from ..formulations.stop import Stop
from ..instances.registry import Registry
from ..solvers.backend import Control, Options, RawResult
from ..solvers.linear_programs import LinearPrograms
from ..solvers.own_options import own_options

CUT_SHORT = "the time was up, or it was asked to stop"


@dataclass(frozen=True)
class Context:
    """Time, randomness and the line to the caller for a run of a heuristic.

    Parameters
    ----------
    rng : numpy.random.Generator
        The only source of randomness.
    time_limit : float, seconds
        Wall time it may take.
    start : answer, optional
    publish : callable
        ``publish(answer)`` reports a better answer.
    stop : Stop
        The wish to end; ``context.begin()`` adds the time.
    linear : LinearPrograms
        The solver for linear programs that it meets.
    """

    rng: "np.random.Generator"
    time_limit: float
    start: Any
    publish: Callable[[Any], None]
    stop: Stop
    linear: LinearPrograms

    def begin(self) -> Stop:
        """The end of a heuristic that starts now: its time is up, or it is asked to end."""
        return self.stop.within(self.time_limit)


@dataclass(frozen=True)
class Outcome:
    """An answer, the guarantee that holds for it on this instance, and evidence for bounds found on the way.

    ``limit`` says what cut it short: ``time``, ``interrupt``, or ``none``.
    """

    answer: Any
    guarantee: Guarantee | None = None
    evidence: tuple[Evidence, ...] = ()
    statistics: dict[str, Any] = field(default_factory=dict)
    message: str = ""
    limit: str = "none"


@dataclass(frozen=True)
class Heuristic:
    """A heuristic, registered in ``HEURISTICS``.

    Parameters
    ----------
    name : str
        Used with ``--heuristic``.
    families : tuple of str
        Families of the problems it takes.
    features : frozenset of str
        Features of the problem that it can handle.
    run : callable
        ``run(problem, context, **parameters) -> Outcome``. Keyword parameters are its options.
    summary : str
        One line.
    stated : str
        The guarantee in words, or "no guarantee".
    refuses : callable, optional
        Further reasons why it cannot take a problem, as feature names.
    honours : frozenset of str
        See ``Backend.honours``.
    opens : callable
        Whether, where the user names no method, the solver of a problem starts from its answer, since solvers find little by themselves,
        or take long to begin.
    """

    name: str
    families: tuple[str, ...]
    features: frozenset[str]
    run: Callable[..., Outcome]
    summary: str
    stated: str = "no guarantee"
    refuses: Callable[[Any], frozenset[str]] = lambda problem: frozenset()
    honours: frozenset[str] = frozenset()
    opens: Callable[[Any], bool] = lambda problem: False

    def missing(self, problem: Problem) -> frozenset[str]:
        """Features of ``problem`` that it lacks; empty if it can take it."""
        if problem.family not in self.families:
            return frozenset({f"{problem.family} problems"})
        return (problem.features() - self.features) | self.refuses(problem)

    def parameters(self) -> dict[str, Any]:
        """Names and defaults of its parameters."""
        signature = inspect.signature(self.run).parameters.values()
        return {p.name: p.default for p in signature if p.kind is inspect.Parameter.KEYWORD_ONLY}

    def check_parameters(self, given: dict[str, Any]) -> None:
        """Raise UsageError for a parameter that it does not have."""
        own_options(self.name, given, dict.fromkeys(self.parameters()))


HEURISTICS: Registry[Heuristic] = Registry("heuristic", "waybound.heuristics.*", group="waybound.heuristics")

Run = TypeVar("Run", bound=Callable[..., Outcome])


def heuristic(
    name: str, family: str | tuple[str, ...], features: Iterable[str], summary: str, stated: str = Heuristic.stated, **further: Any
) -> Callable[[Run], Run]:
    """Register the decorated function as the ``run`` of a heuristic for one family of problems or several; ``further`` as of it."""

    def add(run: Run) -> Run:
        families = (family,) if isinstance(family, str) else family
        HEURISTICS.enter(Heuristic(name, families, frozenset(features), run, summary, stated, **further))
        return run

    return add


@dataclass(frozen=True)
class HeuristicWork:
    """A heuristic at its work: picklable, and called with a ``Control``."""

    name: str
    problem: Problem
    options: Options

    modules: ClassVar[tuple[str, ...]] = ("numba",)

    def __call__(self, control: Control) -> RawResult:
        o, stop = self.options, Stop()
        control.on_stop(stop.ask)
        context = Context(
            rng=np.random.default_rng(o.seed), time_limit=o.time_limit, start=o.start, publish=control.publish, stop=stop,
            linear=LinearPrograms(o.lp_solver, o.seed, o.threads),
        )  # fmt: skip
        outcome = HEURISTICS[self.name].run(self.problem, context, **o.extra)
        return RawResult(
            "unknown", outcome.limit, outcome.answer, statistics=outcome.statistics, message=outcome.message, evidence=outcome.evidence,
            holds=Exactness.NEITHER, guarantee=outcome.guarantee,
        )  # fmt: skip
