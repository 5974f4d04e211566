"""The three-index form with uncertain durations: the deviation of what a route takes is a cone over its moves.

To the rows of ``three_index``, for each vehicle k whose routes may overrun a limit with probability r, z = Phi^-1(1 - r)::

    deviation[k]  sigma_k >= || (sqrt(v_ij) x_ijk) ||                          second-order cone, over the moves of k
    safe[k]       sum (s_i + d_ij) x_ijk + z sigma_k <= max_duration
    lasting[k]    rate (sum d_ij x_ijk + z sigma_k) <= energy at departure     charge ``travel``; with the services ``elapsed``, and
                                                                               ``elapsed-fixed-start``

A binary is its own square, so that the norm is the root of the sum of the variances: exact. Relaxed, the norm is smaller than that root.
No route waits where its duration is limited, so that it is the sum of its moves and services.

A risk of the team is no convex row, for how it is split is what is asked: with r a variable, z sigma_k is a product of two convex terms
(``three_index_pieces``).

Source: Charnes and Cooper (1959); Stewart and Golden (1983); with cones van de Panne and Popp (1963) for their chance constraint;
docs/formulations/routing.md#risk.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.cones import Cones
from ...programs.program import CONES, INTEGERS, Floats
from ...programs.rows import Part, rows
from ..overrun import quantile
from . import _sizes
from ._priorities import with_levels
from ._vehicle_columns import Drive, VehicleColumns, Written
from .three_index import FEATURES, refuses, written

if TYPE_CHECKING:
    from ..problem import RoutingProblem

SECOND_ORDER = frozenset(kind for kind in CONES if kind.startswith("second-order"))

KNOWN = (FEATURES | {"route-risk"}) - {"energy:windows", "recharging"}
"""Data have no risk of a store that is filled or charged on the way."""


def build(problem: RoutingProblem) -> Compiled:
    """The program; see the module's text for its mathematics.

    Parameters
    ----------
    problem : RoutingProblem
        With a risk of routes.
    """
    return with_levels(problem, partial(written, form="three-index-cones", further=(_add_risks,)))


def _add_risks(made: Written) -> None:
    for number, kind in enumerate(made.types):
        risk, spread = kind.vehicle.risk, uncertain_moves(made.problem, number, kind)
        if risk is not None and spread is not None and risk != 0.5:  # which has no margin
            _add_deviations(made, kind, spread, quantile(risk))


def uncertain_moves(problem: RoutingProblem, number: int, kind: VehicleColumns) -> Floats | None:
    """Variances of the arcs of a type; None where nothing that is limited is uncertain."""
    variances = problem.travel_of(number).variances
    if variances is None:
        return None
    at = kind.prep.sites
    spread = np.asarray(variances[at[kind.tail], at[kind.head]])
    spread[kind.idle] *= float(kind.committed)
    return spread if spread.any() and limits(kind) else None


def limits(kind: VehicleColumns) -> list[tuple[str, Floats, float, float]]:
    """Name, weights of arcs, rate of what the deviation adds, and limit."""
    vehicle, prep, found = kind.vehicle, kind.prep, []
    moving, busy = (kind.with_idle(weight, kind.idle_duration) for weight in (prep.duration, prep.time.weight))
    if math.isfinite(vehicle.max_duration):
        found.append(("safe", busy, 1.0, vehicle.max_duration))
    energy = vehicle.energy
    if energy is not None and math.isfinite(energy.at_departure):
        weight = moving if energy.charge == "travel" else busy
        found.append(("lasting", energy.rate * weight, energy.rate, energy.at_departure))
    return found


def _add_deviations(made: Written, kind: VehicleColumns, spread: Floats, deviations: float) -> None:
    """Column, cone and rows of each vehicle of a type."""
    count, every, held = kind.count, np.arange(len(kind.tail)), limits(kind)
    largest = np.zeros(kind.prep.nodes)
    np.maximum.at(largest, kind.tail, spread)
    most = min(math.sqrt(math.fsum(largest)), *(limit / (rate * deviations) for _, _, rate, limit in held))
    first = made.add_columns("deviation", (kind.vehicles,), (kind.numbers,), 0.0, most)
    for name, weight, rate, limit in held:
        row = np.arange(count)
        parts: list[Part] = [
            (np.repeat(row, len(every)), kind.each(every), np.tile(weight, count)), (row, first + row, rate * deviations),
        ]  # fmt: skip
        made.rows.append(rows(name, count, parts, upper=limit, keys=(kind.vehicles,), labels=(kind.numbers,)))
    uncertain = np.nonzero(spread)[0]
    width = len(uncertain) + 1
    columns = np.empty((count, width), dtype=np.int32)
    columns[:, 0] = first + np.arange(count)
    columns[:, 1:] = kind.each(uncertain).reshape(count, -1)
    data = np.tile(np.append(1.0, np.sqrt(spread[uncertain])), count)
    made.cones.append(
        Cones(
            "deviation", "second-order", width, np.arange(count * width + 1, dtype=np.int32), columns.ravel(), data, np.zeros(count * width)
        )
    )
    made.encoders.append(_filling(kind, spread, first))


def _filling(kind: VehicleColumns, spread: Floats, first: int) -> Callable[[Floats, list[Drive]], None]:
    def fill(x: Floats, drives: list[Drive]) -> None:
        for drive in drives:
            if drive.kind is kind:
                arcs = kind.arc_of[drive.arcs] if len(drive.arcs) else np.array([kind.idle])
                x[first + drive.number] = math.sqrt(math.fsum(spread[arcs]))

    return fill


def _refuses(problem: RoutingProblem) -> frozenset[str]:
    return refuses(problem) | (frozenset() if "route-risk" in problem.features() else frozenset({"certain durations"}))


def _makes(problem: RoutingProblem) -> frozenset[str]:
    return INTEGERS | SECOND_ORDER


FORMS.add(
    "three-index-cones",
    Form(
        "three-index-cones", "routing", KNOWN, build, refuses=_refuses, makes=_makes, order=7, size=partial(_sizes.three_index, further=3.0)
    ),
)
