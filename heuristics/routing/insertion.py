"""Solomon's sequential insertion, I1."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np

from ...formulations.routing.problem import RoutingProblem
from ...formulations.routing.routes import Routes
from ...instances.errors import UsageError
from ..heuristic import CUT_SHORT, HEURISTICS, Context, Heuristic, Outcome
from .insertion_steps.site_data import site_data
from .savings import FEATURES
from .tour_steps.cutting import in_turn, routes_of, too_many

SEEDS = ("farthest", "earliest-due")
TIMED = frozenset({"time-windows", "depot-windows"})


def insertion(
    problem: RoutingProblem, context: Context, *, mu: float | None = None, lamda: float | None = None, alpha1: float | None = None,
    seeds: str | None = None,
) -> Outcome:  # fmt: skip
    """Fill one route after the other: a seed, then the customer again and again that is worth most at its best place.

    Parameters
    ----------
    problem : RoutingProblem
        One depot, one vehicle type, every site required.
    context : Context
        Cut short, customers that are left have a route each.
    mu : float, >= 0
        Weight of the move that an insertion takes away.
    lamda : float, >= 0
        Weight of the distance between customer and depot, against the price of its best place.
    alpha1 : float in [0, 1]
        Weight of the distance added, against the delay of the next stop, whose weight is ``1 - alpha1``.
    seeds : str
        ``farthest`` from the depot, or ``earliest-due``.

    Returns
    -------
    Outcome
        The best answer over Solomon's values of what is not given: mu 1, lamda 1 and 2, and with windows alpha1 1 and 0, and both seeds.
        May use more vehicles than the fleet has.

    Raises
    ------
    UsageError
        For values out of range, or too many sites.

    Notes
    -----
    Source: Solomon (1987), Algorithms for the vehicle routing and scheduling problems with time window constraints, Operations Research 35,
    254-265, section 3; docs/formulations/routing.md#approximations.
    """
    for name, value, most in (("mu", mu, 1e6), ("lamda", lamda, 1e6), ("alpha1", alpha1, 1.0)):
        if value is not None and not (isinstance(value, int | float) and 0 <= value <= most):
            raise UsageError(f"{name} must be a number from 0 to {most:g}, not {value!r}")
    if seeds is not None and seeds not in SEEDS:
        raise UsageError(f"seeds must be one of {', '.join(SEEDS)}, not {seeds!r}")
    from .insertion_steps.insertion_kernels import sequential_insertion

    stop, features = context.begin(), problem.features()
    given = site_data(problem, stop, "insertion")
    if given is None:
        return Outcome(in_turn(problem), message=f"customers in their order: {CUT_SHORT}", limit=stop.reached())
    nodes, data, limits = given
    timed = bool(features & TIMED)
    choices: tuple[tuple[Any, ...], ...] = (
        (1.0,) if mu is None else (float(mu),),
        (1.0, 2.0) if lamda is None else (float(lamda),),
        ((1.0, 0.0) if timed else (1.0,)) if alpha1 is None else (float(alpha1),),
        (SEEDS if "time-windows" in features else SEEDS[:1]) if seeds is None else (seeds,),
    )
    best: Routes | None = None
    rank: tuple[bool, tuple[float, ...]] = (True, (math.inf,))
    used: dict[str, Any] = {}
    for m, weight, a, seed in itertools.product(*choices):
        order, last = sequential_insertion(
            stop.flag, data, problem.fleet[0].capacity, limits, timed, m, weight, a, seed == "earliest-due"
        )  # fmt: skip
        answer = Routes(tuple(routes_of(nodes[order], last))).canonical()
        drawn = {"mu": m, "lamda": weight, "alpha1": a, "seeds": seed}
        if stop.reached():  # of a route for each customer that was not inserted yet: they would take long to judge
            if best is None:
                best, used = answer, drawn
                context.publish(best)
            break
        judged = problem.evaluate(answer)
        signs = [1.0 if sense == "min" else -1.0 for sense in problem.senses]
        found = (not judged.feasible, tuple(s * v for s, v in zip(signs, judged.values, strict=True)))
        if best is None or found < rank:
            best, rank, used = answer, found, drawn
            context.publish(best)
    assert best is not None
    cut = stop.reached()
    message = "; ".join(w for w in (too_many(problem, best, "insertion"), CUT_SHORT if cut else "") if w)
    return Outcome(best, statistics={"routes": len(best), **used}, message=message, limit=cut or "none")


def _refuses(problem: Any) -> frozenset[str]:
    return frozenset({"open-routes"}) if np.any([v.start != v.end for v in problem.fleet]) else frozenset()


HEURISTICS.add(
    "insertion",
    Heuristic(
        name="insertion",
        families=("routing",),
        features=FEATURES | {"objective:vehicles", "objective:priorities", "objective:weights"},
        run=insertion,
        summary="Solomon's sequential insertion I1, with windows and route limits",
        refuses=_refuses,
    ),
)
