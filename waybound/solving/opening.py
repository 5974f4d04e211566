"""Heuristics that open: where solvers find little by themselves, or take long to begin, the default one starts from the answer of one, or
leaves it at that."""

from __future__ import annotations

from dataclasses import replace

from ..formulations.problem import Problem
from ..formulations.stop import now
from ..heuristics.heuristic import HEURISTICS, HeuristicWork
from ..instances.errors import in_words
from ..solvers.backend import Control, Options
from ..solvers.isolation import run_in_process
from .search import search

SHARE = 0.5
"""Of the time limit, for the heuristic at most."""

LARGEST = 50
"""Size of a problem beyond which its answer stands alone: the programs that solvers need would take all the time to be written."""

LEAST = 0.1
"""Seconds that are left to the solver at least."""


def opening_heuristic(problem: Problem, options: Options) -> str | None:
    """The heuristic that says that it opens ``problem``; None where there is none, or the user asks for what it does not keep to."""
    if options.start is not None or options.extra or options.iterations is not None or options.no_improvement is not None:
        return None
    return next((name for name in HEURISTICS if HEURISTICS[name].opens(problem) and not HEURISTICS[name].missing(problem)), None)


def opened(problem: Problem, name: str, options: Options, isolate: bool) -> tuple[Options, float, str]:
    """The options for a solver that goes on from the heuristic's answer in the time that is left; the seconds that it took; and why it has
    no answer, if so."""
    began = now()  # what is compiled for it counts against no limit
    own = replace(options, time_limit=SHARE * options.time_limit, gap=0.0)
    work, answer, said = HeuristicWork(name, problem, own), None, ""
    try:
        result = search((lambda control: run_in_process(work, own, control)) if isolate else work, Control(), own.time_limit).result
        answer, said = result.answer, result.message
    except Exception as fault:  # the solver goes on without
        said = in_words(fault)
    seconds = now() - began
    return replace(options, start=answer, time_limit=max(options.time_limit - seconds, LEAST)), seconds, "" if answer is not None else said
