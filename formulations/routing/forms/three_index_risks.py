"""Three-index forms with uncertain durations: ``three-index-cones`` with a cone for each vehicle, and two linear ones in pieces.

To the rows of ``three_index``, for each vehicle k whose routes may overrun a limit with probability r, z = Phi^-1(1 - r)::

    deviation[k]  sigma_k >= || (sqrt(v_ij) x_ijk) ||                          second-order cone, over the moves of k
    safe[k]       sum (s_i + d_ij) x_ijk + z sigma_k <= max_duration
    lasting[k]    rate (sum d_ij x_ijk + z sigma_k) <= energy at departure     charge ``travel``; with the services ``elapsed``, and
                                                                               ``elapsed-fixed-start``

A binary is its own square, so that the norm is exact; relaxed, it is smaller than the root of the sum of the variances. No route waits
where its duration is limited. A risk of the team is no convex row, for how it is split is what is asked. ``three-index-tangents`` and
``three-index-chords`` take it: the deviation of a route is concave in its variance, the quantile of its risk convex in the part r_k of
-log(1 - team_risk) that it takes. For each vehicle k with a piece j for some intervals [a_j, b_j] of the deviation times some of the
quantile::

    one[k]       sum_j w_kj = 1,   w binary                                     which piece counts
    spread[k,j]  a_j^2 w_kj <= v_kj <= b_j^2 w_kj                               and within[k,j] for r_kj
    variance[k]  sum_j v_kj >= sum v_ij x_ijk
    safe[k]      sum (s_i + d_ij) x_ijk + sum_j (p_j w_kj + q_j v_kj + f_j r_kj) <= max_duration
    lasting[k]   rate (sum d_ij x_ijk + sum_j (...)) <= energy at departure
    risk         sum_k sum_j r_kj <= 1                                          a risk of the team, split as costs least

In ``three-index-tangents``, a restriction, p w + q v + f r is at least deviation times quantile, by the tangent of the deviation, the
chord of the quantile, and McCormick's plane for the product of both; in ``three-index-chords``, a relaxation, it is at most that, by the
chord of the deviation, the tangent of the quantile, and the plane below. Where each route has a risk of its own there is one quantile, and
no r. The first piece is that of no variance. The optimum lies between the two.

Source: Charnes and Cooper (1959); Stewart and Golden (1983); with cones van de Panne and Popp (1963). One binary per piece as in Croxton,
Gendron and Magnanti (2003), "A comparison of mixed-integer programming models for nonconvex piecewise linear cost minimization problems";
planes of McCormick (1976); docs/formulations/routing.md#risk.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from ....instances.errors import InputError
from ....instances.routing.features import RISKS
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.cones import Cones
from ...programs.exactness import Exactness
from ...programs.program import CONES, INTEGERS, Floats
from ...programs.rows import Ints, Part, rows
from ...programs.size import ProgramSize
from ..overrun import quantile, tail
from ..problem import RoutingProblem
from . import _sizes
from ._routes import with_levels
from ._vehicles import Drive, VehicleBlocks, VehicleColumns
from .three_index import FEATURES, refuses, written

SECOND_ORDER = frozenset(kind for kind in CONES if kind.startswith("second-order"))

KNOWN = (FEATURES | {"route-risk"}) - {"energy:windows", "recharging"}
"""Data have no risk of a store that is filled or charged on the way."""

Line = tuple[float, float]
"""Value at 0, and slope."""

PIECES = 6
"""Intervals of the deviation for each quantile; the narrower the smaller it is, for there the root is bent."""

QUANTILES = 10
"""Intervals for a risk of the team, equally wide."""

FAINTEST = 1e-4
"""Smallest risk of a route that the form distinguishes, as a part of the team's risk."""

SPARED = 1e-6
"""Part of each limit that the restriction leaves to what solvers round."""

ROUNDED = 1e-9
"""Part of margins and risks that either concedes to its own rounding."""


def build(problem: RoutingProblem, form: str, add: Callable[[VehicleBlocks], None]) -> Compiled:
    """The program of a form that ``add`` completes."""
    return with_levels(problem, partial(written, form=form, further=(add,)))


def _add_risks(blocks: VehicleBlocks) -> None:
    for number, kind in enumerate(blocks.types):
        risk, spread = kind.vehicle.risk, uncertain_moves(blocks.problem, number, kind)
        if risk is not None and spread is not None and risk != 0.5:  # which has no margin
            _add_deviations(blocks, kind, spread, quantile(risk))


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
    vehicle, prep, limited = kind.vehicle, kind.prep, []
    moving, busy = (kind.with_idle(weight, kind.idle_duration) for weight in (prep.duration, prep.time.weight))
    if math.isfinite(vehicle.max_duration):
        limited.append(("safe", busy, 1.0, vehicle.max_duration))
    energy = vehicle.energy
    if energy is not None and math.isfinite(energy.at_departure):
        weight = moving if energy.charge == "travel" else busy
        limited.append(("lasting", energy.rate * weight, energy.rate, energy.at_departure))
    return limited


def _add_deviations(blocks: VehicleBlocks, kind: VehicleColumns, spread: Floats, deviations: float) -> None:
    """Column, cone and rows of each vehicle of a type."""
    count, every, limited = kind.count, np.arange(len(kind.tail)), limits(kind)
    most = min(math.sqrt(math.fsum(kind.largest_out(spread))), *(limit / (rate * deviations) for _, _, rate, limit in limited))
    first = blocks.add_columns("deviation", (kind.vehicles,), (kind.numbers,), 0.0, most)
    for name, weight, rate, limit in limited:
        row = np.arange(count)
        parts: list[Part] = [kind.along(every, weight), (row, first + row, rate * deviations)]
        blocks.rows.append(rows(name, count, parts, upper=limit, keys=(kind.vehicles,), labels=(kind.numbers,)))
    uncertain = np.nonzero(spread)[0]
    width = len(uncertain) + 1
    columns = np.empty((count, width), dtype=np.int32)
    columns[:, 0] = first + np.arange(count)
    columns[:, 1:] = kind.each(uncertain).reshape(count, -1)
    data = np.tile(np.append(1.0, np.sqrt(spread[uncertain])), count)
    blocks.cones.append(
        Cones(
            "deviation", "second-order", width, np.arange(count * width + 1, dtype=np.int32), columns.ravel(), data, np.zeros(count * width)
        )
    )

    def fill(x: Floats, drives: list[Drive]) -> None:
        for drive in drives:
            if drive.kind is kind:
                x[first + drive.number] = math.sqrt(math.fsum(spread[_driven(drive)]))

    blocks.encoders.append(fill)


def _driven(drive: Drive) -> Ints:
    """Arcs of a drive, the idle one among them."""
    return drive.kind.arc_of[drive.arcs] if len(drive.arcs) else np.array([drive.kind.idle])


@dataclass(frozen=True, eq=False)
class Pieces:
    """Pieces of a type of vehicle; arrays of shape (pieces,).

    ``constant``, ``slope`` and ``fall`` are p, q and f, ``least`` and ``most`` the variances at the ends, ``fewest`` and ``share`` the
    least and largest part of the team's risk.
    """

    constant: Floats
    slope: Floats
    fall: Floats
    least: Floats
    most: Floats
    fewest: Floats
    share: Floats


def _add_pieces(blocks: VehicleBlocks, *, above: bool) -> None:
    team, spent = blocks.problem.team_risk, list[Part]()
    for number, kind in enumerate(blocks.types):
        risks = [risk for risk in (kind.vehicle.risk, team) if risk is not None]
        spread = uncertain_moves(blocks.problem, number, kind)
        if not risks or spread is None or (team is None and min(risks) == 0.5):  # with no margin
            continue
        pieces = _pieces(kind, spread, min(risks), team, above)
        first = _add_choice(blocks, kind, spread, pieces, above)  # of the parts r
        many = kind.count * len(pieces.share)
        spent.append((np.zeros(many, dtype=np.int64), first + np.arange(many), 1.0))
    if team is not None and spent:
        blocks.rows.append(rows("risk", 1, spent, upper=1.0 if above else 1.0 + ROUNDED))


def _pieces(kind: VehicleColumns, spread: Floats, risk: float, team: float | None, above: bool) -> Pieces:
    """All pieces of a type, that of no variance first."""
    farthest, columns = math.sqrt(math.fsum(kind.largest_out(spread))), [tuple([np.zeros(1)] * 7)]
    for low, high, chord, tangent, ends in _quantiles(risk, team, above):
        most = min([farthest, *(limit / (rate * low) for _, _, rate, limit in limits(kind) if low > 0.0)])
        if most <= 0.0:
            continue
        edges = most * (np.arange(PIECES + 1) / PIECES) ** 2
        a, b = edges[:-1], edges[1:]
        (at, fall), z = (chord, high) if above else (tangent, low)  # of the quantile, at no risk and for each part
        bent = (a + b) / 4.0 if above else a * b / (a + b)  # the line of the deviation at no variance
        rounded = 1.0 + ROUNDED if above else 1.0 - ROUNDED
        parts = rounded * (z * bent + a * (at - z)), rounded * z / (a + b), a * fall, a * a, b * b
        columns.append((*parts, np.full(PIECES, ends[0]), np.full(PIECES, ends[1])))
    return Pieces(*(np.concatenate(part) for part in zip(*columns, strict=True)))


def _quantiles(risk: float, team: float | None, above: bool) -> list[tuple[float, float, Line, Line, tuple[float, float]]]:
    """Intervals of the quantile: its ends, chord and tangent over the part of the team's risk, and the ends of that part."""
    largest = 0.0 if risk == 0.5 else quantile(risk)
    if team is None:
        return [(largest, largest, (largest, 0.0), (largest, 0.0), (0.0, 0.0))]
    whole = -math.log1p(-team)
    every = np.linspace(largest, quantile(risk * FAINTEST), QUANTILES + 1).tolist()
    shares = [-math.log1p(-risk) / whole, *(-math.log1p(-tail(z)) / whole for z in every[1:])]
    intervals = []
    for low, high, more, less in zip(every[:-1], every[1:], shares[:-1], shares[1:], strict=True):
        slope, middle = (low - high) / (more - less), tail(0.5 * (low + high))
        bend = -whole * (1.0 - middle) / math.exp(-0.125 * (low + high) ** 2) * math.sqrt(2.0 * math.pi)
        tangent = 0.5 * (low + high) + bend * math.log1p(-middle) / whole
        intervals.append((low, high, (high - slope * less, slope), (tangent, bend), (less, more)))
    if not above:  # all fainter ones
        intervals.append((every[-1], every[-1], (every[-1], 0.0), (every[-1], 0.0), (0.0, shares[-1])))
    return intervals


def _add_choice(blocks: VehicleBlocks, kind: VehicleColumns, spread: Floats, pieces: Pieces, above: bool) -> int:
    """Columns and rows of a type; the first column of its parts r."""
    count, many, moves = kind.count, len(pieces.share), np.nonzero(spread)[0]
    row, each = np.repeat(np.arange(count), many), np.arange(count * many)
    keys, labels = (np.repeat(kind.vehicles, many), np.tile(np.arange(many), count)), (kind.numbers, None)
    chosen = blocks.add_columns("piece", keys, labels, 0.0, 1.0, integer=True)
    used = blocks.add_columns("spread", keys, labels, 0.0, np.tile(pieces.most, count))
    taken = blocks.add_columns("part", keys, labels, 0.0, np.tile(pieces.share, count))
    own, names = (kind.vehicles,), (kind.numbers,)
    variance: list[Part] = [(row, used + each, 1.0), kind.along(moves, -spread[moves])]
    blocks.rows += [
        rows("one", count, [(row, chosen + each, 1.0)], 1.0, 1.0, own, names),
        rows("variance", count, variance, 0.0, keys=own, labels=names),
    ]
    for name, column, least, most in (("spread", used, pieces.least, pieces.most), ("part", taken, pieces.fewest, pieces.share)):
        for side, ends, lower, upper in (("least", least, 0.0, math.inf), ("most", most, -math.inf, 0.0)):
            at = np.nonzero(np.tile(ends if side == "least" else most, count) > 0.0)[0]
            within: list[Part] = [(np.arange(len(at)), column + at, 1.0), (np.arange(len(at)), chosen + at, -np.tile(ends, count)[at])]
            blocks.rows.append(rows(f"{side}-{name}", len(at), within, lower, upper, tuple(key[at] for key in keys), labels))
    every = np.arange(len(kind.tail))
    limited = [(name, weight, rate, limit * (1.0 - SPARED) if above else limit) for name, weight, rate, limit in limits(kind)]
    for name, weight, rate, limit in limited:
        parts: list[Part] = [
            kind.along(every, weight),
            *((row, column + each, rate * np.tile(part, count))
              for column, part in ((chosen, pieces.constant), (used, pieces.slope), (taken, pieces.fall))),
        ]  # fmt: skip
        blocks.rows.append(rows(name, count, parts, upper=limit, keys=own, labels=names))
    blocks.encoders.append(_filling(kind, spread, pieces, limited, (chosen, used, taken)))
    return taken


def _filling(
    kind: VehicleColumns, spread: Floats, pieces: Pieces, limited: list[tuple[str, Floats, float, float]], columns: tuple[int, int, int]
) -> Callable[[Floats, list[Drive]], None]:
    chosen, used, taken = columns
    many = len(pieces.share)

    def fill(x: Floats, drives: list[Drive]) -> None:
        x[chosen + many * np.arange(kind.count)] = 1.0
        for drive in drives:
            if drive.kind is not kind:
                continue
            arcs = _driven(drive)
            variance = math.fsum(spread[arcs])
            filled = np.maximum(variance, pieces.least)
            least, fits = pieces.fewest.copy(), filled <= pieces.most * (1.0 + ROUNDED)
            for _, weight, rate, limit in limited:  # the least part for which the margin fits
                over = math.fsum(weight[arcs]) + rate * (pieces.constant + pieces.slope * filled) - limit * (1.0 + ROUNDED)
                with np.errstate(divide="ignore", invalid="ignore"):
                    needed = np.where(over <= 0.0, 0.0, np.where(pieces.fall < 0.0, over / (-rate * pieces.fall), math.inf))
                least = np.maximum(least, needed)
            fits &= least <= pieces.share * (1.0 + ROUNDED)
            if not fits.any():
                raise InputError("a route has no place in the pieces", "unsupported", found=f"a variance of {variance:g}")
            at = min(np.nonzero(fits)[0].tolist(), key=lambda j: (least[j], pieces.slope[j]))
            start = many * drive.number
            x[chosen + start], x[chosen + start + at] = 0.0, 1.0
            x[used + start + at], x[taken + start + at] = min(filled[at], pieces.most[at]), min(least[at], pieces.share[at])

    return fill


def _refuses(problem: RoutingProblem, risks: frozenset[str]) -> frozenset[str]:
    return refuses(problem) | (frozenset() if risks & problem.features() else frozenset({"certain durations"}))


def _size(problem: RoutingProblem) -> ProgramSize:
    many = 1 if problem.team_risk is None else QUANTILES + 1
    return _sizes.three_index_pieces(problem, 1.0 + many * PIECES)


FORMS.enter(
    Form(
        "three-index-cones", "routing", KNOWN, partial(build, form="three-index-cones", add=_add_risks),
        refuses=partial(_refuses, risks=frozenset({"route-risk"})), makes=lambda problem: INTEGERS | SECOND_ORDER,
        order=7, size=partial(_sizes.three_index, further=3.0),
    ),
)  # fmt: skip

for _name, _exactness, _above in (
    ("three-index-tangents", Exactness.RESTRICTION, True), ("three-index-chords", Exactness.RELAXATION, False),
):  # fmt: skip
    _build = partial(build, form=_name, add=partial(_add_pieces, above=_above))
    _form = Form(_name, "routing", KNOWN | RISKS, _build, _exactness, refuses=partial(_refuses, risks=RISKS), order=8, size=_size)
    FORMS.add(_name, _form)
