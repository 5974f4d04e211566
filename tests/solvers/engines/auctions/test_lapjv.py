import numpy as np
import pytest
from bin_assignments import OPTIMA, enumerated, random_costs, worked
from draws import draws

import waybound as wb
from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.instances.generating import generate
from waybound.solvers.backend import BACKENDS, Control, Options
from waybound.solvers.engines.auctions import lapjv


@pytest.mark.parametrize("name", OPTIMA)
def test_worked_assignments_are_optimal_by_their_prices(name: str) -> None:
    found = wb.solve(worked(name), "lapjv")
    assert (found.solver, found.objective, found.bound, found.bound_kind) == ("lapjv", OPTIMA[name], OPTIMA[name], "verified")


@pytest.mark.parametrize("filled", [lapjv.MOST_FILLED, 0])
def test_forbidden_pairs_and_zero_costs_are_taken_dense_and_sparse(filled: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lapjv, "MOST_FILLED", filled)
    monkeypatch.setattr(lapjv.LapjvEngine, "apart", lambda engine, problem: False)  # a process each takes half a second
    rng = np.random.default_rng(7)
    for _ in range(draws(60)):
        costs = random_costs(rng, 5)
        found = wb.solve(BinAssignment.from_matrix(costs), "lapjv")
        most, best, _ = enumerated(costs)
        assert found.status == "optimal" and found.objective == pytest.approx(best, abs=1e-9) and not found.faults
        assert most == 0 or (found.bound_kind == "verified" and found.bound == pytest.approx(best, abs=1e-9))


def test_sparse_data_agree_with_the_auction() -> None:
    problem = BinAssignment(generate("assignment", 1, robots=300, bins=300, arcs=8))
    assert wb.solve(problem, "lapjv").objective == pytest.approx(wb.solve(problem, heuristic="bertsekas").objective, rel=1e-12)


def test_no_optimum_is_claimed_that_the_prices_do_not_prove() -> None:
    costs = [[5e-09, 8e9, -8e-09], [0.0, 8e-09, -1e9], [4e-09, 3e9, 0.0]]  # sums beside 1e9 lose them
    raw = BACKENDS["lapjv"]().run(BinAssignment.from_matrix(costs), Options(time_limit=10.0), Control())
    assert raw.objective is not None and raw.objective > 4e-9 * 2, "the library is right by now: find other costs"
    assert raw.status == "feasible" and raw.bound is None and "do not prove it optimal" in raw.message


@pytest.mark.slow
def test_what_holds_the_lock_runs_in_a_process_of_its_own() -> None:
    engine = BACKENDS["lapjv"]()
    few, many = (BinAssignment(generate("assignment", 1, robots=n, bins=n, arcs=3)) for n in (50, 2_100))
    assert not engine.apart(few) and engine.apart(many)
    assert wb.solve(many, "lapjv").status == "optimal"
