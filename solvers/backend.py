"""The contract between ``solve`` and everything that searches for answers."""

import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..formulations.evidence import Evidence, Guarantee
from ..formulations.problem import Problem
from ..formulations.programs.exactness import Exactness, Link
from ..formulations.programs.program import Program
from ..formulations.stop import Stop
from ..instances.errors import MissingPackageError, UnsupportedError, UsageError
from ..instances.registry import Registry
from .own_options import own_options
from .packages import is_installed, version_of

STATUSES = ("optimal", "feasible", "infeasible", "unbounded", "infeasible_or_unbounded", "unknown", "error")
LIMITS = ("none", "time", "iterations", "gap", "nodes", "memory", "interrupt")

LP_SOLVER = "highs"
"""The solver of linear programs met on the way, unless the user names one: vertices, interior points and first-order steps by one
library, which can be interrupted."""


@dataclass(frozen=True)
class Options:
    """Limits and settings of a search, the same for every solver.

    Parameters
    ----------
    time_limit : float, seconds of wall time for the engine alone
    iterations : int, optional
        Work limit (PyVRP iterations, OR-Tools solutions, branch-and-bound nodes, simplex iterations for an LP):
        makes a run repeatable to the bit where the engine is.
    gap : float
        Relative gap at which a search may stop; 0 asks for a proof.
    threads : int
    seed : int
    start : answer, optional
        Where to start from.
    memory_limit : float, MB, optional
        Kept by ``isolate``.
    no_improvement : int, optional
        Iterations without a better answer after which a search ends.
    lp_solver : str
        The solver for linear programs that an engine meets on its way.
    extra : dict
        The solver's own options (``--option KEY=VALUE``); unknown ones raise UsageError.
    """

    time_limit: float = 60.0
    iterations: int | None = None
    gap: float = 0.0
    threads: int = 1
    seed: int = 1
    start: Any = None
    memory_limit: float | None = None
    no_improvement: int | None = None
    lp_solver: str = LP_SOLVER
    extra: dict[str, Any] = field(default_factory=dict)

    def asked(self) -> dict[str, Any]:
        """The limits that are set and that not every method keeps to, by name."""
        limits = {"iterations": self.iterations, "no_improvement": self.no_improvement, "gap": self.gap or None}
        return {name: value for name, value in limits.items() if value is not None}


@dataclass(frozen=True)
class LevelClaim:
    """A solver's own figures on one level of an objective in order of priority; ``bound`` is one of all answers that are no worse at the
    levels before."""

    objective: float
    bound: float | None = None


@dataclass(frozen=True)
class RawResult:
    """The result of a search as the solver reports it, unchecked.

    Parameters
    ----------
    status, limit : str
        From ``STATUSES`` and ``LIMITS``. ``optimal`` only with a proof by the solver's own account.
    answer : object, optional
        The problem's answer (engines), or the vector of the program (program backends, decoded by ``solve``).
    objective, bound : float, optional
        The solver's own claims, in the program's or problem's units and sense; None where it makes none.
    row_duals : array, optional
        Duals of a solved LP, d objective / d right side.
    statistics : dict
        Nodes, iterations, restarts, ... for the report.
    message : str
        What the user should read, such as why nothing was found.
    evidence : tuple of Evidence
        What proves bounds, for the checker to verify (engines, heuristics). Where any proves something, other methods do not bound again.
    holds : Exactness
        For what status, objective and bound are claimed, as seen from what the method was given: engines that round data say
        ``RESTRICTION``, heuristics ``NEITHER``.
    guarantee : Guarantee, optional
        What a heuristic guarantees for its answer on this instance.
    links : tuple of Link
        How what was given was written otherwise on the way to the search.
    further : tuple of LevelClaim
        Of objectives in order of priority, the levels after the first one that were searched; ``objective`` and ``bound`` are the first's.
    earlier : tuple
        Answers of earlier levels, for the case that the judge finds ``answer`` worse at one of these.
    """

    status: str
    limit: str = "none"
    answer: Any = None
    objective: float | None = None
    bound: float | None = None
    row_duals: NDArray[np.float64] | None = None
    statistics: dict[str, Any] = field(default_factory=dict)
    message: str = ""
    evidence: tuple[Evidence, ...] = ()
    holds: Exactness = Exactness.EXACT
    guarantee: Guarantee | None = None
    links: tuple[Link, ...] = ()
    further: tuple[LevelClaim, ...] = ()
    earlier: tuple[Any, ...] = ()


class Control:
    """Line between a running engine and ``solve``: incumbents go out, the wish to stop comes in. Thread-safe.

    Engines call ``publish`` for each better answer, and either poll ``stopped`` in a callback or register with
    ``on_stop`` what ends their search. Those whose own model of the problem may take long to make say when they begin and end with it.

    Attributes
    ----------
    set_up : float or None
        Seconds that the engine took before its search began, where it tells.
    setting_up : bool
        Whether it is at it.
    on_set_up : callable or None
        Hears of ``set_up``.
    """

    def __init__(self, progress: Callable[[dict[str, Any]], None] | None = None) -> None:
        self._progress = progress
        self._stop = threading.Event()
        self._lock = threading.Lock()
        self._enders: list[Callable[[], None]] = []
        self._closed = False
        self.started = time.perf_counter()
        self.answer: Any = None
        self.objective: float | None = None
        self.bound: float | None = None
        self.evidence: tuple[Evidence, ...] = ()
        self.goal: Callable[[Any, float | None], bool] | None = None
        self.nodes: int | None = None
        self.counts: dict[str, int] = {}
        self.set_up: float | None = None
        self.setting_up = False
        self.on_set_up: Callable[[float], None] | None = None
        self._counts_for: Control | None = None

    @property
    def stopped(self) -> bool:
        """Whether the engine is asked to end its search."""
        return self._stop.is_set()

    def on_stop(self, end: Callable[[], None]) -> None:
        """Call ``end`` (from another thread) when the search shall stop."""
        with self._lock:
            self._enders.append(end)
            late = self._stop.is_set()
        if late:
            end()

    def stop(self) -> None:
        """Ask the engine to stop."""
        self._stop.set()
        with self._lock:
            enders = list(self._enders)
        for end in enders:
            end()

    def close(self) -> None:
        """Ignore all that is published from now on: the caller has stopped waiting, and takes what was published so far."""
        with self._lock:
            self._closed = True

    def count(self, nodes: int, **further: int) -> None:
        """Record the nodes of branch and bound that are done, and other counts: reported with the next publication, here and by the control
        that this one passes on to."""
        self.nodes, self.counts = nodes, further
        if self._counts_for is not None:
            self._counts_for.count(nodes, **further)

    def begin_set_up(self) -> None:
        """Note that the engine begins to build its own model, which counts against its time limit."""
        self.setting_up = True

    def end_set_up(self, seconds: float) -> None:
        """Note that the model is built and the search begins; of an engine that searches several times, the first call counts."""
        if not self.setting_up:
            return
        self.setting_up, self.set_up = False, seconds
        if self.on_set_up is not None:
            self.on_set_up(seconds)

    @property
    def left(self) -> str:
        """A phrase on what is left of the work of an engine that did not return."""
        when = " while it was still setting up" if self.setting_up else ""
        return f"{when}; its last published answer is used" if self.answer is not None else f"{when}, and had published no answer"

    def publish(
        self, answer: Any = None, objective: float | None = None, bound: float | None = None, evidence: tuple[Evidence, ...] = ()
    ) -> None:
        """Report a better answer (same type as ``RawResult.answer``), its objective by the engine's count, or a bound and its evidence."""
        with self._lock:
            if self._closed:
                return
            if answer is not None:
                self.answer, self.objective = answer, objective
            if bound is not None:
                self.bound = bound
            if evidence:
                self.evidence = evidence
            seconds = time.perf_counter() - self.started
            event = {"seconds": seconds, "objective": self.objective, "bound": self.bound, "nodes": self.nodes, "counts": self.counts}
        if self._progress is not None:
            self._progress(event)
        if answer is not None and self.goal is not None and not self.stopped and self.goal(answer, objective):
            self.stop()


class Backend(ABC):
    """Anything that can be named with ``--solver``.

    Class attributes
    ----------------
    name : str
    package : str
        Its distribution, which ``pip install`` needs.
    pinned : str
        The version of it that is needed, where not every one will do.
    modules : tuple of str
        Modules that must be found (not imported) for it to be installed; by default the package.
    summary : str
        One line for ``waybound solvers``.
    interrupts : str
        What the engine does on an interrupt, where a user should know.
    needs_process : bool
        Whether it can only be stopped in a process of its own.
    honours : frozenset of str
        Of ``iterations, no_improvement, gap`` those that it keeps to; ``solve`` refuses the others by name.
    options : mapping of names to defaults, or None
        Options of its own, in the types of the defaults; checked before it starts. None if it asks the library behind it and checks itself.
    one_thread : bool
        Whether it searches on one thread, whatever it is given.
    order : int
        Where the user names no solver, the one of the lowest that can take the problem is used: by measured quality on routing files, then
        by measured speed on the linear forms of the other families, then those that take nonconvex products whatever their bounds.
    by_default : bool
        Whether it may be used where the user names no solver.
    variants : tuple of str
        Examples of solvers within it, named as ``pulp:HiGHS``; empty if it has none.
    """

    name: ClassVar[str]
    package: ClassVar[str]
    pinned: ClassVar[str] = ""
    modules: ClassVar[tuple[str, ...]]
    summary: ClassVar[str]
    interrupts: ClassVar[str] = ""
    takes: ClassVar[str]
    needs_process: bool = False
    honours: frozenset[str] = frozenset({"iterations", "gap"})
    options: ClassVar[Mapping[str, Any] | None] = MappingProxyType({})
    one_thread: ClassVar[bool] = False
    order: ClassVar[int] = 100
    by_default: ClassVar[bool] = True
    variants: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls) -> None:
        if "package" in cls.__dict__ and "modules" not in cls.__dict__:
            cls.modules = (cls.package,)

    def __init__(self, variant: str = "") -> None:
        if variant and not self.variants:
            raise UsageError(f"solver {self.name} has no variants, so {self.name}:{variant} does not exist", "unknown-name")
        self.variant = variant

    @property
    def label(self) -> str:
        """Its name as the user writes it."""
        return f"{self.name}:{self.variant}" if self.variant else self.name

    def converted(self, options: Options) -> Options:
        """``options`` with the solver's own ones converted to their types; raises UsageError for unknown ones."""
        return options if self.options is None else replace(options, extra=own_options(self.label, options.extra, self.options))

    @classmethod
    def installed(cls) -> bool:
        """Whether its modules can be found; imports nothing heavy."""
        return all(is_installed(m.split(".")[0]) for m in cls.modules)

    @classmethod
    def requirement(cls) -> str:
        """The package as ``pip install`` takes it, with its version where only that one will do."""
        return f"{cls.package}=={cls.pinned}" if cls.pinned else cls.package

    @classmethod
    def version(cls) -> str:
        """Version of the distribution, without importing it."""
        from importlib.metadata import PackageNotFoundError

        try:
            return version_of(cls.package)
        except PackageNotFoundError:
            return "not installed"


@dataclass(frozen=True)
class Needs:
    """Whether and how an engine can run on a problem.

    ``missing``: features of the problem that the engine lacks; where there are any, the others are not filled in. ``memory``, bytes.
    ``set_up_seconds``: before its search begins. ``apart``: whether it needs a process of its own to be stopped.
    """

    missing: frozenset[str]
    memory: float = 0.0
    set_up_seconds: float = 0.0
    apart: bool = False


class Engine(Backend):
    """Solves problems of the features it declares.

    Class attributes
    ----------------
    family : str
        Of the problems it takes.
    features : frozenset of str
        Of problems that it can handle.
    bounds_itself : bool
        Whether it proves bounds on the way; others have some found before and beside their search, which ends where nothing is left to
        gain.
    """

    takes = "problem"
    family: ClassVar[str]
    features: ClassVar[frozenset[str]]
    bounds_itself: ClassVar[bool] = False

    def needs(self, problem: Problem) -> Needs:
        """Whether the engine can take ``problem``, and what a run would need, in one answer."""
        missing = self.missing(problem)
        return Needs(missing) if missing else Needs(missing, self.memory(problem), self.set_up_seconds(problem), self.apart(problem))

    def missing(self, problem: Problem) -> frozenset[str]:
        """Features of ``problem`` that the engine lacks; empty if it can take it."""
        if problem.family != self.family:
            return frozenset({f"{problem.family} problems"})
        return problem.features() - self.features

    def unasked(self, problem: Problem) -> bool:
        """Whether the engine may be the default solver for ``problem``."""
        return self.by_default

    def apart(self, problem: Problem) -> bool:
        """Whether the search can only be stopped in a process of its own: for all problems, or for this one."""
        return self.needs_process

    def begin(self, problem: Problem, options: Options, control: Control) -> Stop:
        """The stop of a search that begins now; raises UnsupportedError for a feature that the engine lacks, UsageError for an option of
        another name or type."""
        lacking = self.missing(problem)
        if lacking:
            raise UnsupportedError(self.name, lacking)
        self.converted(options)
        stop = Stop(options.time_limit)
        control.on_stop(stop.ask)
        return stop

    def memory(self, problem: Problem) -> float:
        """Bytes that its own model of ``problem`` takes; 0 where that is little."""
        return 0.0

    def set_up_seconds(self, problem: Problem) -> float:
        """About how many seconds its own model of ``problem`` takes to build; decides whether a run is begun at all."""
        return 0.0

    @abstractmethod
    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """Search. ``RawResult.answer`` is the problem's answer; ``options.start`` is one too."""


def solver_named(name: str) -> Backend:
    """The solver of that name, ready to run; raises UsageError or MissingPackageError where there is none."""
    base, colon, variant = name.partition(":")
    kind = BACKENDS[base]
    if colon and not variant:
        raise UsageError(f"{name!r} names no solver within {base}; write {base} or {base}:NAME", "unknown-name")
    if not kind.installed():
        raise MissingPackageError(f"solver {base} needs the package {kind.package}: pip install {kind.requirement()}")
    return kind(variant) if variant else kind()


@dataclass(frozen=True)
class SolverWork:
    """A solver at its work: picklable, and called with a ``Control``.

    ``solver``: its name, with the variant where there is one: ``pulp:HiGHS``.
    """

    solver: str
    target: Problem | Program
    options: Options

    @property
    def modules(self) -> tuple[str, ...]:
        """Modules that are loaded before time and memory are counted."""
        return solver_named(self.solver).modules

    def __call__(self, control: Control) -> RawResult:
        return solver_named(self.solver).run(self.target, self.options, control)  # type: ignore[attr-defined,no-any-return]


BACKENDS: Registry[type[Backend]] = Registry("solver", "waybound.solvers.backends", "waybound.solvers.engines.*", group="waybound.solvers")
