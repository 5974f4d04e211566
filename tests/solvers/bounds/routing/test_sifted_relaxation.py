import numpy as np
import pytest
import scipy.sparse as sp
from programs import AnsweredBy
from scipy.optimize import linprog

from waybound import RoutingProblem, Sites, Travel, VehicleType
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing import sifted_relaxation
from waybound.solvers.bounds.routing.sifted_relaxation import sifted_relaxation_bound


def windows(seed: int, customers: int, **vehicle) -> RoutingProblem:
    rng = np.random.default_rng(seed)
    xy = rng.integers(0, 100, (customers + 1, 2)).astype(float)
    ready = np.append(0, rng.integers(0, 200, customers)).astype(float)
    due = np.append(2000.0, ready[1:] + 150)
    sites = Sites.of(range(customers + 1), demand=np.append(0, rng.integers(1, 9, customers)), ready=ready, due=due, service=5.0)
    return RoutingProblem(sites, Travel("euclidean", coordinates=xy), (VehicleType(**vehicle),))


def by_scipy(program, seconds):
    """Row duals by scipy."""
    a, b = program.matrix, program
    up, down = np.isfinite(b.row_upper), np.isfinite(b.row_lower)
    found = linprog(
        b.cost, A_ub=sp.vstack([a[up], -a[down]]), b_ub=np.concatenate([b.row_upper[up], -b.row_lower[down]]),
        bounds=np.column_stack([b.lower, b.upper]), options={"time_limit": seconds},
    )  # fmt: skip
    if found.status != 0:
        return None
    y = np.zeros(program.num_rows)
    y[up] += found.ineqlin.marginals[: up.sum()]
    y[down] -= found.ineqlin.marginals[up.sum() :]
    return y


def optimum_of_the_whole_lp(problem: RoutingProblem) -> float:
    made = problem.compile("two-index-time-flow", relax=True)
    duals = by_scipy(made.program, 60.0)
    return float(made.dual_evidence(duals).value)


@pytest.mark.parametrize("seed", range(4))
def test_the_verified_bound_is_the_value_of_the_whole_lp(seed):
    problem = windows(seed, 25, capacity=30.0)
    evidence = sifted_relaxation_bound(problem, Stop(20.0), AnsweredBy(by_scipy))
    assert verified_bound(problem, evidence) == evidence.value
    assert evidence.value == pytest.approx(optimum_of_the_whole_lp(problem), rel=1e-5)


def test_few_arcs_are_enough_to_begin_with(monkeypatch):
    sizes = []

    def counting(program, seconds):
        sizes.append(len(program.data))
        return by_scipy(program, seconds)

    problem = windows(1, 25, capacity=30.0)
    monkeypatch.setattr(sifted_relaxation, "NEIGHBOURS", (2, 2))
    evidence = sifted_relaxation_bound(problem, Stop(20.0), AnsweredBy(counting))
    assert evidence.value == pytest.approx(optimum_of_the_whole_lp(problem), rel=1e-5)
    assert sizes[0] < 0.5 * len(problem.compile("two-index-time-flow").program.data)
    assert len(sizes) > 1


def test_it_begins_nothing_that_its_budget_cannot_hold():
    calls = []
    problem = windows(2, 60)
    assert sifted_relaxation_bound(problem, Stop(0.01), AnsweredBy(lambda *a: calls.append(a))) is None
    assert sifted_relaxation_bound(problem, Stop(0.0), AnsweredBy(lambda *a: calls.append(a))) is None
    assert calls == []


@pytest.mark.parametrize("answer", [None, "nan"])
def test_a_solver_that_has_no_duals_gives_no_evidence(answer):
    problem = windows(2, 10)
    duals = (lambda p, s: None) if answer is None else (lambda p, s: np.full(p.num_rows, np.nan))
    assert sifted_relaxation_bound(problem, Stop(60.0), AnsweredBy(duals)) is None


def test_wrong_duals_prove_little_but_never_too_much():
    problem = windows(3, 10, capacity=20.0)
    best = optimum_of_the_whole_lp(problem)
    rng = np.random.default_rng(1)
    evidence = sifted_relaxation_bound(problem, Stop(60.0), AnsweredBy(lambda p, s: 10 * rng.normal(size=p.num_rows)))
    assert evidence.value <= best + 1e-6


def test_it_says_what_it_proves_nothing_for():
    method = BOUNDS["sifted-relaxation"]
    problem = windows(1, 4)
    two = RoutingProblem(problem.sites, problem.travel, (VehicleType(name="a"), VehicleType(name="b", capacity=3.0)))
    assert method.missing(problem) == frozenset()
    assert "heterogeneous-fleet" in method.missing(two)


def test_where_some_customers_ask_for_nothing_the_order_of_visits_is_priced_too():
    rng = np.random.default_rng(3)
    xy = rng.integers(0, 100, (13, 2)).astype(float)
    sites = Sites.of(range(13), demand=np.append(0.0, rng.integers(0, 3, 12)))
    problem = RoutingProblem(sites, Travel("EUC_2D", coordinates=xy), (VehicleType(capacity=4.0),))
    evidence = sifted_relaxation_bound(problem, Stop(10.0))
    assert "order" in evidence.data["resources"]
    assert evidence.value == pytest.approx(np.ceil(optimum_of_the_whole_lp(problem) - 1e-6))
