"""Solomon's sequential insertion, I1."""

import itertools
import math
from typing import Any

from ...formulations.routing.problem import RoutingProblem
from ...formulations.routing.routes import Routes
from ...instances.errors import UsageError
from ..heuristic import Context, Outcome, heuristic
from .savings import FEATURES
from .tour_steps.cutting import ended, in_turn, no_time, routes_of, too_many
from .tour_steps.distance_matrices import site_data

SEEDS = ("farthest", "earliest-due")
TIMED = frozenset({"time-windows", "depot-windows"})


@heuristic(
    "insertion",
    "routing", FEATURES | {"objective:vehicles", "objective:priorities", "objective:weights"},
    "Solomon's sequential insertion I1, with windows and route limits",
)  # fmt: skip
def insertion(
    problem: RoutingProblem, context: Context, *, mu: float | None = None, lamda: float | None = None, alpha1: float | None = None,
    seeds: str | None = None,
) -> Outcome:  # fmt: skip
    """Fill one route after the other: a seed, then the customer again and again that is worth most at its best place.

    Takes one depot and one vehicle type, every site required. Answers with the best one over Solomon's values of the parameters left out
    (mu 1, lamda 1 and 2, and with windows alpha1 1 and 0, and both seeds); it may use more vehicles than the fleet has. Cut short,
    customers that were not inserted have a route each.

    Source: Solomon (1987), Algorithms for the vehicle routing and scheduling problems with time window constraints, Operations Research 35,
    254-265, section 3; docs/formulations/routing.md#approximations.

    Parameters
    ----------
    mu : float, >= 0
        Weight of the move that an insertion takes away.
    lamda : float, >= 0
        Weight of the distance between customer and depot, against the price of its best place.
    alpha1 : float in [0, 1]
        Weight of the distance added, against the delay of the next stop, whose weight is ``1 - alpha1``.
    seeds : str
        ``farthest`` from the depot, or ``earliest-due``.
    """
    for name, value, most in (("mu", mu, 1e6), ("lamda", lamda, 1e6), ("alpha1", alpha1, 1.0)):
        if value is not None and not (isinstance(value, int | float) and 0 <= value <= most):
            raise UsageError(f"{name} must be a number from 0 to {most:g}, not {value!r}", "out-of-range")
    if seeds is not None and seeds not in SEEDS:
        raise UsageError(f"seeds must be one of {', '.join(SEEDS)}, not {seeds!r}", "unknown-name")
    from .insertion_steps.insertion_kernels import sequential_insertion

    stop, features = context.begin(), problem.features()
    node_data = site_data(problem, stop, "insertion")
    if node_data is None:
        return no_time(in_turn(problem), stop)
    nodes, data, limits = node_data
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
        reached = (not judged.feasible, tuple(s * v for s, v in zip(signs, judged.values, strict=True)))
        if best is None or reached < rank:
            best, rank, used = answer, reached, drawn
            context.publish(best)
    assert best is not None
    return ended(best, stop.reached(), {"routes": len(best), **used}, too_many(problem, best, "insertion"))
