"""Certificates with fields changed: refused in one line, or accepted with nothing false in them; the truth is known by enumeration."""

import copy
import json
import math
import random
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from patience import HANG
from scipy.optimize import linprog, minimize_scalar
from scipy.special import ndtri
from truth.routing import RoutingTruth, best_values

import waybound as wb
from waybound import Allocation, BottleneckSATA, Evaluation, MaxMinLP, Problem, Selection, Sites, Travel, VehicleType, WinnerTakesAllSATA
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.certificate import Certificate, certificate_lines, certificate_title, certify, check_certificate
from waybound.formulations.evidence import CHECKERS, Evidence
from waybound.formulations.json_text import json_text
from waybound.formulations.rendering import as_text
from waybound.formulations.routing.fleet_need import _small_groups, fleet_conflicts, proves, suspicions
from waybound.formulations.stop import Stop
from waybound.instances.document import parse_json
from waybound.instances.errors import CheckFailedError, InputError, UsageError
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing import branch_price_cut
from waybound.solving.bounding import find_bounds

from .. import (
    explorations,
    joint_assignments,
    knapsack_assignments,
    orchard_cases,
    random_sensing,
    risk_problems,
    risky_cases,
    sata_cases,
    selection_problems,
    small_routing,
    task_problems,
)
from ..bin_assignments import worked
from ..programs import program
from ..small_routing import plane, small
from ..uncertain_graphs import WORKED, all_paths, graph_of

NEAR = 1e-6
"""Relative difference up to which a number counts as the true one."""


FEATURES = ("time-windows", "limited-fleet", "heterogeneous-fleet", "max-distance", "prizes", "reward", "vehicles")


@dataclass(frozen=True)
class Case:
    """A certificate that holds, and what is true of its problem: the optimum (None: there is no answer)."""

    problem: Problem
    evaluation: Evaluation | None
    data: dict[str, Any]
    best: float | None


def _cases_of(problem: Problem, best: float | None, answers: list[Any], *further: Evidence, look: bool = True) -> list[Case]:
    """A certificate for each piece of evidence that is found, with each of the answers in turn and with none."""
    evidence = [*(find_bounds(problem, HANG) if look else ()), *further]
    judged = [None, *(problem.evaluate(answer) for answer in answers)]
    made = []
    for k, piece in enumerate(evidence):
        if best is None and not certify(problem, None, [piece]).infeasible:
            continue  # a bound where there is no answer is true, whatever it is
        for evaluation in judged:
            guarantee = wb.Guarantee(2.0, "1/2", ("monotone",), "someone 1978") if k % 2 and evaluation is not None else None
            data = json.loads(json_text(certify(problem, evaluation, [piece], guarantee).to_json(with_evidence=True)))
            made.append(Case(problem, evaluation, data, best))
    return made


def _routing(features: tuple[str, ...] = FEATURES) -> list[Case]:
    cases = []
    for feature in features:
        truth = next(truth for truth in (RoutingTruth(small(feature, seed, "exact")) for seed in range(20)) if truth.best is not None)
        problem, first = truth.problem, [[c] for c in truth.problem.customers.tolist()]
        cases += _cases_of(problem, float(truth.best[0]), [truth.samples[0], wb.Routes.of(first[:2])])
    mixed = small("heterogeneous-fleet", 0, "exact")
    best = best_values(mixed)[0]
    cases += _cases_of(mixed, best, [], Evidence("all-routes", "all routes", best, {}), look=False)
    cases += _listed()
    tour = wb.RoutingProblem(
        Sites.of("oabc", demand=[0, 1, 1, 1]), Travel("euclidean", [(0, 0), (3, 0), (3, 4), (0, 4)]), (VehicleType(count=1),), problem="tsp"
    )
    cases += _cases_of(tour, 14.0, [wb.Routes.of([[1, 2, 3]]), wb.Routes.of([[2, 1, 3]])])
    shared = replace(tour, fleet=(VehicleType(count=2),), objective=wb.Makespan())
    cases += _cases_of(shared, 12.0, [wb.Routes.of([[1, 2], [3]]), wb.Routes.of([[1, 2, 3]])])
    line = Travel("euclidean", [(0, 0), (3, 0), (3, 4)])
    far = wb.RoutingProblem(Sites.of("oab"), line, (VehicleType(max_distance=9.0),))
    few = wb.RoutingProblem(Sites.of("oab", demand=[0, 5, 5]), line, (VehicleType(count=1, capacity=9.0),))
    return cases + _cases_of(far, None, [wb.Routes.of([[1]])]) + _cases_of(few, None, [wb.Routes.of([[1], [2]])])


def _listed() -> list[Case]:
    """A proof over all routes of a better answer, listed however wide the gap is."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(branch_price_cut, "WIDEST", 10.0)
        patch.setattr(branch_price_cut.Tree, "_hopeless", lambda self, node, part, solved: None)
        for seed in range(30):
            problem = plane(seed, 7, 17.0)
            evidence = branch_price_cut.branch_price_cut_bound(problem, Stop(HANG))
            if evidence is not None and evidence.kind == "enumerated-routes":
                return _cases_of(problem, best_values(problem)[0], [], evidence, look=False)
    raise AssertionError("none of thirty problems is proved over listed routes")


def _without_answer() -> list[Case]:
    """Fleets that are too small, each for a reason of its own kind."""
    cross = Travel("euclidean", [(0, 0), (3, 0), (-3, 0), (0, 3), (0, -3)])
    near = Travel("euclidean", [(0, 0), (1, 0), (1, 0), (1, 0), (1, 0)])
    asked = (
        wb.RoutingProblem(Sites.of("oabcd"), cross, (VehicleType(),), min_vehicles=5),
        wb.RoutingProblem(Sites.of("oabcd", demand=[0, 5, 5, 5, 1]), cross, (VehicleType(count=2, capacity=9.0),)),
        wb.RoutingProblem(Sites.of("oabcd"), cross, (VehicleType(count=1, max_distance=7.0),)),
        wb.RoutingProblem(Sites.of("oabcd", due=[99, 3.5, 3.5, 3.5, 99]), cross, (VehicleType(count=2),)),
        wb.RoutingProblem(Sites.of("oabcd", due=[99, 9, 9, 9, 9], service=[0, 4, 4, 4, 4]), near, (VehicleType(count=1),)),
    )
    found = {}
    for problem in asked:
        for piece in (*suspicions(problem), *fleet_conflicts(problem), *_small_groups(problem, lambda: False, 4)):
            if proves(problem, piece):
                found.setdefault(piece.kind, (problem, piece))
    return [
        case for problem, piece in found.values() for case in _cases_of(problem, None, [wb.Routes.of([[1], [2, 3, 4]])], piece, look=False)
    ]


def _max_min() -> list[Case]:
    rng = np.random.default_rng(5)
    cases = []
    for seed in range(2):
        graph = random_sensing.random_graph(seed, robots=4, targets=3, most_actions=2)
        best = max(BottleneckSATA(graph).evaluate(s).values[0] for s in sata_cases.selections(graph))
        whole = next(s for s in sata_cases.selections(graph) if len(s) == 4)
        cases += _cases_of(BottleneckSATA(graph), best, [whole, Selection((0, 0))])
        shares = np.zeros(graph.num_actions)
        shares[list(whole.elements)] = 1.0
        cases += _cases_of(BottleneckSATA(graph, fractional=True), random_sensing.optimum(graph), [shares, 2.0 * shares])
    for sense in ("max", "min"):
        a, c = rng.integers(1, 5, (3, 4)).astype(float), rng.integers(1, 5, (3, 4)).astype(float)
        sign, (bounded, moved) = (1.0, (a, c)) if sense == "max" else (-1.0, (c, a))
        rows = np.vstack([sign * np.c_[bounded, np.zeros(3)], sign * np.c_[-moved, np.ones(3)]])
        found = linprog([0] * 4 + [-sign], A_ub=rows, b_ub=[sign] * 3 + [0] * 3)
        assert found.status == 0
        x = found.x[:4]
        cases += _cases_of(MaxMinLP(a, c, sense=sense), float(found.x[4]), [x * (1 + 1e-9 if sense == "min" else 1 - 1e-9), 3.0 * x - 0.2])
    return cases


def _selection() -> list[Case]:
    rng = np.random.default_rng(8)
    cases = []
    for function in ("coverage", "facility-location", "dense", "user"):
        for constraint in selection_problems.CONSTRAINTS:
            problem = selection_problems.random_problem(rng, function, constraint, 6)
            *_, last = selection_problems.feasible_sets(problem)
            answers = [Selection(last), Selection(tuple(range(problem.num_elements)) * 2)]
            cases += _cases_of(problem, selection_problems.optimum(problem), answers)
    graph = random_sensing.random_graph(3, robots=3, targets=3, most_actions=2)
    asked = WinnerTakesAllSATA(graph)
    best = max(asked.evaluate(s).values[0] for s in sata_cases.selections(graph))
    return cases + _cases_of(asked, best, [next(s for s in sata_cases.selections(graph) if len(s) == 3)])


def _arrays() -> list[Case]:
    cases = []
    for sense, low, high, duals, best, answer in (
        ("max", -math.inf, [4.0, 6.0], [3.0, 0.0], 12.0, [4.0, 0.0]), ("min", [4.0, 6.0], math.inf, [2.0, 0.0], 8.0, [0.0, 4.0]),
    ):  # fmt: skip
        problem = ArrayProblem(program([3.0, 2.0], [[1, 1], [1, 3]], low, high, 0, 10, sense=sense))
        proof = Evidence("lp-dual", "duals by hand", best, {"duals": duals})
        cases += _cases_of(problem, best, [np.array(answer), np.array([20.0, -3.0])], proof)
    bent = ArrayProblem(program([1.0, 1.0], [[1, 1]], -math.inf, 3.0, [0, -1], [1, 2], integer=[0], quadratic=[[0, -3], [-3, 0]]))
    proof = Evidence("quadratic-duals", "planes by hand", -3.0, {"duals": [0.0], "shares": [0.5]})
    return cases + _cases_of(bent, -3.0, [np.array([1.0, 2.0]), np.array([0.5, 0.0])], proof)


def _uncertain_paths() -> list[Case]:
    cases = []
    for risk in (0.5, 1e-6):
        problem = wb.UncertainPath(graph_of(WORKED), risk)
        best = min(problem.value(*moments) for moments in all_paths(problem.graph).values())
        cases += _cases_of(problem, best, [problem.answer_of(["S", "A", "G"]), problem.answer_of(["S", "C", "G"])])
    return cases


def _bins() -> list[Case]:
    """A sum, a largest cost, robots and bins of which some are left over on both sides, and too few bins."""
    cases = _cases_of(worked("O"), 4.0, [(1, 0), (0, 1)])
    cases += _cases_of(worked("O", objective="bottleneck"), 2.0, [(1, 0), (0, 1)])
    apart = wb.BinAssignment.from_matrix([[4.0, np.inf, np.inf], [3.0, np.inf, np.inf], [1.0, 5.0, 7.0]])
    cases += _cases_of(apart, 8.0, [(-1, 0, 1), (0, -1, 2)])
    return cases + _cases_of(wb.BinAssignment.from_matrix([[1.0], [2.0]], match="robots"), None, [(0, -1)])


def _allocations() -> list[Case]:
    """Two margins that share a risk, the second dearer; as a cost and as a reward, and where no risk is enough."""
    worth = lambda first: float(-ndtri(first) - 3.0 * ndtri(0.1 - first))  # noqa: E731
    best = float(minimize_scalar(worth, bounds=(1e-9, 0.05), method="bounded", options={"xatol": 1e-12}).fun)
    answers = [Allocation.of(margin, risks) for margin, risks in (([2.0, 1.5], None), ([1.7, 1.7], [0.05, 0.05]), ([1.0, 1.0], None))]
    cases = _cases_of(risk_problems.margins([1.0, 3.0], 0.1), best, answers)
    reward = risk_problems.problem()
    cases += _cases_of(reward, 20.0 - best, [Allocation(5.0 - answer.decision, answer.risks) for answer in answers])
    return cases + _cases_of(risk_problems.problem(constraints={"decisions": [[1, 1]], "lower": 9}), None, [Allocation.of([4.5, 4.5])])


def _risky() -> list[Case]:
    cases = []
    for problem in (risky_cases.mud(), risky_cases.refusal(), risky_cases.two_ways()):
        found = risky_cases.best(problem)
        answers = [path for path in risky_cases.all_paths(problem) if problem.evaluate(path).feasible][:2]
        cases += _cases_of(problem, found, [*answers, (problem.graph.start,)])
    return cases


def _late() -> list[Case]:
    """Routes that may take too long with some probability, each by itself or any of them."""
    cases = []
    for feature in ("route-risk", "team-risk"):
        made = (small_routing.varied(feature, seed) for seed in range(60))
        asked = (p for p in made if BOUNDS["deviation-chord"].evidence(p, Stop(HANG), None, None) is not None)
        problem, best = next((p, best) for p in asked if (best := best_values(p)) is not None)
        cases += _cases_of(problem, best[0], [wb.Routes.of([[c] for c in problem.customers.tolist()])])
    return cases


def _orchard() -> list[Case]:
    """One robot, one bin beside the repository: a step there, and one back."""
    day = orchard_cases.retrievals([(0, 1)], [0], [(0, 0)])
    return _cases_of(day, 2.0, [day.answer_at_hand()])


def _tasks() -> list[Case]:
    cases = []
    for objective in task_problems.OBJECTIVES:
        paths = task_problems.line([0, 10], [4, 6, 1, 9], objective)
        best = task_problems.best_paths_value(paths.instance, objective)
        cases += _cases_of(paths, best, [((2, 0), (1, 3)), paths.answer_at_hand()])
    parts = task_problems.parts([0, 1, 2, 6, 7], weights=[1, 0, 2, 0, 1])
    return cases + _cases_of(parts, task_problems.best_partition_value(parts), [((0, 1, 2), (3, 4)), parts.answer_at_hand()])


def _jobs_and_errands() -> list[Case]:
    """Costs and profits within capacities, too little capacity, errands, and rooms in contact."""
    cases = []
    for objective in ("cost", "profit"):
        jobs = knapsack_assignments.worked(objective)
        cases += _cases_of(jobs, knapsack_assignments.enumerated(jobs), [(0, 1, 0), (0, 0, 0)])
    crowded = wb.GeneralisedAssignment.from_arrays([[1.0, 2.0], [3.0, 1.0]], [[3.0, 4.0], [4.0, 3.0]], [3.0, 2.0])
    needs = [reason.evidence for reason in crowded.infeasibility_reasons()]
    cases += _cases_of(crowded, None, [(0, 0)], *(need for need in needs if need is not None), look=False)
    together = joint_assignments.WORKED
    best = joint_assignments.enumerated(together)
    cases += _cases_of(together, best, [together.answer_at_hand(), ((0, 1), (1, 0)), ((0, 0), (0, 0))])
    halls = explorations.path(4, 1, 4, 2, 2, heard=((0, 1),))
    return cases + _cases_of(halls, explorations.enumerated(halls), [halls.answer_at_hand(), (((2, 0),) * 4,) * 2])


@cache
def pool(whole: bool) -> list[Case]:
    """Certificates of all families, the whole of them with every kind of evidence."""
    of_risk = [*_uncertain_paths(), *_allocations(), *_risky()]
    of_robots = [*_bins(), *_tasks(), *_orchard(), *([*_late(), *_jobs_and_errands()] if whole else [])]
    of_routing = _routing(FEATURES if whole else FEATURES[:1])
    cases = [*of_routing, *_without_answer(), *_max_min(), *_selection(), *_arrays(), *of_risk, *of_robots]
    for case in cases:
        made = accepted(case, copy.deepcopy(case.data))
        assert made is not None, case.problem.name
        assert made.bound == case.data["bound"] and made.infeasible == (case.best is None)
    assert not whole or {case.data["evidence"][0]["kind"] for case in cases} == set(CHECKERS)
    return cases


# -- changes ---------------------------------------------------------------------------------------------------------------

FACTORS = (1 + 1e-3, 1 - 1e-3, 1 + 1e-5, 1.01, 0.9, 2.0, 0.5, 10.0, -1.0, 0.0, 1e-9, 1e9, 1e300)
ODD: tuple[Any, ...] = (
    math.nan, math.inf, -math.inf, 10**400, -(10**400), 10**5000, 1e308, 5e-324, -0.0, 2**63, True, False, None, "", "1", "inf", "nan", [],
    {}, [[]], [1, 2], {"a": 1}, "x\x1b[31m\x07\nbound  999999, verified: optimal", "\u202e\u200b\ud800", "y" * 100_000, b"bytes",
    (1.0, 2.0), {1.5}, [0] * 1000,
)  # fmt: skip
BOAST = {"ratio": 1.0, "statement": "optimal\x1b[0m", "assumptions": [], "source": "\n"}
BOASTS: tuple[tuple[str, Any], ...] = (
    ("feasible", True), ("feasible", False), ("infeasible", True), ("gap", 0.0), ("gap", 0), ("gap", -1.0), ("observed_ratio", 1.0),
    ("observed_ratio", 0.5), ("guarantee", BOAST), ("guarantee", {"ratio": 0.1}), ("checks", []), ("violations", []), ("bound", 0),
    ("objective", 0), ("objective", [1.0, 2.0]), ("evidence", []), ("bound_source", "Concorde"), ("schema", 1.0),
)  # fmt: skip


def _places(data: Any, above: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    return [above, *(path for key, value in items for path in _places(value, (*above, key)))]


def tampered(case: Case, others: list[Case], rng: random.Random) -> dict[str, Any]:
    """The certificate after one to three changes."""
    data = copy.deepcopy(case.data)
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        way = rng.random()
        if way < 0.2:
            key = rng.choice(("bound", "objective", "gap", "observed_ratio"))
            value = data.get(key)
            if isinstance(value, int | float):
                data[key] = _scaled(value, rng)
        elif way < 0.35:
            key, value = rng.choice(BOASTS)
            data[key] = copy.deepcopy(value)
        elif way < 0.45:
            other = rng.choice(others).data
            key = rng.choice(("evidence", "checks", "violations", "bound", "objective", "guarantee", "gap", "bound_source"))
            data[key] = copy.deepcopy(other[key])
        else:
            path = rng.choice(_places(data)[1:] or [()])
            if path:
                _changed(data, path, rng)
    return data


def _scaled(value: float, rng: random.Random) -> float:
    return float(min(max(value, -1e308), 1e308)) * rng.choice(FACTORS) + rng.choice((0.0, 0.0, 0.0, 1e-3, -1e-3, 1.0))


def _changed(data: Any, path: tuple[Any, ...], rng: random.Random) -> None:
    part = data
    for key in path[:-1]:
        part = part[key]
    key, value = path[-1], part[path[-1]]
    way = rng.random()
    if way < 0.5 and isinstance(value, int | float) and not isinstance(value, bool):
        part[key] = _scaled(value, rng)
    elif way < 0.6 and isinstance(value, list) and value:
        cut = rng.randrange(len(value))
        part[key] = rng.choice((value[:cut], value[::-1], value * 2, [*value, value[cut]], value[cut:] + value[:cut]))
    elif way < 0.7:
        del part[key]
    elif way < 0.75 and isinstance(part, dict):
        part[rng.choice((f"{key} ", key.upper(), "__class__", ""))] = part.pop(key)
    elif way < 0.8 and isinstance(part, dict):
        part[key] = copy.deepcopy(part[rng.choice(list(part))])
    else:
        part[key] = copy.deepcopy(rng.choice(ODD))


# -- the judgement ---------------------------------------------------------------------------------------------------------


def accepted(case: Case, data: dict[str, Any]) -> Certificate | None:
    """What the check makes of a certificate, None where it refuses it in one line."""
    try:
        return check_certificate(case.problem, data, case.evaluation)
    except (InputError, CheckFailedError, UsageError) as error:
        assert str(error).isprintable() and len(str(error)) < 400
        return None


def assert_true(case: Case, data: dict[str, Any], made: Certificate) -> None:
    """Nothing that the accepted certificate states, and nothing that is shown of it, is false."""
    sign = 1.0 if case.problem.sense == "min" else -1.0
    holds = lambda bound: case.best is None or sign * bound <= sign * case.best + NEAR * max(1.0, abs(case.best))  # noqa: E731
    judged = case.evaluation
    assert made.bound is None or holds(made.bound)
    if data.get("bound") is not None and not made.infeasible:
        assert holds(data["bound"]) and made.bound is not None
    assert not (data.get("infeasible") or made.infeasible) or case.best is None
    for piece in data.get("evidence", []):
        assert isinstance(piece["value"], str) or made.infeasible or holds(piece["value"])
    if judged is not None:
        assert data.get("feasible") in (None, judged.feasible)
        assert made.feasible == judged.feasible and made.objective == judged.objective
        if data.get("feasible") is not None:
            own = {(c.name, c.passed, c.tested) for c in judged.checks}
            assert {(c["name"], c["passed"], c["tested"]) for c in data.get("checks") or ()} <= own
            names = {v.check for v in judged.violations}
            assert {v["check"] for v in data.get("violations") or ()} <= names
            assert not names or data.get("violations") != []
        if data.get("objective") is not None:
            stated = data["objective"] if isinstance(data["objective"], list) else [data["objective"]]
            assert np.allclose(stated, judged.values, rtol=NEAR, atol=NEAR)
        if judged.feasible and case.best is not None:
            value = judged.values[0]
            if data.get("gap") is not None:
                assert math.isfinite(data["gap"])
                assert data["gap"] >= abs(case.best - value) / max(abs(value), 1e-9) - 2 * NEAR
            if data.get("observed_ratio") is not None:
                better, worse = sorted((abs(case.best), abs(value)))
                assert data["observed_ratio"] * better >= worse * (1 - 2 * NEAR) - 2 * NEAR
    assert made.guarantee is None
    lines = certificate_lines(made)
    shown = as_text(certificate_title(made), lines).split("\n")
    assert len(shown) == 1 + len(lines) and all(line.isprintable() for line in shown)
    assert all("not verified" in line.text for line in lines if line.label == "guarantee")
    assert all("in the file" in line.text for line in lines if line.label == "bound" and made.bound is not None)
    if len(data.get("bound_source") or "") > 5000:
        assert max(map(len, shown)) < 4000


@pytest.mark.parametrize("whole", [pytest.param(True, marks=pytest.mark.slow), False])
def test_no_tampered_certificate_is_accepted_with_anything_false(whole: bool, share: Callable[[int, int], int], tally: Any) -> None:
    cases = pool(whole)
    tally["certificates that are tampered with"] = len(cases)
    rng = random.Random(20)
    for number in range(share(60, 50_000 if whole else 0)):
        case = cases[number % len(cases)]
        data = tampered(case, cases, rng)
        if number % 5 == 0:
            try:
                data = parse_json(json.dumps(data, ensure_ascii=rng.random() < 0.5, default=str))
            except (InputError, ValueError):  # no text can say it
                tally["tampered certificates that are no JSON"] += 1
                continue
        made = accepted(case, data)
        tally["tampered certificates"] += 1
        if made is None:
            tally["tampered certificates refused"] += 1
        else:
            assert_true(case, data, made)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"feasible": False}, "states an infeasible answer"),
        ({"feasible": "yes"}, "neither true nor false"),
        ({"checks": [{}]}, "states checks that are not this answer's"),
        ({"gap": 0.5}, "states the gap"),
        ({"observed_ratio": 7.0}, "states the observed_ratio"),
        ({"bound_source": "Concorde"}, "names the source 'Concorde'"),
        ({"guarantee": {"ratio": 0.5, "statement": "", "source": ""}}, "a ratio of at least 1"),
        ({"guarantee": "optimal"}, "guarantee is malformed"),
        ({"violations": [{}]}, "states violations that are not this answer's"),
        ({"evidence": [{}] * 10**6}, "too much evidence"),
        ({"checks": [3]}, "not a list of objects"),
    ],
)
def test_every_field_is_compared(change: dict[str, Any], says: str) -> None:
    case = next(c for c in pool(False) if c.evaluation is not None and c.evaluation.feasible and c.data["gap"] is not None)
    with pytest.raises((InputError, CheckFailedError)) as caught:
        check_certificate(case.problem, {**case.data, **change}, case.evaluation)
    assert says in str(caught.value)


def test_single_checks_and_residuals_are_compared() -> None:
    case = next(
        c for c in pool(False) if c.evaluation is not None and not c.evaluation.feasible and c.evaluation.violations[0].amount > 0.01
    )
    changes = (("checks", {"residual": 9e9}), ("checks", {"passed": 1}), ("checks", {"tested": 99}), ("violations", {"amount": 1e-9}))
    for key, entry in changes:
        data = copy.deepcopy(case.data)
        data[key][0].update(entry)
        with pytest.raises(CheckFailedError, match=f"states {key} that are not"):
            check_certificate(case.problem, data, case.evaluation)


def test_a_guarantee_is_shown_as_the_word_of_the_file() -> None:
    case = next(c for c in pool(False) if c.data["guarantee"] is not None)
    made = check_certificate(case.problem, {**case.data, "guarantee": BOAST}, case.evaluation)
    told = {line.label: line.text for line in certificate_lines(made)}
    assert told["guarantee"] == "stated in the file, not verified: ratio 1: 'optimal [0m' (' ')"
    assert made.to_json()["guarantee"] is None and made.to_json()["stated_guarantee"]["ratio"] == 1.0
