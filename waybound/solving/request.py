"""A request to solve: method, form, limits and options."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any

from ..formulations.problem import PROBLEMS, Problem
from ..formulations.programs.compiled import Compiled
from ..formulations.programs.program import Program
from ..instances.errors import UsageError
from ..instances.limits import check_number, check_whole
from ..solvers.backend import Options
from ..solvers.linear_programs import LinearPrograms, linear_programs
from .answers import start_given


@dataclass(frozen=True, kw_only=True)
class Request:
    """The settings of ``waybound.solve``, which documents them; ``start`` is an answer of the problem here.

    ``notes`` are what a user should be told of the reading of the start.
    Raises UsageError for a limit that is none.
    """

    solver: str | None = None
    heuristic: str | None = None
    form: str | None = None
    relax: bool = False
    time_limit: float = 60.0
    bound_time: float | None = None
    iterations: int | None = None
    gap: float = 0.0
    seed: int = 1
    threads: int = 1
    start: Any = None
    isolate: bool = False
    memory_limit: float | None = None
    no_improvement: int | None = None
    lp_solver: str | None = None
    options: Mapping[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        check_number("time_limit", self.time_limit, above=0)
        check_number("gap", self.gap)
        check_whole("seed", self.seed)
        check_whole("threads", self.threads, least=1)
        for name in ("iterations", "no_improvement"):
            if getattr(self, name) is not None:
                check_whole(name, getattr(self, name), least=1)
        if self.bound_time is not None:
            check_number("bound_time", self.bound_time)
        if self.memory_limit is not None:
            check_number("memory_limit", self.memory_limit, above=0)
        if self.heuristic is not None and (self.solver is not None or self.form is not None or self.relax):
            raise UsageError("a heuristic takes no solver, form or relaxation")

    @property
    def isolated(self) -> bool:
        return self.isolate or self.memory_limit is not None

    @property
    def bound_budget(self) -> float:
        """Seconds for bounding."""
        return max(1.0, self.time_limit / 10.0) if self.bound_time is None else self.bound_time

    @cached_property
    def linear(self) -> LinearPrograms:
        """The solver of the linear programs that are met on the way; raises UsageError for a solver that takes none."""
        return linear_programs(self.lp_solver, self.seed, self.threads)

    def search_options(self) -> Options:
        """The part of the request that the method receives."""
        return Options(
            self.time_limit, self.iterations, self.gap, self.threads, self.seed, self.start, self.memory_limit, self.no_improvement,
            self.linear.solver, dict(self.options),
        )  # fmt: skip


def request_of(problem: Problem | Compiled, *, start: Any = None, options: Mapping[str, Any] | None = None, **settings: Any) -> Request:
    """The keywords of ``waybound.solve`` as a request; those that are no settings of it are options of the method.

    Raises UsageError, InputError for a setting or a start that cannot be one.
    """
    known = {name: settings.pop(name) for name in _SETTINGS if name in settings}
    request = Request(**known, options={**(options or {}), **settings})
    answer, notes = start_given(problem.problem if isinstance(problem, Compiled) else problem, start)
    return replace(request, start=answer, notes=notes)


def vector_problem(program: Program) -> Problem:
    """A bare program as a problem, whose answers are vectors."""
    return PROBLEMS["arrays"](program, "arrays", {})


def searchable(problem: Any) -> Problem | Compiled:
    """A bare program as a compiled one, anything else as it is; raises UsageError for what is no problem."""
    if isinstance(problem, Program):
        return vector_problem(problem).compile()
    if not isinstance(problem, Problem | Compiled):
        raise UsageError(
            f"solve takes a problem or a program, not {type(problem).__name__}; read(path) makes a problem of a file", "malformed"
        )
    return problem


_SETTINGS = tuple(field.name for field in fields(Request) if field.name not in ("start", "options", "notes"))
