"""The functions that users call: read, generate, solve, check, judge, bound, explain. ``waybound`` re-exports them."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .instances.errors import InputError, UsageError
from .instances.limits import check_number, check_whole

if TYPE_CHECKING:
    from .formulations.certificate import Certificate
    from .formulations.problem import Problem
    from .formulations.programs.compiled import Compiled
    from .formulations.programs.program import Program
    from .formulations.solution import Solution
    from .instances.instance import Instance
    from .solving.explaining import Explanation
    from .solving.recording import Progress
    from .solving.search_log import Log

Source = str | PathLike[str]


def read_source(
    path: Source,
    format: str | None = None,  # noqa: A002
    problem: str | None = None,
    settings: dict[str, Any] | None = None,
) -> Instance:
    """The instance in a file, or the bundled one of that name where there is no such file; see ``read_instance``."""
    from .instances.bundled import bundled_names, bundled_path
    from .instances.reading import read_instance
    from .instances.suggestions import did_you_mean

    hint = did_you_mean(path, bundled_names()) if isinstance(path, str) else ""
    if isinstance(path, str) and hint and not Path(path).exists():
        if path not in bundled_names():
            raise InputError(f"no such file, and no bundled instance of that name{hint}", "file", file=path)
        return read_instance(bundled_path(path), format, problem, settings)
    return read_instance(path, format, problem, settings)


def read(
    path: Source,
    *,
    format: str | None = None,  # noqa: A002
    problem: str | None = None,
    convention: str | None = None,
    **settings: Any,
) -> Problem:
    """The problem that a file holds.

    Parameters
    ----------
    path : path-like or str
        A file, or the name of a bundled instance such as ``"demo-c25"``.
    format : str, optional
        Recognised from the content by default.
    problem : str, optional
        Another problem that the file's data allow (``"tsp"``, ``"cvrp"``, ``"winner-takes-all"``, ...).
    convention : str, optional
        How distances are rounded: ``file, exact, trunc1`` (``dimacs``), ``trunc2, round, ceil``.
    **settings
        Changes of the data, as with ``--set``: ``customers=25``, ``vehicles=3``, ``vehicles="unlimited"``,
        ``vehicles_exactly=17``, ``capacity=100``, ``objective="vehicles then total-cost"``; ``fractional=True`` for a bottleneck problem.
        Tables of sites (CSV, GeoJSON) take what ``RoutingProblem.from_frame`` takes: ``speed=50, time_unit="min", fleet=frame``, ...

    Returns
    -------
    Problem

    Raises
    ------
    InputError
        Naming file, line, what was expected and what was found.
    UsageError
        For a name or a setting that does not exist.

    Examples
    --------
    >>> problem = read("demo-c25", convention="trunc1")
    >>> problem.problem
    'vrptw'
    """
    given = _dashed(settings)
    return problem_of(read_source(path, format, problem, given), problem, convention, given)


def problem_of(instance: Instance, problem: str | None, convention: str | None, settings: Mapping[str, Any]) -> Problem:
    """The problem that ``read`` makes of an instance."""
    from .formulations.problem import problem_from_instance

    return problem_from_instance(instance, problem, **_settings(convention, settings))


def generate(kind: str, *, seed: int = 1, problem: str | None = None, convention: str | None = None, **settings: Any) -> Problem:
    """A problem from a seeded generator; the same seed gives the same problem.

    Parameters
    ----------
    kind : str
        Name of a generator: ``solomon, uchoa, random, sata, sensing-regular, sensing-ring, sensing-geometric, coverage, risky-grid``.
    seed : int
        Of all random draws.
    problem, convention : str, optional
        As in ``read``.
    **settings
        The generator's own.

    Raises
    ------
    UsageError
        For a generator or a setting that does not exist.
    """
    from .formulations.problem import problem_from_instance
    from .instances.generating import generate as make

    instance = make(kind, seed, **_dashed(settings))
    return problem_from_instance(instance, problem, **({} if convention is None else {"convention": convention}))


def solve(
    problem: Problem | Compiled | Program,
    solver: str | None = None,
    *,
    heuristic: str | None = None,
    form: str | None = None,
    relax: bool = False,
    time_limit: float = 60.0,
    bound_time: float | None = None,
    iterations: int | None = None,
    gap: float = 0.0,
    seed: int = 1,
    threads: int = 1,
    start: Any = None,
    progress: Progress | None = None,
    log: Log = None,
    isolate: bool = False,
    memory_limit: float | None = None,
    no_improvement: int | None = None,
    lp_solver: str | None = None,
    options: dict[str, Any] | None = None,
    **parameters: Any,
) -> Solution:
    """Solve a problem with a solver or a heuristic, check the answer, and bound it.

    Parameters
    ----------
    problem : Problem, Compiled or Program
        As ``read`` or its class makes it; or a program, whose answer is a vector.
    solver : str, optional
        A name of ``solvers()``; ``pulp:HiGHS`` names a solver within a solver. Without solver and heuristic, the first
        installed one that can take the problem.
    heuristic : str, optional
        A name of ``heuristics()``; its parameters as keywords or in ``options``.
    form : str, optional
        For solvers that take programs; the problem's first form by default.
    relax : bool
        Drop integrality: the optimum is a bound.
    time_limit : float, seconds
        Wall time for the engine alone.
    bound_time : float, seconds, optional
        Budget for bounding after it, or beside it on a free core, and then for second opinions on what was claimed: a tenth of the limit,
        at least 1 s, by default; 0 turns it off.
    iterations : int, optional
        Limit on work: iterations, nodes or solutions, whichever the method counts. Makes a run repeatable to the bit.
    gap : float
        Relative gap at which the search may stop; 0 asks for a proof.
    seed, threads : int
        The same seed gives the same answer where no time limit decides; threads that a solver may use, where it can use several.
    memory_limit : float, MB, optional
        Beyond what the process takes idle; with ``isolate``, on Linux.
    no_improvement : int, optional
        Iterations without a better answer after which the search ends. What a method does not keep to is refused by name.
    start : answer, Solution, mapping or path, optional
        What to start from: an answer of the problem, or a list that says one (routing: routes as lists of site indices or ids); a
        ``Solution``; the JSON of either; a solution file.
    progress : callable, optional
        Receives ``{"phase", "seconds", "objective", "bound", "bound_kind", "found_by", "nodes"}`` from a worker thread, the best known of
        each, and the nodes of branch and bound where the solver tells them.
    log : bool, path or SearchLog, optional
        True shows a line per improvement and per few seconds, and at the end what was proved: in the cell of a notebook, else on standard
        error. A path writes it to a file. ``Solution.history`` has the figures in any case.
    lp_solver : str, optional
        The solver of the linear programs that bounds, engines and heuristics meet on their way: a name of ``solvers()``, by default HiGHS.
    isolate : bool
        Run the solver in a process of its own, with hard time and memory limits.
    options : dict, optional
        The solver's or heuristic's own options, by name.
    **parameters
        The same as keywords.

    Returns
    -------
    Solution
        Its answer, if any, passed every check. Ctrl-C returns the best one so far. Where a claim of the solver, or a bound, contradicts
        that answer, ``faults`` says so, and nothing that the solver claims is believed.

    Raises
    ------
    UsageError, UnsupportedError, MissingPackageError, InputError
        Before anything is run.
    CheckFailedError
        If a claim of the solver does not hold up, and there is no answer to hand over, nor a proof that there is none.
    SearchFailedError, NoAnswerError
        If the search fails, or runs out of memory, and there is no answer to hand over.
    """
    from .solving.request import request_of, searchable
    from .solving.solve import solve as answered

    target = searchable(problem)
    request = request_of(
        target, solver=solver, heuristic=heuristic, form=form, relax=relax, time_limit=time_limit, bound_time=bound_time,
        iterations=iterations, gap=gap, seed=seed, threads=threads, start=start, isolate=isolate, memory_limit=memory_limit,
        no_improvement=no_improvement, lp_solver=lp_solver, options={**(options or {}), **parameters},
    )  # fmt: skip
    return answered(target, request, progress=progress, log=log)


def check(problem: Problem, answer: Any, certificate: Source | Mapping[str, Any] | Certificate | None = None) -> Certificate:
    """Verify an answer, whoever made it, and a certificate's bound; needs no solver.

    Parameters
    ----------
    problem : Problem
        The problem that the answer is to.
    answer : answer, Solution, mapping or path
        As for the ``start`` of ``solve``. A path names a solution file: ``.json``, of routes also ``.sol`` or ``.tour``.
    certificate : path, mapping or Certificate, optional
        Its bound is derived again from its evidence.

    Returns
    -------
    Certificate
        ``feasible`` tells the verdict, ``violations`` what is broken.

    Raises
    ------
    CheckFailedError
        If the certificate states more than its evidence proves, or another objective than the answer's.
    """
    from .formulations.certificate import Certificate, certify, check_certificate
    from .formulations.certificate_files import read_certificate
    from .solving.answers import answer_given, evaluated

    _refuse_path("check", problem)
    answer, _ = answer_given(problem, answer, "the answer")
    if answer is None:
        raise UsageError("there is no answer to check", "missing")
    evaluation = evaluated(problem, answer)
    if certificate is None:
        return certify(problem, evaluation)
    if isinstance(certificate, Certificate):
        certificate = certificate.to_json(with_evidence=True)
    elif isinstance(certificate, str | PathLike):
        certificate = read_certificate(certificate)
    return check_certificate(problem, certificate, evaluation)


def judge(problem: Problem, answer: Any, *, form: str | None = None) -> Certificate:
    """The verdict on anybody's answer, whatever it came as: is it feasible, what is it worth, and what does it break?

    Parameters
    ----------
    problem : Problem
        The problem that the answer is to.
    answer : object
        A ``Solution`` or the problem's own answer; of routes a list of lists of sites, such a list by the name of each vehicle, or a frame
        with the columns ``vehicle`` and ``site``, and perhaps ``arrival, begin, departure``, a timetable that is judged too; the parsed
        JSON of an answer; or the path of a file: all that ``Solution.save`` writes,
        VROOM's output, and solution files of HiGHS, SCIP, CBC, GLPK, Gurobi and MathOpt to an exported model. Or the exported model itself,
        solved: of ``highspy``, PuLP, CVXPY, PySCIPOpt, or MathOpt's result.
    form : str, optional
        For a solver's file or model: the form that was exported; by default whichever it is a solution of.

    Returns
    -------
    Certificate
        ``feasible`` tells the verdict, ``violations`` what is broken, ``objective`` the value recomputed from the data.

    Raises
    ------
    UsageError, InputError
        If ``answer`` cannot be read as one of this problem, or is a solver's solution of another model.

    Examples
    --------
    >>> judge(read("demo-tiny"), [["1", "2"], ["3"]]).feasible
    False
    """
    from .formulations.certificate import certify
    from .solving.answers import answer_given, evaluated

    _refuse_path("judge", problem)
    given, _ = answer_given(problem, answer, "the answer", form)
    if given is None:
        raise UsageError("there is no answer to judge", "missing")
    return certify(problem, evaluated(problem, given))


def bound(problem: Problem, *, bound_time: float = 60.0, seed: int = 1, threads: int = 1, lp_solver: str | None = None) -> Certificate:
    """The best verified bound that ``bound_time`` allows, as a certificate without an answer.

    Parameters
    ----------
    problem : Problem
        Of any family; whole, for a bound of the relaxation alone is one of the problem too.
    bound_time : float, seconds
        Budget of all methods together, and of all levels of the objective.
    seed, threads : int
        Of the linear programs and searches that methods begin on their way.
    lp_solver : str, optional
        The solver of the linear programs that methods meet on their way, a name of ``solvers()``; HiGHS by default.

    Returns
    -------
    Certificate
        ``bound`` is None where no method proves one. ``levels`` holds the bounds of the levels of priority after the first, each of
        the answers that meet the bounds before it.

    Raises
    ------
    UsageError, MissingPackageError, UnsupportedError
        For an ``lp_solver`` that does not exist, is not installed, or takes no linear programs.

    Warns
    -----
    RuntimeWarning
        For each method that failed; the others count all the same.
    """
    import warnings

    from .solvers.linear_programs import linear_programs
    from .solving.levels import bound_alone

    _refuse_path("bound", problem)
    check_number("bound_time", bound_time, above=0, option="the time for bounding")
    check_whole("seed", seed)
    check_whole("threads", threads, least=1)
    unable: list[str] = []
    certificate, _, _ = bound_alone(problem, bound_time, linear_programs(lp_solver, seed, threads), unable)
    for line in unable:
        warnings.warn(line, RuntimeWarning, stacklevel=2)
    return certificate


def explain(problem: Problem | Compiled | Program, *, time_limit: float = 60.0, form: str | None = None) -> Explanation:
    """Why a problem has no answer, in its own words.

    First arguments from the data alone (routing: sites that no vehicle can reach, a fleet too small), then a deletion filter over the rows
    of a form, through HiGHS. Where no form is exact: an answer by any method, or evidence.

    Parameters
    ----------
    problem : Problem, Compiled or Program
        The one of which an answer is missing.
    time_limit : float, seconds
        For everything together.
    form : str, optional
        Form whose rows shall be named; the problem's first exact one by default.

    Returns
    -------
    Explanation
        ``verdict`` and ``reasons``; it prints itself.

    Notes
    -----
    Source of the filter: Chinneck and Dravnieks (1991), Locating minimal infeasible constraint sets in linear programs.
    """
    from .solving.explaining import explain as by_filter

    _refuse_path("explain", problem)
    check_number("time_limit", time_limit)
    return by_filter(problem, time_limit=time_limit, form=form)


def _refuse_path(function: str, problem: object) -> None:
    """Raise UsageError for a path in place of a problem, which is what people try first."""
    if isinstance(problem, str | PathLike):
        raise UsageError(f"{function} takes a problem, not a path: {function}(read({str(problem)!r}))", "malformed")


def _settings(convention: str | None, settings: Mapping[str, Any]) -> dict[str, Any]:
    return {**_dashed(settings), **({} if convention is None else {"convention": convention})}


def _dashed(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Keyword arguments under the names of ``--set``."""
    return {name.replace("_", "-"): value for name, value in settings.items()}


__all__ = ["bound", "check", "explain", "generate", "judge", "read", "read_source", "solve"]
