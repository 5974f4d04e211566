import numpy as np
import pytest
from coded import coded
from draws import draws
from explorations import enumerated, path, random_map

import waybound as wb
from waybound.formulations.auctions.room_exploration import GO, MAP, SEARCH, RoomExploration
from waybound.instances.auctions.exploration_map import ExplorationMap
from waybound.instances.errors import Code, InputError

TWO = RoomExploration(ExplorationMap([(0, 1), (1, 2)], [[0, 0], [4, 2], [9, 0]], [[1.0]] * 3, [[2.0]] * 3, [0, 0], 0, [(1, 2)], 1, 3))


def test_gains_are_those_of_the_whole_team_in_order() -> None:
    answer = (((1, GO), (0, GO), (0, SEARCH)), ((0, MAP), (1, GO), (0, GO)))
    judged = TWO.evaluate(answer)
    assert judged.feasible and judged.values == (9.0,) and judged.quantities == {"exploring": 6.0, "mapping": 1.0, "searching": 2.0}
    stays = TWO.answer_at_hand()
    assert TWO.evaluate(stays).feasible and TWO.evaluate(stays).values == (0.0,)


def test_each_rule_is_tested() -> None:
    stay = ((0, GO),) * 3
    assert [v.check for v in TWO.evaluate((((2, GO), (1, GO), (0, GO)), stay)).violations] == ["doors", "contact"]
    assert [v.check for v in TWO.evaluate((((1, MAP), (0, GO), (0, GO)), stay)).violations] == ["doors"]
    late = TWO.evaluate((((1, GO), (1, MAP), (1, SEARCH)), stay)).violations
    assert [v.check for v in late] == ["contact", "end"] and "3 steps in a row, 1 allowed" in late[0].message


def test_others_pass_on_what_they_hear() -> None:
    chain = path(4, 0, 2, 2, heard=((0, 1), (1, 2)))
    answer = (((1, GO), (1, GO)), ((1, GO), (2, GO)))
    assert chain.contacts(answer).all() and chain.evaluate(answer).feasible
    assert not chain.contacts((((1, GO), (0, GO)), ((1, GO), (2, GO))))[1, 1]


@pytest.mark.parametrize("silence", range(5))
def test_a_robot_alone_goes_as_far_as_half_of_what_it_may_be_silent(silence: int) -> None:
    deepest = max(d for d in range(4) if d == 0 or wb.solve(path(5, silence, 8, 1, d), "highs", bound_time=0).objective > 0)
    assert deepest == (silence + 1) // 2


def test_one_relay_leads_another_robot_one_room_further() -> None:
    """Without silence, and rooms that hear their neighbours: one robot stays in room 1, two reach room 2."""
    heard = ((0, 1), (1, 2), (2, 3))
    assert [wb.solve(path(4, 0, 5, robots, 2, heard), "highs", bound_time=0).objective for robots in (1, 2)] == [0.0, 1.0]
    assert wb.solve(path(4, 0, 6, 2, 3, heard), "highs", bound_time=0).objective == 0.0


@pytest.mark.parametrize("solver", ["highs", "cpsat"])
def test_solvers_find_what_enumeration_finds(solver: str) -> None:
    rng = np.random.default_rng(4)
    for _ in range(draws(10)):
        problem = random_map(rng)
        found = wb.solve(problem, solver, bound_time=0)
        assert found.status == "optimal" and found.objective == enumerated(problem)


@pytest.mark.parametrize(
    ("answer", "code"),
    [
        (None, "malformed"), (((),), "malformed"), ((((0, 0),) * 3,), "malformed"), ((((0, 0),) * 2, ((0, 0),) * 3), "wrong-shape"),
        ((((0, 3),) * 3, ((0, 0),) * 3), "malformed"),
    ],
)  # fmt: skip
def test_what_is_no_answer_is_refused(answer: object, code: Code) -> None:
    with pytest.raises(InputError, check=coded(code)):
        TWO.evaluate(answer)


def test_answers_go_to_json_and_frames_and_back() -> None:
    answer = (((1, GO), (0, GO), (0, SEARCH)), ((0, MAP), (1, GO), (0, GO)))
    data = TWO.answer_to_json(answer)
    assert data["robots"][0][2] == {"room": "1", "action": "search"} and TWO.answer_from_json(data) == answer
    assert TWO.answer_to_frame(answer)["contact"].tolist() == [False, True, True, True, False, True]
    for wrong in ({"kind": "x"}, {"kind": "explorations", "robots": [[{"room": "9", "action": "go"}]]}):
        with pytest.raises(InputError):
            TWO.answer_from_json(wrong)
