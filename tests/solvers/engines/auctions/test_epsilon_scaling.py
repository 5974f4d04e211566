import subprocess
import sys

import numpy as np
import pytest
from bin_assignments import OPTIMA, enumerated, random_costs, worked
from draws import draws

import waybound as wb
from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.formulations.stop import NEVER
from waybound.solvers.backend import BACKENDS, Control, Options
from waybound.solvers.engines.auctions.assignment_steps import auction as steps, recovered_prices


@pytest.mark.parametrize("name", OPTIMA)
def test_worked_assignments_are_optimal_by_their_prices_and_it_is_the_default(name: str) -> None:
    found = wb.solve(worked(name))
    assert (found.solver, found.objective, found.bound, found.bound_kind) == ("epsilon-scaling", OPTIMA[name], OPTIMA[name], "verified")


def test_random_assignments_with_forbidden_pairs_are_those_of_enumeration() -> None:
    rng = np.random.default_rng(11)
    for _ in range(draws(60)):
        costs = random_costs(rng, 5)
        found = wb.solve(BinAssignment.from_matrix(costs), "epsilon-scaling")
        most, best, _ = enumerated(costs)
        assert found.status == "optimal" and found.objective == pytest.approx(best, abs=1e-9) and not found.faults
        assert most == 0 or (found.bound_kind == "verified" and found.bound == pytest.approx(best, abs=1e-9))


@pytest.fixture(autouse=True)
def compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few pairs too are for the auction here."""
    monkeypatch.setattr(recovered_prices, "FEW_PAIRS", 0)


def test_few_pairs_load_no_compiled_loop() -> None:
    code = (
        "import sys, numpy as np, waybound as wb\n"
        "made = wb.solve(wb.BinAssignment.from_matrix(np.random.default_rng(1).random((30, 40))), bound_time=0)\n"
        "assert made.solver == 'epsilon-scaling' and made.status == 'optimal' and made.bound_kind == 'verified'\n"
        "assert 'numba' not in sys.modules\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr


def test_where_its_prices_prove_nothing_shortest_paths_begin_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = worked("O")
    monkeypatch.setattr(steps, "auction", lambda problem, stop: steps.Auction((), complete=False))
    raw = BACKENDS["epsilon-scaling"]().run(problem, Options(time_limit=10.0), Control())
    assert raw.status == "optimal" and raw.evidence[0].source == "prices of the assignment, by shortest paths"


def test_a_search_that_is_cut_short_has_the_most_pairs() -> None:
    control = Control()
    control.stop()
    raw = BACKENDS["epsilon-scaling"]().run(worked("O"), Options(time_limit=10.0), control)
    assert raw.status == "feasible" and raw.answer == worked("O").answer_at_hand() and "cut short" in raw.message


def scarce(n: int) -> np.ndarray:
    """Few bins that are cheap for all, the others dear: the cheapest pairs of a row say nothing of what it will pay."""
    costs = np.full((n, n), 1e6)
    costs[:, :30] = np.arange(30)[None]
    return costs


def uniform(n: int) -> np.ndarray:
    return np.random.default_rng(3).random((n, n))


@pytest.mark.parametrize("made", [scarce, uniform])
def test_a_small_first_epsilon_is_given_up_where_many_bid_and_the_optimum_is_proved(made) -> None:
    problem = BinAssignment.from_matrix(made(200))
    found = steps.auction(problem, NEVER)
    value = problem.evaluate(found.answer).values[0]
    assert found.evidence(problem, "prices").value == pytest.approx(value, rel=1e-9)
    assert found.bids < 100 * 200
