"""Form ``bipartite``: every solver finds the optimum, and its duals prove it."""

from __future__ import annotations

import numpy as np
import pytest
from bin_assignments import OPTIMA, enumerated, random_costs, worked
from draws import draws

import waybound as wb
from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.formulations.certificate import verified_bound


@pytest.mark.parametrize("solver", ["highs", "cpsat", "pulp", "mathopt:highs", "scip"])
def test_solvers_agree_on_worked_assignments(solver: str) -> None:
    for name in ("E", "K4"):
        found = wb.solve(worked(name), solver, form="bipartite", bound_time=60)
        assert (found.objective, found.status, found.bound_kind) == (OPTIMA[name], "optimal", "verified")


def test_duals_of_the_linear_relaxation_prove_the_optimum_whatever_is_asked_for() -> None:
    from waybound.solvers.backend import BACKENDS, Control, Options

    rng = np.random.default_rng(6)
    for _ in range(draws(40)):
        costs = random_costs(rng, 5)
        problem = BinAssignment.from_matrix(costs)
        if not problem.pairs:
            continue
        made = problem.compile("bipartite", relax=True)
        raw = BACKENDS["highs"]().run(made.program, Options(), Control())
        assert made.dual_evidence is not None and raw.row_duals is not None
        best = enumerated(costs)[1]
        assert verified_bound(problem, made.dual_evidence(raw.row_duals)) == pytest.approx(best, abs=1e-7)
        assert problem.evaluate(made.decode(raw.answer)).values[0] == pytest.approx(best, abs=1e-7)
