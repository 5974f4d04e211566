import itertools
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from draws import draws
from file_cases import check_refused
from hypothesis import HealthCheck, given, settings, strategies as st
from oracles import agrees, routing
from program_text import expected, written
from small_routing import LINE, at_risk, varied
from truth.routing import RoutingTruth

from waybound import Energy, Exactness, Objective, Routes, RoutingProblem, Sites, TotalCost, UnsupportedError, VehicleType
from waybound.formulations.routing.forms import three_index_risks
from waybound.formulations.routing.overrun import quantile
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.reports.benchmarks.routing_variants import risky
from waybound.solvers.backend import BACKENDS, Control, Options, solver_named

FORM = "three-index-cones"
SOLVERS = [name for name in ("scip", "outer-approximation") if BACKENDS[name].installed()]


def answered(problem: RoutingProblem, solver: str) -> tuple[str, float | None, Routes | None]:
    made = problem.compile(FORM)
    found = solver_named(solver).run(made.program, Options(time_limit=30.0), Control())
    return found.status, found.objective, None if found.answer is None else made.decode(found.answer)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(("risk", "cost"), [(0.15, 26.0), (0.06, 36.0), (0.05, None)])
def test_the_example_of_risks(risk: float, cost: float | None, solver: str) -> None:
    status, value, answer = answered(at_risk(risk), solver)
    assert (status, value) == (("infeasible", None) if cost is None else ("optimal", pytest.approx(cost)))
    assert answer is None or at_risk(risk).evaluate(answer).feasible


def test_each_vehicle_has_a_cone_over_its_moves_and_a_row_for_each_limit() -> None:
    problem = routing(xy=np.array([(0, 0), (3, 4), (0, 4.0)]), sites={"service": [0, 2, 1]}, fleet=[
        VehicleType(2, max_duration=20.0, energy=Energy(30.0, 2.0), risk=0.1, name="at risk"), VehicleType(1, name="sure"),
    ])  # fmt: skip
    variances = np.array([[0, 1, 4], [9, 0, 0], [16, 25, 0.0]])
    program = replace(problem, travel=replace(problem.travel, variances=variances)).compile(FORM).program
    (cones,) = program.cones
    names = [program.variable_name(k) for k in range(program.num_variables)]
    rows = {program.row_name(k): program.matrix[k].toarray()[0] for k in range(program.num_rows)}
    assert (cones.kind, cones.size) == ("second-order", 2)
    for k in range(2):
        entries = slice(cones.indptr[k * cones.width], cones.indptr[(k + 1) * cones.width])
        held = {names[c]: d for c, d in zip(cones.indices[entries].tolist(), cones.data[entries].tolist(), strict=True)}
        ends = {
            f"x[{i},{j},{k + 1}]": math.sqrt(v) for i, j, v in (("0", "1", 1), ("0", "2", 4), ("1", "0", 9), ("2", "0", 16), ("2", "1", 25))
        }
        assert held == {f"deviation[{k + 1}]": 1.0, **ends}
        z, place = quantile(0.1), names.index(f"deviation[{k + 1}]")
        safe, lasting = rows[f"safe[{k + 1}]"], rows[f"lasting[{k + 1}]"]
        assert (safe[place], lasting[place]) == (z, 2.0 * z)
        for move, (mean, busy) in {"0,1": (5.0, 5.0), "1,0": (5.0, 7.0), "2,1": (3.0, 4.0), "2,0": (4.0, 5.0)}.items():
            at = names.index(f"x[{move},{k + 1}]")
            assert (safe[at], lasting[at]) == (busy, 2.0 * mean)
    assert not any("safe[3]" in name for name in rows)


@settings(max_examples=draws(40), deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(data=st.data())
def test_it_agrees_with_enumeration_on_drawn_durations(data: st.DataObject) -> None:
    n = data.draw(st.integers(2, 4))
    numbers = st.lists(st.integers(0, 9), min_size=n * n, max_size=n * n).map(lambda v: np.array(v, dtype=float).reshape(n, n))
    means, variances = 1.0 + data.draw(numbers), data.draw(numbers)
    limit, count = float(data.draw(st.integers(8, 40))), data.draw(st.integers(1, 2))
    energy = Energy(2.0 * limit, 2.0, data.draw(st.sampled_from(("travel", "elapsed")))) if data.draw(st.booleans()) else None
    vehicle = VehicleType(
        count, max_duration=math.inf if energy else limit, energy=energy, risk=data.draw(st.sampled_from((0.02, 0.1, 0.3, 0.5)))
    )
    np.fill_diagonal(means, 0.0)
    problem = RoutingProblem(Sites.of(range(n), service=1.0), Travel(EXPLICIT, matrix=means, variances=variances), (vehicle,))
    if FORM in problem.forms():
        best = RoutingTruth(problem).lenient
        agrees(problem, FORM, None if best is None else float(best[0]))


@pytest.mark.parametrize("solver", SOLVERS)
def test_it_agrees_with_enumeration_whatever_else_the_data_hold(solver: str) -> None:
    few = (problem for problem in (risky(11, number) for number in range(0, 300, 3)) if len(problem.customers) <= 3)
    taken = [problem for problem in itertools.islice(few, draws(20)) if FORM in problem.forms()]
    assert len(taken) >= 0.7 * draws(20)
    for problem in taken:
        best = RoutingTruth(problem).lenient
        status, _, answer = answered(problem, solver)
        assert status == ("infeasible" if best is None else "optimal"), problem.name
        if best is not None:
            judged = problem.evaluate(answer)
            assert judged.feasible and judged.values == pytest.approx([float(v) for v in best], rel=1e-6, abs=1e-9)


def test_a_start_on_the_edge_of_a_level_does_not_end_the_search() -> None:
    """The first level holds to 1e-6; its answer, as a start of the second level, made HiGHS fail."""
    assert answered(risky(1, 291), "outer-approximation")[0] == "optimal"


@pytest.mark.parametrize("exponent", [-20, 3, 30])
def test_times_in_other_units_have_the_squares_for_variances_and_the_same_routes(exponent: int) -> None:
    scaled = at_risk(0.06, scale=2.0**exponent)
    status, value, answer = answered(scaled, "outer-approximation")
    assert (status, value) == ("optimal", pytest.approx(36.0)) and answer is not None
    plain, other = at_risk(0.06).evaluate(answer), scaled.evaluate(answer)
    assert plain.feasible and other.feasible
    assert plain.quantities["largest-route-overrun"] == other.quantities["largest-route-overrun"]


def test_without_variances_nothing_is_written_and_the_form_refuses() -> None:
    certain = replace(at_risk(0.06), travel=Travel(EXPLICIT, matrix=LINE, variances=np.zeros((5, 5))))
    assert "three-index" in certain.forms() and FORM not in certain.forms()
    check_refused(UnsupportedError, "certain durations", certain.compile, FORM)
    check_refused(UnsupportedError, "team-risk", replace(at_risk(None), team_risk=0.1).compile, FORM)


TWO_SITES = """
    {"waybound": 1, "kind": "routing", "name": "tiny", "problem": "min-cost-vrp",
     "sites": {"id": ["o", "a", "b"], "service": [0, 2, 1]},
     "travel": {"metric": "EXPLICIT", "matrix": [[0, 3, 5], [3, 0, 4], [5, 4, 0]], "variances": [[0, 1, 0], [9, 0, 4], [16, 0, 0]]},
     "fleet": [{"count": 1, "max_duration": 20, "energy": {"capacity": 30, "rate": 2}, "risk": 0.1}]}
"""


def test_three_index_cones_from_text_to_text(tmp_path: Path) -> None:
    """Phi^-1(0.9) is 1.28155. Two moves are certain, and no terms of the cone; no route deviates by more than sqrt(1 + 9 + 16).

    All is over by 17: the longest ways out of o, a and b take 5, 2 + 4 and 1 + 5.
    """
    assert written(TWO_SITES, "three-index-cones", tmp_path, ".json") == expected("""
        three-index-cones, exact
        min 3 x[o,a,1] + 5 x[o,b,1] + 4 x[a,b,1] + 3 x[a,o,1] + 4 x[b,a,1] + 5 x[b,o,1]
        visit[a]: x[a,b,1] + x[a,o,1] = 1
        visit[b]: x[b,a,1] + x[b,o,1] = 1
        fleet: x[o,a,1] + x[o,b,1] >= 1
        depart[1]: x[o,a,1] + x[o,b,1] + x[o,o,1] = 1
        flow[a,1]: x[o,a,1] - x[a,b,1] - x[a,o,1] + x[b,a,1] = 0
        flow[b,1]: x[o,b,1] + x[a,b,1] - x[b,a,1] - x[b,o,1] = 0
        duration[1]: - departure[1] + return[1] <= 20
        energy[1]: 6 x[o,a,1] + 10 x[o,b,1] + 8 x[a,b,1] + 6 x[a,o,1] + 8 x[b,a,1] + 10 x[b,o,1] <= 30
        time[o,a,1]: 9 x[o,a,1] + departure[1] - t[a,1] <= 6
        time[o,b,1]: 9 x[o,b,1] + departure[1] - t[b,1] <= 4
        time[a,b,1]: 13 x[a,b,1] + t[a,1] - t[b,1] <= 7
        time[a,o,1]: 17 x[a,o,1] + t[a,1] - return[1] <= 12
        time[b,a,1]: 13 x[b,a,1] - t[a,1] + t[b,1] <= 8
        time[b,o,1]: 17 x[b,o,1] + t[b,1] - return[1] <= 11
        safe[1]: 3 x[o,a,1] + 5 x[o,b,1] + 6 x[a,b,1] + 5 x[a,o,1] + 5 x[b,a,1] + 6 x[b,o,1] + 1.28155 deviation[1] <= 20
        lasting[1]: 6 x[o,a,1] + 10 x[o,b,1] + 8 x[a,b,1] + 6 x[a,o,1] + 8 x[b,a,1] + 10 x[b,o,1] + 2.5631 deviation[1] <= 30
        deviation: |(x[o,a,1], 2 x[a,b,1], 3 x[a,o,1], 4 x[b,o,1])| <= deviation[1]
        x[o,a,1], x[o,b,1], x[o,o,1], x[a,b,1], x[a,o,1], x[b,a,1], x[b,o,1] binary
        0 <= departure[1] <= 9
        3 <= t[a,1] <= 12
        5 <= t[b,1] <= 11
        0 <= return[1] <= 17
        0 <= deviation[1] <= 5.09902
    """)


CHORDS, TANGENTS = "three-index-chords", "three-index-tangents"


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
    problem = at_risk(risk, team_risk)
    low, high = value(problem, CHORDS), value(problem, TANGENTS)
    assert low <= best <= high
    assert team_risk is not None or low == best == high


@pytest.mark.slow
@pytest.mark.parametrize(
    "solver",
    [n if n == "scip" else pytest.param(n, marks=pytest.mark.long) for n in ("scip", "pulp", "mathopt") if BACKENDS[n].installed()],
)
def test_solvers_of_linear_programs_take_the_risk_of_a_team(solver: str) -> None:
    problem = at_risk(None, 0.15)
    assert (value(problem, CHORDS, solver), value(problem, TANGENTS, solver)) == (pytest.approx(26.0), pytest.approx(36.0))


@pytest.mark.slow
@pytest.mark.parametrize("scale", [2.0**-20, 2.0**30])
def test_times_in_other_units_change_nothing(scale: float) -> None:
    problem = at_risk(None, 0.15, scale)
    assert (value(problem, CHORDS), value(problem, TANGENTS)) == (pytest.approx(26.0), pytest.approx(36.0))


@pytest.mark.long
def test_narrower_pieces_find_the_optimum(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, many in (("PIECES", 8), ("QUANTILES", 40)):
        monkeypatch.setattr(three_index_risks, name, many)
    assert value(at_risk(None, 0.15), TANGENTS) == pytest.approx(34.0)


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
    problem = at_risk(None, 0.15)
    found = solver_named("highs").run(problem.compile(TANGENTS).program, Options(), Control()).answer
    made = problem.compile(form)
    x = made.encode(problem.compile(TANGENTS).decode(found))  # type: ignore[misc]
    assert made.program.residual(x) <= 1e-6 and made.program.value(x) == pytest.approx(36.0)


@pytest.mark.parametrize("above", [True, False])
@pytest.mark.parametrize("team", [None, 0.1, 0.5])
def test_planes_are_on_their_side_of_deviation_times_quantile(above: bool, team: float | None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Wherever variance and part of the risk are in a piece; and of the planes below, each route has one."""
    made: list[Any] = []
    keep = three_index_risks._pieces
    monkeypatch.setattr(three_index_risks, "_pieces", lambda *given: made.append(keep(*given)) or made[-1])
    at_risk(0.1 if team is None else None, team).compile(TANGENTS if above else CHORDS)
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
    certain = replace(at_risk(None), travel=Travel(EXPLICIT, matrix=LINE, variances=LINE))
    assert CHORDS not in certain.forms() and TANGENTS not in certain.forms()
    with pytest.raises(UnsupportedError, match="certain durations"):
        certain.compile(CHORDS)


AT_RISK_TOGETHER = TWO_SITES.replace('"energy": {"capacity": 30, "rate": 2}, "risk": 0.1}]', '}], "team_risk": 0.1').replace("20, }", "20}")

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
    monkeypatch.setattr(three_index_risks, "PIECES", 1)
    monkeypatch.setattr(three_index_risks, "QUANTILES", 1)
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
    assert lines(written(AT_RISK_TOGETHER, "three-index-tangents", tmp_path, ".json")) == lines(*parts)


def test_three_index_chords_from_text_to_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two chords from no deviation: to the root of 26 at the quantile 1.28155 of the whole risk, to 20 / 4.26489 at that of 1e-5."""
    monkeypatch.setattr(three_index_risks, "PIECES", 1)
    monkeypatch.setattr(three_index_risks, "QUANTILES", 1)
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
    assert lines(written(AT_RISK_TOGETHER, "three-index-chords", tmp_path, ".json")) == lines(*parts, "0 <= part[1,2] <= 9.49127e-05")


def lines(*parts: str) -> list[str]:
    """Words of all parts, wherever lines end."""
    return " ".join(parts).split()
