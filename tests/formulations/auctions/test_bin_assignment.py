import math
import pickle
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from bin_assignments import WORKED, enumerated, random_costs, worked
from coded import check_coded, coded
from draws import draws

import waybound as wb
from waybound import AssignmentInstance, InputError, UsageError
from waybound.formulations.answers import read_answer
from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.formulations.certificate import certify

INF = math.inf


def test_sum_and_bottleneck_are_recomputed() -> None:
    assert worked("K4").evaluate((1, 2, 3, 0)).values == (38.0,)
    judged = worked("K4", objective="bottleneck").evaluate((1, 2, 3, 0))
    assert judged.values == (12.0,) and judged.quantities == {"pairs": 4.0, "sum": 38.0, "largest": 12.0}


def test_each_broken_rule_is_named_with_robots_and_bins() -> None:
    problem = BinAssignment.from_matrix([[1.0, INF], [2.0, 3.0], [4.0, 5.0]], robot_names=("ann", "bob", "cleo"), bin_names=("x", "y"))
    told = {v.check: v.message for v in problem.evaluate((1, 0, 0)).violations}
    assert told == {"allowed": "robot ann may not be sent to bin y", "bins": "bin x is given to 2 robots: bob, cleo"}
    (lacking,) = problem.evaluate((0, -1, -1)).violations
    assert lacking.message == "1 of the 2 pairs asked for; without a bin: bob, cleo" and lacking.amount == 1.0
    for answer in ((0, 1), (0, 1, 2), (0, 1, -2), [0, 1, -1], (0.0, 1, -1), (True, 1, -1)):
        with pytest.raises(InputError, check=coded("malformed")):
            problem.evaluate(answer)


def test_waiting_is_the_larger_of_the_two_or_their_sum_and_bins_that_nobody_fills_are_no_ones() -> None:
    data = AssignmentInstance.from_matrix([[1.0, 5.0, 2.0]], filled=np.array([3.0, 0.0, INF]))
    assert BinAssignment(data).matrix().tolist() == [[3.0, 5.0, INF]]
    assert BinAssignment(data, waiting="sum").matrix().tolist() == [[4.0, 5.0, INF]]
    assert BinAssignment(data).digest() != BinAssignment(data, waiting="sum").digest()


def test_as_many_pairs_as_possible_come_first_whatever_they_cost() -> None:
    problem = BinAssignment.from_matrix([[1.0, 100.0], [0.0, INF]])
    assert problem.pairs == 2 and not problem.evaluate((0, -1)).feasible and problem.evaluate((1, 0)).feasible
    assert wb.solve(problem).objective == 100.0


def test_where_all_are_asked_for_there_may_be_no_answer_and_who_is_to_blame_is_named() -> None:
    costs = [[1.0, INF, INF], [2.0, INF, INF], [1.0, 1.0, 1.0]]
    robots = BinAssignment.from_matrix(costs, match="robots", robot_names=("ann", "bob", "cleo"), bin_names=("x", "y", "z"))
    (reason,) = wb.explain(robots).reasons
    assert reason.where == "robots ann, bob" and reason.message == "robots ann, bob: 2 of them, for whom there are 1 bins in all: x"
    bins = BinAssignment.from_matrix(np.transpose(costs), match="bins", bin_names=("ann", "bob", "cleo"))
    assert [r.where for r in wb.explain(bins).reasons] == ["bins ann, bob"]
    for solver in ("lapjv", "highs"):
        found = wb.solve(robots, solver)
        assert found.status == "infeasible" and found.certificate.infeasible
    assert list(BinAssignment.from_matrix(costs).infeasibility_reasons()) == []


def test_the_number_of_pairs_is_that_of_enumeration() -> None:
    rng = np.random.default_rng(2)
    for _ in range(draws(100)):
        costs = random_costs(rng, 4)
        assert BinAssignment.from_matrix(costs).pairs == enumerated(costs)[0]


def test_answers_are_written_and_read_by_name() -> None:
    problem = worked("E")
    assert problem.answer_to_json((-1, 0, 1)) == {"kind": "bin-assignment", "bin_of_robot": {"2": "1", "3": "2"}}
    assert problem.answer_from_json(problem.answer_to_json((-1, 0, 1))) == (-1, 0, 1)
    text = problem.answer_to_text((-1, 0, 1), ".csv")
    assert text == "robot,bin\n2,1\n3,2\n" and problem.answer_from_text(text) == ((-1, 0, 1), None)
    assert problem.answer_of({2: 1, "3": "2"}) == problem.answer_of(np.array([-1, 0, 1])) == (-1, 0, 1)
    assert problem.answer_to_frame((-1, 0, 1)).to_dict("list") == {"robot": ["2", "3"], "bin": ["1", "2"], "cost": [2.0, 5.0]}
    with pytest.raises(InputError, match="unknown robot '9'"):
        problem.answer_from_text("robot,bin\n9,1\n")
    for text, code in (("robot\n", "malformed"), ("robot,bin\n1,1\n1,2\n", "duplicate")):
        with pytest.raises(InputError, check=coded(code)):
            problem.answer_from_text(text)
    check_coded(InputError, "unknown-name", problem.answer_from_json, {"kind": "bin-assignment", "bin_of_robot": {"1": "7"}})
    check_coded(UsageError, "foreign", problem.check_start, (0, 1))


@pytest.mark.parametrize("suffix", [".csv", ".xlsx", ".json"])
def test_files_of_solutions_are_read_back_whatever_the_names(suffix: str, tmp_path: Path) -> None:
    problem = BinAssignment.from_matrix([[1.5, 2.25], [2.0, 5.0], [9.0, 9.0]], robot_names=("NA", "1", "None"), bin_names=("nan", "2"))
    solution = wb.solve(problem)
    solution.save(tmp_path / f"made{suffix}")
    assert read_answer(problem, tmp_path / f"made{suffix}").answer == solution.answer == (1, 0, -1)


def test_tables_of_answers_take_their_columns_in_any_order_and_hold_costs_against_the_data() -> None:
    problem = worked("E")
    frame = problem.answer_to_frame((-1, 0, 1))
    assert problem.answer_from_frame(frame[["cost", "bin", "robot"]].rename(columns=str.title)) == (-1, 0, 1)
    assert problem.answer_from_text(frame.to_csv(index=False)) == ((-1, 0, 1), None)
    assert problem.answer_from_frame(frame.assign(cost=[2.0, None])) == (-1, 0, 1)
    with pytest.raises(InputError, match="line 3: the cost of robot '3' is another one; expected 5; found 6", check=coded("contradiction")):
        problem.answer_from_frame(frame.assign(cost=[2.0, 6.0]))
    with pytest.raises(InputError, match="line 1: is no assignment; expected the titles robot,bin; found robot,bin,cost,note"):
        problem.answer_from_frame(frame.assign(note=1))


def test_settings_are_checked() -> None:
    data = AssignmentInstance.from_matrix(WORKED["A"])
    for given, message in (
        ({"objective": "average"}, "objective must be one of sum, bottleneck"), ({"match": "all"}, "match must be one of"),
        ({"waiting": "min"}, "waiting must be one of max, sum"),
    ):  # fmt: skip
        with pytest.raises(UsageError, match=message):
            BinAssignment(data, **given)
    with pytest.raises(UsageError, check=coded("malformed")):
        BinAssignment([[1]])  # type: ignore[arg-type]
    assert pickle.loads(pickle.dumps(worked("A"))).digest() == worked("A").digest()


def test_frames_of_pairs_and_of_a_matrix_are_read() -> None:
    pairs = pd.DataFrame({"robot": ["a", "a", "b"], "bin": ["x", "y", "x"], "cost": [3.0, 4.0, 1.0]})
    matrix = pd.DataFrame([[3.0, 4.0], [1.0, np.inf]], index=["a", "b"], columns=["x", "y"])
    for frame in (pairs, matrix):
        assert wb.solve(BinAssignment.from_frame(frame)).to_frame()["bin"].tolist() == ["y", "x"]
    assert BinAssignment.from_frame(matrix, objective="bottleneck", match="robots").objective == "bottleneck"


@pytest.mark.parametrize("solver", ["epsilon-scaling", "lapjv", "cpsat", "highs"])
def test_without_any_pair_there_is_the_empty_answer_unless_pairs_are_asked_for(solver: str) -> None:
    none = np.full((2, 2), np.inf)
    most = wb.solve(BinAssignment.from_matrix(none), solver)
    assert (most.status, most.answer, most.objective, most.bound_kind) == ("optimal", (-1, -1), 0.0, "verified")
    assert wb.solve(BinAssignment.from_matrix(none, match="robots"), solver).status == "infeasible"


def test_neither_bound_nor_objective_is_minus_nothing() -> None:
    found = wb.solve(BinAssignment.from_matrix([[-0.0, 1.0], [1.0, -0.0]]))
    assert found.status == "optimal" and "-0" not in repr(found).replace("-0x", "")
    assert not any(math.copysign(1.0, value) < 0 for value in (found.objective, found.bound))


def test_the_digest_is_made_when_it_is_asked_for_where_nobody_can_change_the_costs() -> None:
    matrix = np.arange(6.0).reshape(2, 3)
    own, lent = BinAssignment.from_matrix(matrix), BinAssignment(AssignmentInstance(2, 3, *_csr(2, 3), matrix.ravel()))
    for problem, later in ((own, True), (lent, False)):
        made = certify(problem, None)
        assert callable(vars(made)["instance_hash"]) is later
        problem.match = "robots"  # after the certificate was made: it speaks of the problem as it was
        matrix[0, 0] = 9.0
        again = pickle.loads(pickle.dumps(made))
        assert again.instance_hash == made.instance_hash == BinAssignment.from_matrix(np.arange(6.0).reshape(2, 3)).digest()
        matrix[0, 0] = 0.0


def _csr(n: int, m: int) -> tuple[np.ndarray, np.ndarray]:
    return np.arange(n + 1, dtype=np.int32) * m, np.tile(np.arange(m, dtype=np.int32), n)
