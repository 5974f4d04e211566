from __future__ import annotations

import pytest
from small_routing import small

from waybound.instances.errors import UsageError
from waybound.solvers.backend import Control, Options
from waybound.solvers.engines.routing.pyvrp import PyVRP


def test_options_reach_their_group() -> None:
    problem = small("capacity", 0, "round")
    result = PyVRP().run(problem, Options(iterations=20, extra={"ils.history_length": "50", "neighbourhood.num_neighbours": 3}), Control())
    assert result.status == "feasible"


@pytest.mark.parametrize(
    ("extra", "message"),
    [
        ({"ils.history_length": "long"}, "takes a whole number"), ({"ils.exhaustive_on_best": "perhaps"}, "takes a truth value"),
        ({"penalty.target_feasible": 7}, "target_feasible"), ({"seed": 3}, "no option 'seed'"),
    ],
)  # fmt: skip
def test_wrong_options_are_refused(extra, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        PyVRP().run(small("capacity", 0, "round"), Options(extra=extra), Control())


def test_seeds_matter_and_repeat() -> None:
    problem = small("heterogeneous-fleet", 1, "exact")
    answers = [PyVRP().run(problem, Options(iterations=1, seed=s), Control()).answer for s in (1, 1, 2, 3, 4, 5)]
    assert answers[0] == answers[1]
    assert len(set(map(str, answers))) > 1


def test_it_tells_when_its_search_begins_and_runs_apart_where_its_set_up_holds_everything_up() -> None:
    problem, control = small("capacity", 0, "exact"), Control()
    assert PyVRP().run(problem, Options(iterations=3), control).answer is not None
    assert control.set_up is not None and not control.setting_up
    assert not PyVRP().apart(problem)
    assert PyVRP().memory(problem) == 35.0 * problem.size**2
