"""Form ``bipartite``: every solver finds the optimum, and its duals prove it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from bin_assignments import OPTIMA, enumerated, random_costs, worked
from draws import draws
from program_text import expected, written

import waybound as wb
from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.formulations.certificate import verified_bound


@pytest.mark.share(2)
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


CROWDED = """
    robot/bin,a,b,c
    p,4,-,-
    q,3,-,-
    r,5,1.5,7
"""

TWO_ROBOTS = """
    robot/bin,a,b,c
    p,4,-,6
    q,3,2,-
"""


def test_bipartite_from_text_to_text(tmp_path: Path) -> None:
    """Of p and q one gets bin a, the only one of both: two pairs, which are neither all robots nor all bins."""
    assert written(CROWDED, "bipartite", tmp_path) == expected(
        """
        bipartite, exact
        min 4 x[p,a] + 3 x[q,a] + 5 x[r,a] + 1.5 x[r,b] + 7 x[r,c]
        robot[p]: 0 <= x[p,a] <= 1
        robot[q]: 0 <= x[q,a] <= 1
        robot[r]: 0 <= x[r,a] + x[r,b] + x[r,c] <= 1
        bin[a]: 0 <= x[p,a] + x[q,a] + x[r,a] <= 1
        bin[b]: 0 <= x[r,b] <= 1
        bin[c]: 0 <= x[r,c] <= 1
        pairs: x[p,a] + x[q,a] + x[r,a] + x[r,b] + x[r,c] = 2
        x[p,a], x[q,a], x[r,a], x[r,b], x[r,c] binary
        """
    )


def test_robots_that_are_all_asked_for_have_equations(tmp_path: Path) -> None:
    assert written(TWO_ROBOTS, "bipartite", tmp_path) == expected(
        """
        bipartite, exact
        min 4 x[p,a] + 6 x[p,c] + 3 x[q,a] + 2 x[q,b]
        robot[p]: x[p,a] + x[p,c] = 1
        robot[q]: x[q,a] + x[q,b] = 1
        bin[a]: 0 <= x[p,a] + x[q,a] <= 1
        bin[b]: 0 <= x[q,b] <= 1
        bin[c]: 0 <= x[p,c] <= 1
        x[p,a], x[p,c], x[q,a], x[q,b] binary
        """
    )
