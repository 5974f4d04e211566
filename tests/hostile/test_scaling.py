"""The same problem in other units: the same verdicts, answers and ratios, and bounds in proportion, whatever finds or checks them."""

import itertools
import math
from collections.abc import Callable, Iterable
from dataclasses import fields
from typing import Any

import numpy as np
import pytest
from hostile_instances import AT_RISK, FAMILIES as EXACT, UNCERTAIN, Rng, Units, shaken
from hostile_judging import away

import waybound as wb
from waybound import CheckFailedError, Problem, Routes, RoutingProblem, Selection, WayboundError
from waybound.formulations.evidence import CHECKERS, Evidence
from waybound.formulations.forms import FORMS
from waybound.formulations.verified_bounds import verified_bound
from waybound.heuristics.heuristic import HEURISTICS
from waybound.solvers.backend import BACKENDS
from waybound.solving.bounding import find_bounds

FAMILIES = EXACT | UNCERTAIN
SEED = 83
POWERS = (-30, -10, 10, 30)
SAME = 1e-9
VECTOR = 1e-6
"""Linear programs, from which bounds come, end near an optimum, and may end at another point of the same value."""

CLAIM = 1e-5
"""Solvers accept points that are off by 1e-6 a row and a variable."""

SOLVERS = {
    "highs": 30, "saddle": 60, "scip": 10, "cpsat": 10, "pulp": 5, "pulp:HiGHS": 1, "mathopt:highs": 1, "mathopt:gscip": 5,
    "mathopt:glop": 5, "mathopt:cp-sat": 5, "mathopt:pdlp": 3, "cvxpy": 1, "cvxpy:HIGHS": 1, "cvxpy:SCS": 1, "pyvrp": 20, "ortools": 5,
    "vroom": 5, "vrpsolver": 3,
    "supported-paths": 60, "non-dominated-paths": 30, "risk-labels": 30, "path-enumeration": 15, "convex-allocation": 30,
    "exact-joint": 5, "epsilon-scaling": 100, "lapjv": 100, "min-cost-flow": 5, "threshold-matching": 100,
}  # fmt: skip
"""Solvers, and how many problems of each family they get: few where each starts a process."""

SELDOM = 0.03
"""Share of problems on which a solver of others may give up in one unit only."""

GIVEN_UP = "given up in one unit only: {}"

QUICK = ("highs", "saddle", "supported-paths", "risk-labels", "convex-allocation")
"""Those that the fast suite has time for."""


def two_units(rng: Rng) -> tuple[Units, Units]:
    """Two systems of units: a common power of two apart, or each kind of quantity by one of its own."""
    if rng.random() < 0.6:
        return Units(), Units.common(2.0 ** int(rng.choice(POWERS)))
    many = len(fields(Units))
    a, b = (Units(*(2.0 ** rng.integers(-30, 31, many)).tolist()) for _ in range(2))
    return a, b


def pair(family: str, case: int) -> tuple[Problem, Problem, list[float], Callable[[str], float]]:
    """A problem in two units, the factors of its values, level by level, and those of other quantities by name."""
    for attempt in range(100):
        seed = [SEED, case, attempt]
        a, b = two_units(np.random.default_rng(seed))
        first, second = ((FAMILIES | AT_RISK)[family](np.random.default_rng(seed), u) for u in (a, b))
        if _exact(first) and _exact(second):
            break
    unit = lambda name: float(getattr(b, name) / getattr(a, name))  # noqa: E731
    return first, second, _factors(first, unit), unit


def _exact(problem: Problem) -> bool:
    """Whether no number is so small that other units would cut off its digits."""
    p: Any = problem
    if isinstance(p, RoutingProblem):
        data = [p.sites.demand, p.sites.ready, p.sites.due, p.sites.service, p.sites.reward, p.travel.distances, p.travel.durations]
    elif p.family == "uncertain-path":
        data = [p.graph.mean, p.graph.variance]
    elif p.family == "bin-assignment":
        data = [p.cost]
    elif p.family == "generalised-assignment":
        data = [p.instance.values[p.instance.listed], p.instance.consumption, p.instance.capacity]
    elif p.family == "joint-assignment":
        data = [p.costs[np.isfinite(p.costs)], p.instance.between]
    elif p.family == "room-exploration":
        data = [p.instance.exploring, p.instance.mapping, p.instance.searching]
    elif p.family == "risky-path":
        data = [p.rewards]
    elif p.family == "risk-allocation":
        return True
    elif p.family in ("task-allocation", "balanced-partition"):
        data = [p.instance.distances, p.instance.weights]
    elif hasattr(p, "graph"):
        data = [p.graph.weights]
    elif hasattr(p, "packing"):
        data = [p.packing.data, p.covering.data]
    elif hasattr(p, "program"):
        data = [p.program.data, p.program.cost, p.program.row_lower, p.program.row_upper]
    else:
        f = p.function
        if getattr(getattr(f, "matrix", None), "dtype", None) == np.float32:
            return False
        data = [getattr(f, name) for name in ("matrix", "weights", "item_weights") if hasattr(f, name)] + [
            getattr(p.constraint, "costs", [])
        ]
        if f.name == "user":
            data.append(f.evaluate(np.eye(f.num_elements, dtype=bool)))
    sizes = np.abs(np.concatenate([np.asarray(v, dtype=np.float64).ravel() for v in data]))
    return bool((sizes[sizes > 0] > 1e-200).all())


def _factors(problem: Problem, unit: Callable[[str], float]) -> list[float]:
    if isinstance(problem, RoutingProblem):
        made = []
        for level in problem.objective.levels():
            names = {t.name for _, t in level.terms}
            own = {"reward": "reward", "total-cost": "cost", "longest-route": "distance", "makespan": "time"}
            made.append(next((unit(quantity) for name, quantity in own.items() if name in names), 1.0))
        return made
    if problem.problem == "max-min-lp":
        return [unit("weight") / unit("load") if problem.sense == "max" else unit("load") / unit("weight")]
    if problem.family == "risky-path":
        return [unit("reward") if problem.sense == "max" else 1.0]
    if problem.family == "room-exploration":
        return [unit("reward")]
    costs = ("arrays", "uncertain-path", "risk-allocation", "bin-assignment", "generalised-assignment", "joint-assignment")
    return [unit("cost" if problem.family in costs else "weight")]


def listed(value: Any, factors: Iterable[float] = ()) -> list[float | None]:
    """Values level by level, divided by their factors."""
    values = value if isinstance(value, list) else [value]
    return [None if v is None else v / f for v, f in zip(values, factors, strict=True)]


def told(problem: Problem, keywords: dict[str, Any], factors: list[float]) -> dict[str, Any]:
    """What ``solve`` says, in the units of factor 1; how it fails, where it does."""
    try:
        # OR-Tools counts solutions: where there are fewer, only time ends it.
        seconds = 10.0 if keywords.get("solver") == "ortools" else 120.0
        s = wb.solve(problem, time_limit=seconds, bound_time=5.0, **keywords)
    except CheckFailedError:
        return {"failed": "a claim does not hold up"}
    except WayboundError as fault:
        return {"failed": type(fault).__name__}
    answer = s.answer.canonical() if isinstance(s.answer, Routes) else s.answer.elements if isinstance(s.answer, Selection) else None
    bound = s.bound if s.bound is None or isinstance(s.bound, list) else [s.bound]
    return {
        "status": s.status, "limit": s.limit, "objective": listed(s.objective, factors) if s.answer is not None else None, "answer": answer,
        "bound": None if bound is None else listed(bound, factors), "bound_kind": s.bound_kind, "infeasible": s.certificate.infeasible,
        "verified": None if s.certificate.bound is None else [s.certificate.bound / factors[0]], "ratio": s.certificate.observed_ratio,
        "gap": s.gap,
    }  # fmt: skip


def differences(a: dict[str, Any], b: dict[str, Any], close: float) -> list[str]:
    """What two accounts disagree in: objectives by more than ``close``, bounds and what rests on them by more than ``VECTOR`` too."""
    loose = max(close, VECTOR)

    def levels(name: str, within: float) -> bool:
        pairs = zip(a.get(name) or [None], b.get(name) or [None], strict=True)
        return all((v is None) == (w is None) and (v is None or _near(v, w, within)) for v, w in pairs)

    def closed(account: dict[str, Any]) -> bool:
        return account["status"] == "optimal" or (account["gap"] is not None and account["gap"] <= loose)

    found = []
    for name in sorted(a.keys() | b.keys()):
        x, y = a.get(name), b.get(name)
        if name in ("objective", "bound", "verified"):
            alike = levels(name, close if name == "objective" else loose)
        elif name in ("ratio", "gap") and x is not None and y is not None:
            alike = _near(1.0 + x, 1.0 + y, loose)
        elif name == "status" and {x, y} == {"optimal", "feasible"}:
            alike = closed(a) and closed(b)
        elif name == "bound_kind" and x and y:
            alike = levels("bound", loose)  # a claim that is better by a rounding error
        else:
            # Another answer of the same value is as good.
            alike = x == y or name == "answer"
        if not alike:
            found.append(f"{name}: {x!r} against {y!r}")
    return found


def _near(v: float, w: float, close: float) -> bool:
    return v == w or (math.isfinite(v) and math.isfinite(w) and away(v, w) <= close)


def gave_up(account: dict[str, Any]) -> bool:
    """Whether it says nothing about the problem, or nothing that holds up."""
    return "failed" in account or account["status"] in ("unknown", "error")


def disagreements(family: str, case: int, keywords: dict[str, Any], tally: Any) -> list[str]:
    """What a method says of one problem in one unit and not in another.

    A solver of others may give up in one unit, as its tolerances are its own: that is counted, and may be seen ``SELDOM``.
    """
    first, second, factors, _ = pair(family, case)
    close = CLAIM if "solver" in keywords else VECTOR if first.problem in ("max-min-lp", "bottleneck-lp", "risk-allocation") else SAME
    a, b = told(first, keywords, [1.0] * len(factors)), told(second, keywords, factors)
    if keywords.get("solver", "saddle") != "saddle" and gave_up(a) != gave_up(b):
        tally[GIVEN_UP.format(keywords["solver"])] += 1
        return []
    found = differences(a, b, close)
    return [f"{family} {case} {keywords}: {found}"] if found else []


def meant_for(solver: str, problem: Problem) -> bool:
    """Whether a solver may take problems of this family: an engine takes those of one."""
    kind: Any = BACKENDS[solver.partition(":")[0]]
    return kind.takes != "problem" or kind.family == problem.family


def able(problem: Problem, solver: str) -> bool:
    base, _, variant = solver.partition(":")
    kind: Any = BACKENDS[base]
    if not kind.installed():
        return False
    if kind.takes == "problem":
        return not kind().missing(problem)
    made = kind(variant) if variant else kind()
    return any(made.able(FORMS[form].makes(problem)) for form in problem.forms())


@pytest.mark.filterwarnings("ignore::RuntimeWarning", "ignore::UserWarning")
@pytest.mark.parametrize("family", FAMILIES)
def test_heuristics_in_other_units(family: str, share: Callable[[int, int], int], tally: Any) -> None:
    found = []
    for case in range(share(1, 100)):
        first = pair(family, case)[0]
        names = [name for name in HEURISTICS if not HEURISTICS[name].missing(first)]
        if share(1, 2) == 1 and names:
            names = [names[case % len(names)]]
        for name in names:
            found += disagreements(family, case, {"heuristic": name}, tally)
            tally["heuristics in other units"] += 1
    assert not found, f"{len(found)}: {found[:5]}"


@pytest.mark.share(2)
@pytest.mark.filterwarnings("ignore::RuntimeWarning", "ignore::UserWarning", "ignore::FutureWarning")
@pytest.mark.parametrize("solver", [pytest.param(s, marks=[] if s in QUICK else pytest.mark.hostile) for s in SOLVERS])
def test_solvers_in_other_units(solver: str, share: Callable[[int, int], int], tally: Any) -> None:
    keywords: dict[str, Any] = {"solver": solver}
    if solver in ("pyvrp", "ortools"):
        keywords["iterations"] = 30
    found = []
    most = share(1, SOLVERS[solver])
    for family in FAMILIES:
        tried = range(10 * most if meant_for(solver, pair(family, 0)[0]) else 0)
        taken = (case for case in tried if able(pair(family, case)[0], solver))
        for case in itertools.islice(taken, most):
            found += disagreements(family, case, keywords, tally)
            tally[f"solvers in other units: {solver}"] += 1
    assert not found, f"{len(found)}: {found[:5]}"
    assert tally[GIVEN_UP.format(solver)] <= max(1, SELDOM * tally[f"solvers in other units: {solver}"])


# -- evidence --------------------------------------------------------------------------------------------------------------


def in_units(e: Evidence, factor: float, unit: Callable[[str], float]) -> dict[str, Any]:
    """The data of an evidence as the same evidence in other units has them."""
    if e.kind == "branching-tree":
        leaves = [Evidence(node.get("kind", ""), "", 0.0, node.get("data", {})) for node in e.data["nodes"]]
        pairs = zip(e.data["nodes"], leaves, strict=True)
        return {
            "nodes": [
                node_in_units(node, unit) | ({"data": in_units(leaf, factor, unit)} if "data" in node else {}) for node, leaf in pairs
            ]
        }
    if e.kind in ("averaged-tour", "deviation-chord"):
        return {**e.data, "data": in_units(Evidence(e.data["kind"], "", 0.0, e.data["data"]), factor, unit)}
    own = {"time": "time", "duration": "time", "load": "load", "distance": "distance", "energy": "energy"}
    counted = unit(own[e.data["resource"]]) if e.data.get("resource") in own else 1.0
    per = {
        "state-space": {"prices": factor, "step": counted}, "knapsack": {"rate": factor / counted},
        "vehicles-needed": {"threshold": unit("load")}, "cut-multipliers": {"out": factor, "in": factor},
        "item-prices": {"prices": unit("weight")}, "spanning-tree": {"multipliers": factor, "depot": factor},
        "arc-multipliers": {"out": factor, "in": factor, "fleet": factor}, "lp-dual": {"duals": unit("cost") / unit("load")},
        "bin-packing": {"threshold": unit("load")}, "set-partitioning-duals": dict.fromkeys(("visits", "least", "least_needed"), factor),
        "customer-sets": {"longest-route": unit("distance"), "makespan": unit("time")},
        "too-little-time": {"from": unit("time"), "until": unit("time")}, "all-paths": {"target": factor},
        "path-potentials": {"potentials": factor}, "task-forest": {"tasks": factor, "robots": factor},
        "assignment-prices": {"prices": factor, "level": factor}, "job-prices": {"prices": factor},
        "errand-prices": dict.fromkeys(("bins", "requests", "pickup", "delivery"), factor),
        "risk-allocation-duals": {
            "rows": factor / unit("budget"), "chance": factor / unit("weight"), "budgets": factor, "terms": factor / unit("distance"),
        },
    }.get(e.kind, {})  # fmt: skip
    priced = ("resources", "shares", "rates")
    made = {name: times(value, per.get(name, 1.0)) for name, value in e.data.items() if name not in priced}
    for part in (part for part in priced if part in e.data):
        made[part] = {name: times(values, factor / (unit(own[name]) if name in own else 1.0)) for name, values in e.data[part].items()}
    if e.kind == "path-potentials":  # a mean + b variance, of which the one is in the square of the unit of the other
        made["weights"] = [[a, b / factor] for a, b in made["weights"]]
    lists = {"cut-multipliers": ("cuts",), "set-partitioning-duals": ("rows", "loads", "needed")}.get(e.kind, ())
    for part in (part for part in lists if part in e.data):
        made[part] = [{**entry, "price": factor * entry["price"]} for entry in e.data[part]]
    return made


def node_in_units(node: dict[str, Any], unit: Callable[[str], float]) -> dict[str, Any]:
    """A node whose statement may name a limit of the largest route."""
    branch = node.get("branch")
    if not isinstance(branch, dict) or "at_most" not in branch:
        return node
    per = unit("distance" if branch["term"] == "longest-route" else "time")
    return {**node, "branch": {**branch, "at_most": branch["at_most"] * per}}


def times(value: Any, factor: float) -> Any:
    if isinstance(value, list):
        return [times(v, factor) for v in value]
    if isinstance(value, dict) and "values" in value:  # a list without its zeros
        return {**value, "values": times(value["values"], factor)}
    return value * factor if isinstance(value, float) else value


def attempts(problem: RoutingProblem, rng: Rng) -> list[Evidence]:
    """Proofs of the seldom kinds, which need not hold."""
    sites, customers = problem.sites, problem.customers
    moments = [float(v) for v in (sites.ready[customers].min(initial=0.0), sites.due[customers].max(initial=0.0))]
    names = [sites.ids[k] for k in customers.tolist()]
    tried = [Evidence("bin-packing", "", 0.0, {"threshold": float(rng.choice(sites.demand))})]
    if names and math.isfinite(moments[1]):
        tried.append(Evidence("too-little-time", "", 0.0, {"sites": names, "from": moments[0], "until": moments[1]}))
    return tried


def checked(family: str, case: int) -> tuple[list[str], list[str]]:
    """Kinds of evidence that were checked on one problem, and where the bound is another in other units."""
    rng = np.random.default_rng([SEED, case])
    first, second, factors, unit = pair(family, case)
    kinds, found = [], []
    for e in (*find_bounds(first, 1.0), *(attempts(first, rng) if isinstance(first, RoutingProblem) else ())):
        for data in (e.data, shaken(rng, e.data)):
            kinds.append(e.kind)
            bounds = [
                verified_bound(first, Evidence(e.kind, "", 0.0, data)),
                verified_bound(second, Evidence(e.kind, "", 0.0, in_units(Evidence(e.kind, "", 0.0, data), factors[0], unit))),
            ]
            if not _near(bounds[0], bounds[1] / factors[0], SAME):
                found.append(f"{family} {case} {e.kind}: {bounds[0]!r} against {bounds[1] / factors[0]!r} times {factors[0]!r}")
    return kinds, found


@pytest.mark.filterwarnings("ignore::RuntimeWarning", "ignore::UserWarning")
def test_checkers_in_other_units(share: Callable[[int, int], int], tally: Any) -> None:
    found, kinds = [], set()
    for family in FAMILIES | AT_RISK:
        for case in range(share(4, 120)):
            some, wrong = checked(family, case)
            kinds.update(some)
            found += wrong
            tally["evidence checked in other units"] += len(some)
    assert not found, f"{len(found)}: {found[:5]}"
    met = set(CHECKERS) - {"quadratic-duals", "retrievals"}  # no family of these has squares, or steps, which have no unit
    assert share(0, 1) == 0 or kinds >= met, f"never met: {met - kinds}"
