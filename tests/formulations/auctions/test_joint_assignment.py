import numpy as np
import pytest
from coded import coded
from draws import draws
from joint_assignments import WORKED, enumerated, random_joint

import waybound as wb
from waybound.formulations.auctions.joint_assignment import JointAssignment
from waybound.instances.errors import InputError


def test_an_errand_takes_the_way_over_the_request_and_the_wait() -> None:
    assert [WORKED.cost_of(0, *errand) for errand in ((0, -1), (1, 0), (-1, 1), (-1, -1), (0, 1))] == [1.0, 2.0, 4.0, 0.0, 4.0]
    assert WORKED.costs[0].tolist() == [[4.0, 4.0, 1.0], [2.0, 13.0, 2.0], [1.0, 4.0, 0.0]]
    judged = WORKED.evaluate(((0, 1), (1, 0)))
    assert judged.feasible and judged.values == (6.0,) and judged.quantities == {"largest": 4.0}


def test_each_rule_is_tested() -> None:
    told = [v.message for v in WORKED.evaluate(((0, 0), (0, -1))).violations]
    assert told == ["bin 1 is given to several robots", "1 of the 2 requests that there can be"]
    barred = JointAssignment.from_arrays([[np.inf, 1.0]], [[np.inf]], [[0.0, 0.0]])
    assert [v.check for v in barred.evaluate(((0, -1),)).violations] == ["allowed"]
    assert barred.deliveries == 0 and barred.evaluate(((1, -1),)).feasible
    assert not barred.evaluate(((1, 0),)).feasible and not barred.evaluate(((-1, -1),)).feasible


@pytest.mark.parametrize("answer", [((0, 1),), ((0, 1), (1, 2)), ((0, 1), [1, 0]), ((0, 1), (True, 0)), None, ((-2, 0), (1, 1))])
def test_what_is_no_answer_is_refused(answer: object) -> None:
    with pytest.raises(InputError, check=coded("malformed")):
        WORKED.evaluate(answer)


@pytest.mark.parametrize("solver", ["highs", "cpsat", "scip"])
def test_solvers_find_what_enumeration_finds(solver: str) -> None:
    rng = np.random.default_rng(4)
    for _ in range(draws(15)):
        problem = random_joint(rng)
        if not np.isfinite(problem.costs).sum() > problem.num_robots:
            continue
        found = wb.solve(problem, solver, bound_time=60.0)
        assert found.status == "optimal" and found.objective == pytest.approx(enumerated(problem), abs=1e-9)


def test_what_is_at_hand_is_an_answer() -> None:
    rng = np.random.default_rng(5)
    for _ in range(draws(20)):
        problem = random_joint(rng)
        assert problem.evaluate(problem.answer_at_hand()).feasible


def test_answers_go_to_json_and_frames_and_back_by_name() -> None:
    answer = ((0, -1), (1, 0))
    data = WORKED.answer_to_json(answer)
    assert data["errands"][0] == {"robot": "1", "bin": "1", "request": None} and WORKED.answer_from_json(data) == answer
    assert WORKED.answer_to_frame(answer)["time"].tolist() == [1.0, 2.0]
    for wrong in ({"kind": "x"}, {"kind": "errands", "errands": [{"robot": "9", "bin": None, "request": None}]},
                  {"kind": "errands", "errands": [{"robot": "1"}]}):  # fmt: skip
        with pytest.raises(InputError):
            WORKED.answer_from_json(wrong)
