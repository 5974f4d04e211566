"""Uncertain durations in pieces: what they prove and what they find lie on both sides of the optimum."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from draws import draws
from program_text import written
from small_routing import varied
from truth.routing import RoutingTruth

from waybound.formulations.programs.exactness import Exactness
from waybound.formulations.routing.forms import three_index_pieces
from waybound.formulations.routing.objective import Objective, TotalCost
from waybound.formulations.routing.overrun import quantile
from waybound.formulations.routing.problem import RoutingProblem
from waybound.instances.errors import UnsupportedError
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.solvers.backend import BACKENDS, Control, Options, solver_named

CHORDS, TANGENTS = "three-index-chords", "three-index-tangents"
LINE = np.abs(np.subtract.outer(*[np.array([0.0, 4, -5, 6, -7])] * 2))


def line(risk: float | None, team_risk: float | None = None, scale: float = 1.0) -> RoutingProblem:
    """Customers on both sides of the depot, each with a service of 1; times, not distances, in other units."""
    travel = Travel(EXPLICIT, matrix=LINE, duration_matrix=scale * LINE, variances=scale**2 * LINE / 4)
    sites = Sites.of(range(5), service=scale * np.array([0.0, 1, 1, 1, 1]))
    return RoutingProblem(sites, travel, (VehicleType(3, risk=risk, max_duration=18.0 * scale),), team_risk=team_risk)


def value(problem: RoutingProblem, form: str, solver: str = "highs") -> float:
    """The optimum of a form; infinite where it has none. Answers of the restriction are judged."""
    made = problem.compile(form)
    assert made.exactness is (Exactness.RELAXATION if form == CHORDS else Exactness.RESTRICTION)
    found = solver_named(solver).run(made.program, Options(time_limit=30.0), Control())
    assert found.status in ("optimal", "infeasible"), found.message
    if found.answer is None:
        return math.inf
    judged = problem.evaluate(made.decode(found.answer))
    assert form == CHORDS or judged.feasible, judged.violations
    assert found.objective is not None
    return found.objective


@pytest.mark.share(2)
@pytest.mark.share(4)
@pytest.mark.parametrize(
    ("risk", "team_risk", "best"),
    [
        (0.15, None, 26.0), (0.06, None, 36.0), (0.05, None, math.inf), (None, 0.3, 26.0), (None, 0.15, 34.0), (None, 0.06, math.inf),
        (0.06, 0.15, 36.0),
    ],
)  # fmt: skip
def test_the_example_of_risks_lies_between_them(risk: float | None, team_risk: float | None, best: float) -> None:
    problem = line(risk, team_risk)
    low, high = value(problem, CHORDS), value(problem, TANGENTS)
    assert low <= best <= high
    assert team_risk is not None or low == best == high


@pytest.mark.slow
@pytest.mark.parametrize(
    "solver",
    [n if n == "scip" else pytest.param(n, marks=pytest.mark.long) for n in ("scip", "pulp", "mathopt") if BACKENDS[n].installed()],
)
def test_solvers_of_linear_programs_take_the_risk_of_a_team(solver: str) -> None:
    problem = line(None, 0.15)
    assert (value(problem, CHORDS, solver), value(problem, TANGENTS, solver)) == (pytest.approx(26.0), pytest.approx(36.0))


@pytest.mark.slow
@pytest.mark.parametrize("scale", [2.0**-20, 2.0**30])
def test_times_in_other_units_change_nothing(scale: float) -> None:
    problem = line(None, 0.15, scale)
    assert (value(problem, CHORDS), value(problem, TANGENTS)) == (pytest.approx(26.0), pytest.approx(36.0))


@pytest.mark.long
def test_narrower_pieces_find_the_optimum(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, many in (("PIECES", 8), ("QUANTILES", 40)):
        monkeypatch.setattr(three_index_pieces, name, many)
    assert value(line(None, 0.15), TANGENTS) == pytest.approx(34.0)


@pytest.mark.share(2)
@pytest.mark.parametrize("feature", ["route-risk", "team-risk"])
def test_the_optimum_of_enumeration_lies_between_them(feature: str) -> None:
    met = 0
    for seed in range(draws(40)):
        problem: Any = replace(varied(feature, seed, 3), objective=Objective.of(TotalCost()))
        if CHORDS not in problem.forms():
            continue
        truth = RoutingTruth(problem)
        best = math.inf if truth.lenient is None else float(truth.lenient[0])
        strict = math.inf if truth.best is None else float(truth.best[0])
        low, high = value(problem, CHORDS), value(problem, TANGENTS)
        assert low <= best * (1.0 + 1e-9) + 1e-9 and strict <= high * (1.0 + 1e-9) + 1e-9, seed
        met += low < math.inf
    assert met >= 0.2 * draws(40)


@pytest.mark.share(2)
@pytest.mark.parametrize("form", [CHORDS, TANGENTS])
def test_answers_are_points(form: str) -> None:
    """The optimum is one of the relaxation, and what the restriction finds is one of both."""
    problem = line(None, 0.15)
    found = solver_named("highs").run(problem.compile(TANGENTS).program, Options(), Control()).answer
    made = problem.compile(form)
    x = made.encode(problem.compile(TANGENTS).decode(found))  # type: ignore[misc]
    assert made.program.residual(x) <= 1e-6 and made.program.value(x) == pytest.approx(36.0)


@pytest.mark.parametrize("above", [True, False])
@pytest.mark.parametrize("team", [None, 0.1, 0.5])
def test_planes_are_on_their_side_of_deviation_times_quantile(above: bool, team: float | None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Wherever variance and part of the risk are in a piece; and of the planes below, each route has one."""
    made: list[Any] = []
    keep = three_index_pieces._pieces
    monkeypatch.setattr(three_index_pieces, "_pieces", lambda *given: made.append(keep(*given)) or made[-1])
    line(0.1 if team is None else None, team).compile(TANGENTS if above else CHORDS)
    p, whole, met = made[0], 0.1 if team is None else team, 0
    for variance in np.linspace(0.0, p.most.max(), 60).tolist():
        for risk in np.geomspace(1e-7, whole, 60).tolist():
            part = 0.0 if team is None else math.log1p(-risk) / math.log1p(-whole)
            own = (0.0 if risk == 0.5 else quantile(risk if team else whole)) * math.sqrt(variance)
            there = (p.least <= variance) & (variance <= p.most) & (p.fewest <= part * (1 + 1e-12)) & (part <= p.share * (1 + 1e-12))
            plane = p.constant + p.slope * variance + p.fall * part
            if above:
                assert (plane[there] >= own * (1.0 - 1e-12)).all()
            elif own <= 18.0:
                assert (plane[there] <= own * (1.0 + 1e-12)).any()
            met += int(there.any())
    assert met > 500


def test_what_has_no_risk_is_refused() -> None:
    certain = replace(line(None), travel=Travel(EXPLICIT, matrix=LINE, variances=LINE))
    assert CHORDS not in certain.forms() and TANGENTS not in certain.forms()
    with pytest.raises(UnsupportedError, match="certain durations"):
        certain.compile(CHORDS)


TWO_SITES = """
    {"waybound": 1, "kind": "routing", "name": "tiny", "problem": "min-cost-vrp",
     "sites": {"id": ["o", "a", "b"], "service": [0, 2, 1]},
     "travel": {"metric": "EXPLICIT", "matrix": [[0, 3, 5], [3, 0, 4], [5, 4, 0]], "variances": [[0, 1, 0], [9, 0, 4], [16, 0, 0]]},
     "fleet": [{"count": 1, "max_duration": 20}], "team_risk": 0.1}
"""

COMMON = """
    min 3 x[o,a,1] + 5 x[o,b,1] + 4 x[a,b,1] + 3 x[a,o,1] + 4 x[b,a,1] + 5 x[b,o,1]
    visit[a]: x[a,b,1] + x[a,o,1] = 1
    visit[b]: x[b,a,1] + x[b,o,1] = 1
    fleet: x[o,a,1] + x[o,b,1] >= 1
    depart[1]: x[o,a,1] + x[o,b,1] + x[o,o,1] = 1
    flow[a,1]: x[o,a,1] - x[a,b,1] - x[a,o,1] + x[b,a,1] = 0
    flow[b,1]: x[o,b,1] + x[a,b,1] - x[b,a,1] - x[b,o,1] = 0
    duration[1]: - departure[1] + return[1] <= 20
    time[o,a,1]: 9 x[o,a,1] + departure[1] - t[a,1] <= 6
    time[o,b,1]: 9 x[o,b,1] + departure[1] - t[b,1] <= 4
    time[a,b,1]: 13 x[a,b,1] + t[a,1] - t[b,1] <= 7
    time[a,o,1]: 17 x[a,o,1] + t[a,1] - return[1] <= 12
    time[b,a,1]: 13 x[b,a,1] - t[a,1] + t[b,1] <= 8
    time[b,o,1]: 17 x[b,o,1] + t[b,1] - return[1] <= 11
"""
TIMES = """
    0 <= departure[1] <= 9
    3 <= t[a,1] <= 12
    5 <= t[b,1] <= 11
    0 <= return[1] <= 17
    spread[1,0], part[1,0] = 0
    0 <= spread[1,1] <= 26
"""


def test_three_index_tangents_from_text_to_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One piece: deviations to the root of 26, quantiles to Phi^-1(1 - 1e-5) = 4.26489, times 5.09902 / 4 and over 5.09902.

    That risk is 9.49127e-5 of -log(1 - 0.1).
    """
    monkeypatch.setattr(three_index_pieces, "PIECES", 1)
    monkeypatch.setattr(three_index_pieces, "QUANTILES", 1)
    rest = """
        one[1]: piece[1,0] + piece[1,1] = 1
        variance[1]: - x[o,a,1] - 4 x[a,b,1] - 9 x[a,o,1] - 16 x[b,o,1] + spread[1,0] + spread[1,1] >= 0
        most-spread[1,1]: - 26 piece[1,1] + spread[1,1] <= 0
        least-part[1,1]: - 9.49127e-05 piece[1,1] + part[1,1] >= 0
        most-part[1,1]: - piece[1,1] + part[1,1] <= 0
        safe[1]: 3 x[o,a,1] + 5 x[o,b,1] + 6 x[a,b,1] + 5 x[a,o,1] + 5 x[b,a,1] + 6 x[b,o,1] + 5.43669 piece[1,1]
            + 0.836414 spread[1,1] <= 20
        risk: part[1,0] + part[1,1] <= 1
        x[o,a,1], x[o,b,1], x[o,o,1], x[a,b,1], x[a,o,1], x[b,a,1], x[b,o,1], piece[1,0], piece[1,1] binary
    """
    parts = ("three-index-tangents, restriction", COMMON, rest, TIMES, "0 <= part[1,1] <= 1")
    assert lines(written(TWO_SITES, "three-index-tangents", tmp_path, ".json")) == lines(*parts)


def test_three_index_chords_from_text_to_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two chords from no deviation: to the root of 26 at the quantile 1.28155 of the whole risk, to 20 / 4.26489 at that of 1e-5."""
    monkeypatch.setattr(three_index_pieces, "PIECES", 1)
    monkeypatch.setattr(three_index_pieces, "QUANTILES", 1)
    rest = """
        one[1]: piece[1,0] + piece[1,1] + piece[1,2] = 1
        variance[1]: - x[o,a,1] - 4 x[a,b,1] - 9 x[a,o,1] - 16 x[b,o,1] + spread[1,0] + spread[1,1] + spread[1,2] >= 0
        most-spread[1,1]: - 26 piece[1,1] + spread[1,1] <= 0
        most-spread[1,2]: - 21.991 piece[1,2] + spread[1,2] <= 0
        least-part[1,1]: - 9.49127e-05 piece[1,1] + part[1,1] >= 0
        most-part[1,1]: - piece[1,1] + part[1,1] <= 0
        most-part[1,2]: - 9.49127e-05 piece[1,2] + part[1,2] <= 0
        safe[1]: 3 x[o,a,1] + 5 x[o,b,1] + 6 x[a,b,1] + 5 x[a,o,1] + 5 x[b,a,1] + 6 x[b,o,1] + 0.251333 spread[1,1]
            + 0.909465 spread[1,2] <= 20
        risk: part[1,0] + part[1,1] + part[1,2] <= 1
        x[o,a,1], x[o,b,1], x[o,o,1], x[a,b,1], x[a,o,1], x[b,a,1], x[b,o,1], piece[1,0], piece[1,1], piece[1,2] binary
    """
    parts = ("three-index-chords, relaxation", COMMON, rest, TIMES, "0 <= spread[1,2] <= 21.991", "0 <= part[1,1] <= 1")
    assert lines(written(TWO_SITES, "three-index-chords", tmp_path, ".json")) == lines(*parts, "0 <= part[1,2] <= 9.49127e-05")


def lines(*parts: str) -> list[str]:
    """Words of all parts, wherever lines end."""
    return " ".join(parts).split()
