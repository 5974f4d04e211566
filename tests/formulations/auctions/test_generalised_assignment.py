import math
from pathlib import Path

import numpy as np
import pytest
from coded import coded
from draws import draws
from knapsack_assignments import enumerated, random_assignment, worked

import waybound as wb
from waybound.formulations.auctions.generalised_assignment import GeneralisedAssignment
from waybound.instances.errors import InputError, UsageError


def test_an_answer_is_priced_from_the_data_and_each_rule_is_tested() -> None:
    problem = worked()
    good = problem.evaluate((0, 1, 0))
    assert good.feasible and good.values == (6.0,) and good.quantities == {"jobs_done": 3.0, "largest_load": 4.0, "load": 6.0}
    told = [v.message for v in problem.evaluate((0, 0, -1)).violations]
    assert told == ["the jobs of agent 1 take 5, its capacity is 4", "job 3 is given to no agent"]
    assert worked("profit").evaluate((0, -1, -1)).feasible
    barred = GeneralisedAssignment.from_arrays([[1.0], [math.inf]], [[1.0], [1.0]], 1.0)
    assert [v.message for v in barred.evaluate((1,)).violations] == ["agent 2 may not do job 1"]


@pytest.mark.parametrize("scale", [1.0, 1e-9, 2.0**40])
def test_rounding_of_sums_is_let_pass_and_nothing_else(scale: float) -> None:
    problem = GeneralisedAssignment.from_arrays(np.ones((1, 2)), np.array([[0.1, 0.2]]) * scale, np.array([0.3]) * scale)
    assert problem.evaluate((0, 0)).feasible
    over = GeneralisedAssignment.from_arrays(np.ones((1, 2)), np.array([[0.1, 0.2 + 1e-9]]) * scale, np.array([0.3]) * scale)
    assert not over.evaluate((0, 0)).feasible


@pytest.mark.parametrize("answer", [(0, 1), (0, 1, 2), (0, 1, -2), [0, 1, 0], (0, 1, True), None])
def test_what_is_no_answer_is_refused(answer: object) -> None:
    with pytest.raises(InputError, check=coded("malformed")):
        worked().evaluate(answer)


@pytest.mark.parametrize("solver", ["highs", "cpsat", "scip"])
def test_solvers_find_what_enumeration_finds(solver: str) -> None:
    rng = np.random.default_rng(4)
    for _ in range(draws(15)):
        problem = random_assignment(rng, 4)
        if not problem.fitting.any():
            continue
        found, best = wb.solve(problem, solver, bound_time=60.0), enumerated(problem)
        assert found.status == ("infeasible" if best is None else "optimal")
        assert found.objective == (best if best is None else pytest.approx(best, rel=1e-9, abs=1e-9))


@pytest.mark.parametrize(("steps", "shortest_first", "optimum"), [((3, 3, 6, 6), 4, 4), ((5, 5, 5), 3, 2)])
def test_bins_returned_within_a_horizon_are_a_knapsack_for_each_robot(steps: tuple[int, ...], shortest_first: int, optimum: int) -> None:
    """Two robots of nine steps: that the shortest bins fit into all steps together is a bound, and need not be attained."""
    assert int((np.cumsum(np.sort(steps)) <= 18).sum()) == shortest_first
    problem = GeneralisedAssignment.from_arrays(np.ones((2, len(steps))), [steps, steps], [9.0, 9.0], "profit")
    found = wb.solve(problem, "highs", bound_time=60.0)
    assert (found.objective, found.status) == (optimum, "optimal")


def test_jobs_that_cannot_all_be_done_are_explained_with_proof() -> None:
    lost = GeneralisedAssignment.from_arrays([[1.0, 1.0]], [[1.0, 9.0]], [5.0])
    (reason,) = lost.infeasibility_reasons()
    assert reason.message == "job 2: it fits no agent" and reason.evidence is not None
    crowded = GeneralisedAssignment.from_arrays(np.ones((2, 3)), np.full((2, 3), 2.0), [2.0, 3.0])
    assert [r.evidence.kind for r in crowded.infeasibility_reasons() if r.evidence] == ["capacity-need"]
    apart = GeneralisedAssignment.from_arrays(np.ones((2, 3)), [[4.0, 4.0, 4.0], [40.0, 40.0, 40.0]], [5.0, 50.0])
    assert list(apart.infeasibility_reasons()), "each job is four fifths of an agent"
    assert not list(worked("profit").infeasibility_reasons()) and not list(worked().infeasibility_reasons())


def test_a_job_that_fits_nobody_is_named_by_solve_too() -> None:
    problem = GeneralisedAssignment.from_arrays([[1.0, 2.0], [1.0, 2.0]], [[5.0, 2.0], [5.0, 1.0]], [2.0, 2.0], job_names=("far", "near"))
    found = wb.solve(problem, "highs")
    assert found.status == "infeasible" and found.certificate.infeasible and found.message.startswith("job far: it fits no agent")


def test_answers_go_to_json_and_frames_and_back_by_name() -> None:
    problem = GeneralisedAssignment.from_arrays(
        [[1.0, 2.0], [3.0, 4.0]], np.ones((2, 2)), [2.0, 2.0], "profit", agent_names=("p", "q"), job_names=("x", "y")
    )
    data = problem.answer_to_json((1, -1))
    assert data == {"kind": "generalised-assignment", "agent_of_job": {"x": "q"}} and problem.answer_from_json(data) == (1, -1)
    assert problem.answer_to_frame((1, 0)).to_dict("list") == {
        "job": ["x", "y"], "agent": ["q", "p"], "profit": [3.0, 2.0], "consumption": [1.0, 1.0]
    }  # fmt: skip
    assert problem.answer_of({"y": "p"}) == (-1, 0) == problem.answer_of(np.array([-1, 0]))
    for wrong, code in (
        ({"kind": "x"}, "malformed"), ({"kind": "generalised-assignment", "agent_of_job": {"z": "p"}}, "unknown-name"), ([1], "malformed"),
    ):  # fmt: skip
        with pytest.raises(InputError, check=coded(code)):
            problem.answer_from_json(wrong)
    with pytest.raises(UsageError, check=coded("foreign")):
        problem.check_start((5, 0))


def test_units_change_no_verdict() -> None:
    rng = np.random.default_rng(7)
    for k in range(draws(20)):
        one, other = (random_assignment(np.random.default_rng(k), 4, scale) for scale in (1.0, 2.0**-60))
        answer = tuple(rng.integers(-1, one.num_agents, one.num_jobs).tolist())
        assert one.evaluate(answer).feasible == other.evaluate(answer).feasible
        assert one.evaluate(answer).values[0] * 2.0**-60 == other.evaluate(answer).values[0]


@pytest.mark.parametrize("objective", ["cost", "profit"])
def test_one_made_in_python_is_saved_and_read_back(objective: str, tmp_path: Path) -> None:
    worked(objective).save(tmp_path / "jobs.json")
    assert wb.read(tmp_path / "jobs.json").digest() == worked(objective).digest()
