"""Valid bounds for answers of engines that have none: every method that applies, cheapest first, within a budget."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Literal

from ..formulations.certificate import verified_bound
from ..formulations.evidence import ENDLESS, Evidence
from ..formulations.problem import Problem
from ..formulations.stop import Stop, off_the_clock
from ..formulations.tolerance import same
from ..instances.errors import UnsupportedError, in_words
from ..solvers.backend import Control
from ..solvers.bounds import BOUNDS, BoundMethod, replaced
from ..solvers.linear_programs import LinearPrograms

AT_ONCE = 0
"""Order of the methods that are asked however little time is left: what a bound is at least must not hang on the clock."""


def find_bounds(
    problem: Problem,
    bound_time: float,
    *,
    target: float | None = None,
    known: Sequence[Evidence] = (),
    control: Control | None = None,
    progress: Callable[[dict[str, Any]], None] | None = None,
    unable: list[str] | None = None,
    linear: LinearPrograms | None = None,
    searching: bool = True,
    at_once: bool = False,
    compiling: Literal["never", "last", "first"] = "last",
    uncompiled: list[str] | None = None,
) -> list[Evidence]:
    """Evidence for bounds of ``problem``, to be verified by the checker.

    Parameters
    ----------
    problem : Problem
    bound_time : float, seconds
        Budget for all methods together, without what they prepare, compile or load; 0 turns bounding off.
    target : float, optional
        Value of an answer: evidence that reaches it ends the search.
    known : sequence of Evidence
        What was found already, by whoever made the answer.
    control : Control, optional
        Stops between and inside methods.
    progress : callable, optional
        Receives an event for each bound found.
    unable : list of str, optional
        Receives a line for each method that failed; the others are tried all the same.
    linear : LinearPrograms, optional
        Who solves linear programs, with which seed and threads.
    searching : bool
        Whether methods may search (``BoundMethod.aims``): these take all the time that there is.
    at_once : bool
        Whether to ask those alone that search nothing and have nothing to prepare. They come first in any case, and before anything is
        compiled or loaded for the others.
    compiling : str
        When methods whose loops were never compiled have their turn: never; after all others, which are there then whatever becomes of
        these, and have half the budget; or before them, where the others had theirs already.
    uncompiled : list of str, optional
        Receives the names of these.

    Returns
    -------
    list of Evidence, in the order of the methods
    """
    found: list[Evidence] = []
    failed: list[str] = [] if unable is None else unable
    if bound_time <= 0 or any(_reaches(e.value, target) and _reaches(proved(problem, e), target) for e in known):
        return found
    control = control or Control()
    linear = linear or LinearPrograms()
    methods = able_methods(problem, failed, searching=searching)
    stop = Stop(bound_time)  # from here on: listing imports them all
    control.on_stop(stop.ask)
    places = {method.name: place for place, method in enumerate(methods)}
    by: dict[int, int] = {}

    def settled(method: BoundMethod, within: Stop) -> bool:
        """Whether what the method finds leaves nothing to look for."""
        try:
            with off_the_clock():
                method.prepare()
            evidence = method.evidence(problem, within, linear, target)
        except UnsupportedError:
            return False
        except Exception as fault:  # whatever it is: a bound that cannot be computed is no bound, and costs neither answer nor other bounds
            failed.append(f"no bound by {method.name}: {in_words(fault)}")
            return False
        if evidence is None:
            return False
        by[id(evidence)] = places[method.name]
        found.append(evidence)
        control.publish(list(found))
        if progress is not None:
            seconds = bound_time - stop.seconds_left
            progress({"phase": "bound", "seconds": seconds, "objective": target, "bound": evidence.value, "source": evidence.source})
        return evidence.kind in ENDLESS or (_reaches(evidence.value, target) and _reaches(proved(problem, evidence), target))

    for method in (m for m in methods if m.order <= AT_ONCE):
        if control.stopped or settled(method, stop):
            return found
    if at_once or stop.reached():
        return found

    others = [m for m in methods if m.order > AT_ONCE]
    late = _late(others, failed)
    if uncompiled is not None:
        uncompiled.extend(method.name for method in late)
    others = [method for method in others if method not in late]
    share = stop.within(bound_time / 2.0) if compiling == "last" and late else stop
    for method in {"never": others, "last": others + late, "first": late + others}[compiling]:
        within = stop if method in late else share
        if stop.reached():
            break
        if within.reached() or (method in late and stop.seconds_left < min(1.0, 0.4 * bound_time)):  # not worth a compiler
            continue
        if settled(method, within):
            break
    return sorted(found, key=lambda evidence: by[id(evidence)])


def _late(methods: list[BoundMethod], failed: list[str]) -> list[BoundMethod]:
    """The methods whose loops were never compiled; methods that fail to tell are taken out of ``methods``."""
    late: list[BoundMethod] = []
    for method in tuple(methods):
        try:
            with off_the_clock():
                if not method.compiled():
                    late.append(method)
        except Exception as fault:
            methods.remove(method)
            failed.append(f"no bound by {method.name}: {in_words(fault)}")
    return late


def able_methods(problem: Problem, failed: list[str], *, searching: bool = True) -> list[BoundMethod]:
    """The methods that apply, cheapest first; ``failed`` receives a line for each that cannot say."""
    methods: list[BoundMethod] = []
    others = replaced(problem)
    for method in sorted(BOUNDS.values(), key=lambda method: method.order):
        try:
            if (searching or not method.aims) and method.name not in others and not method.missing(problem):
                methods.append(method)
        except Exception as fault:
            failed.append(f"no bound by {method.name}: {in_words(fault)}")
    return methods


def proved(problem: Problem, evidence: Evidence) -> float | None:
    """The bound that the checker derives from ``evidence``; None where it proves nothing, or its checker fails."""
    try:
        bound = verified_bound(problem, evidence)
    except Exception:  # told when the certificate is made, which asks every checker
        return None
    return bound if bound != (-math.inf if problem.sense == "min" else math.inf) else None


def _reaches(bound: float | None, target: float | None) -> bool:
    return bound is not None and target is not None and same(bound, target)
