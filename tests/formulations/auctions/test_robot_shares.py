"""What answers of both problems share: files, names, and the test that every task is there once."""

import pytest
from coded import check_coded, coded
from file_cases import check_refused
from task_problems import line, parts

from waybound import InputError, RobotTasks, TaskAllocation, UsageError
from waybound.formulations.auctions.robot_shares import robot_tasks, settings_of
from waybound.instances.generating import generate

NAMED = TaskAllocation(RobotTasks.of_positions([0, 9], [1, 2, 8], robot_names=("r", "s"), task_names=("a", "b", "c")))


def test_answers_come_back_from_their_files():
    data = NAMED.answer_to_json(((1, 0), (2,)))
    assert data == {"kind": "task-paths", "shares": [{"robot": "r", "tasks": ["b", "a"]}, {"robot": "s", "tasks": ["c"]}]}
    assert NAMED.answer_from_json(data) == ((1, 0), (2,))
    assert NAMED.answer_from_json({**data, "shares": data["shares"][1:]}) == ((), (2,))
    part = parts([0, 1, 2])
    assert part.answer_from_json(part.answer_to_json(((0,), (1, 2)))) == ((0,), (1, 2))


@pytest.mark.parametrize(
    ("shares", "message"),
    [
        (None, "not an answer to a task-allocation problem"),
        ([{"robot": "r"}], "not an answer"),
        ([{"robot": "x", "tasks": []}], "robot 'x' does not exist"),
        ([{"robot": "r", "tasks": []}] * 2, "robot 'r' stands twice"),
        ([{"robot": "r", "tasks": ["z"]}], "holds an unknown task 'z'"),
        ([{"robot": "r", "tasks": "a"}], "holds an unknown task 'a'"),
    ],
)
def test_other_files_are_refused(shares, message):
    check_refused(InputError, message, NAMED.answer_from_json, {"kind": "task-paths", "shares": shares})
    check_coded(InputError, "malformed", NAMED.answer_from_json, {"kind": "task-parts", "shares": []})


def test_names_and_numbers_are_taken_for_answers():
    assert NAMED.answer_of([["b", "a"], ["c"]]) == NAMED.answer_of([[1, 0], [2]]) == ((1, 0), (2,))
    for wrong in ("abc", [1, 2], {"r": []}, 3):
        with pytest.raises(UsageError, check=coded("malformed")):
            NAMED.answer_of(wrong)
    with pytest.raises(UsageError, match="there is no task 'z'"):
        NAMED.answer_of([["z"], []])


def test_every_task_is_done_once():
    verdict = line([0, 10], [4, 6, 1]).evaluate(((0, 0), (1,)))
    assert {v.message for v in verdict.violations} == {"nobody does task 3", "task 1 is done 2 times"}
    assert line([0, 10], [4, 6, 1]).evaluate(line([0, 10], [4, 6, 1]).answer_at_hand()).feasible
    for wrong, code in (
        (((0, 1, 2),), "wrong-shape"), (((0, 1), (5,)), "unknown-name"), ([[0]], "malformed"), (((0.0,), ()), "malformed"),
        (None, "malformed"),
    ):  # fmt: skip
        with pytest.raises(InputError, check=coded(code)):
            line([0, 10], [4, 6, 1]).evaluate(wrong)


def test_a_start_of_another_team_is_refused():
    for start in (((0, 1, 2),), ((0,), (7,)), [[0], [1]], (("0", "1"), ("2",)), ((0.0, 1), (2,)), ((True,), (0, 2))):
        with pytest.raises(UsageError, check=coded("foreign")):
            NAMED.check_start(start)
    NAMED.check_start(((0, 1), (2,)))


def test_instances_and_settings_of_other_kinds_are_refused():
    with pytest.raises(UsageError, check=coded("foreign")):
        robot_tasks(generate("sata", 1, robots=2, targets=3, phi=50), "task-allocation")
    assert settings_of("x", {"objective": "a", "convention": "exact"}, ("objective",)) == {"objective": "a"}
    check_refused(UsageError, "x has no setting 'colour'; it takes objective", settings_of, "x", {"colour": 1}, ("objective",))
    check_refused(UsageError, "the convention can only be exact", settings_of, "x", {"convention": "round"}, ())
