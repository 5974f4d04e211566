from pathlib import Path

import numpy as np
import pytest
from bin_assignments import BOTTLENECKS, OPTIMA, enumerated, random_costs, worked
from coded import coded
from draws import draws
from program_text import expected, program_text, written

import waybound as wb
from waybound import BinAssignment, InputError
from waybound.formulations.auctions.forms.bin_pairs import decoded, encoded, pair_rows
from waybound.formulations.problem import problem_from_instance
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.reading import read_instance
from waybound.solvers.backend import BACKENDS, Control, Options


def test_answers_and_vectors_stand_for_each_other() -> None:
    problem = worked("E")
    assert encoded(problem, (-1, 0, 1)).tolist() == [0, 0, 1, 0, 0, 1]
    assert decoded(problem, encoded(problem, (-1, 0, 1))) == (-1, 0, 1)
    with pytest.raises(InputError, check=coded("unsupported")):
        encoded(BinAssignment.from_matrix([[1.0, np.inf]]), (1,))


def test_who_is_all_asked_for_has_equations_and_else_the_pairs_are_counted() -> None:
    robots, bins = pair_rows(worked("F"))
    assert robots.lower.tolist() == [1, 1] and bins.lower.tolist() == [0, 0, 0]
    inf = np.inf
    few = pair_rows(BinAssignment.from_matrix([[1.0, inf], [2.0, inf]]))
    assert [block.name for block in few] == ["robot", "bin", "pairs"] and few[2].lower.tolist() == few[2].upper.tolist() == [1.0]


@pytest.mark.share(2)
@pytest.mark.parametrize("solver", ["highs", "cpsat", "pulp", "mathopt:highs", "scip"])
def test_solvers_agree_on_worked_assignments(solver: str) -> None:
    for name in ("E", "K4"):
        found = wb.solve(worked(name), solver, form="bipartite", bound_time=60)
        assert (found.objective, found.status, found.bound_kind) == (OPTIMA[name], "optimal", "verified")


def test_duals_of_the_linear_relaxation_prove_the_optimum_whatever_is_asked_for() -> None:
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
    assert written(CROWDED, "bipartite", tmp_path) == expected("""
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
    """)


def test_robots_that_are_all_asked_for_have_equations(tmp_path: Path) -> None:
    assert written(TWO_ROBOTS, "bipartite", tmp_path) == expected("""
        bipartite, exact
        min 4 x[p,a] + 6 x[p,c] + 3 x[q,a] + 2 x[q,b]
        robot[p]: x[p,a] + x[p,c] = 1
        robot[q]: x[q,a] + x[q,b] = 1
        bin[a]: 0 <= x[p,a] + x[q,a] <= 1
        bin[b]: 0 <= x[q,b] <= 1
        bin[c]: 0 <= x[p,c] <= 1
        x[p,a], x[p,c], x[q,a], x[q,b] binary
    """)


@pytest.mark.parametrize("name", BOTTLENECKS)
def test_worked_bottlenecks(name: str) -> None:
    found = wb.solve(worked(name, objective="bottleneck"), "highs")
    assert (found.objective, found.bound, found.bound_kind, found.form) == (BOTTLENECKS[name],) * 2 + ("verified", "largest-cost")


def test_the_program_agrees_with_enumeration_negative_costs_and_forbidden_pairs_included() -> None:
    rng = np.random.default_rng(8)
    for _ in range(draws(25)):
        costs = random_costs(rng, 4)
        most, _, largest = enumerated(costs)
        found = wb.solve(BinAssignment.from_matrix(costs, objective="bottleneck"), "highs", bound_time=0)
        assert found.objective == (largest if most else 0.0) and not found.faults


def test_an_answer_is_a_point_of_the_program() -> None:
    made = worked("K4", objective="bottleneck").compile("largest-cost")
    vector = made.encode((1, 2, 3, 0))
    assert made.program.residual(vector) == 0.0 and made.program.value(vector) == 12.0


def test_largest_cost_from_text_to_text(tmp_path: Path) -> None:
    """Costs count from the least of them, 1.5; of p and q one gets bin a, the only one of both, so that there are two pairs."""
    (tmp_path / "t.csv").write_text(expected(CROWDED))
    made = problem_from_instance(read_instance(tmp_path / "t.csv"), "bottleneck-assignment").compile("largest-cost")
    assert (made.form, made.exactness.value) == ("largest-cost", "exact")
    assert program_text(made.program) == expected("""
        min t + 1.5
        cost[p]: 2.5 x[p,a] - t <= 0
        cost[q]: 1.5 x[q,a] - t <= 0
        cost[r]: 3.5 x[r,a] + 5.5 x[r,c] - t <= 0
        robot[p]: 0 <= x[p,a] <= 1
        robot[q]: 0 <= x[q,a] <= 1
        robot[r]: 0 <= x[r,a] + x[r,b] + x[r,c] <= 1
        bin[a]: 0 <= x[p,a] + x[q,a] + x[r,a] <= 1
        bin[b]: 0 <= x[r,b] <= 1
        bin[c]: 0 <= x[r,c] <= 1
        pairs: x[p,a] + x[q,a] + x[r,a] + x[r,b] + x[r,c] = 2
        x[p,a], x[q,a], x[r,a], x[r,b], x[r,c] binary
        0 <= t <= 5.5
    """)
