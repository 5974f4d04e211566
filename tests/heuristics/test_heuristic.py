from typing import Any

import numpy as np
import pytest
from selection_problems import cover_30

from waybound import Evidence, Exactness, Guarantee, Selection, UsageError
from waybound.formulations.stop import Stop
from waybound.heuristics.heuristic import HEURISTICS, Context, Heuristic, HeuristicWork, Outcome
from waybound.solvers.backend import Control, Options
from waybound.solvers.linear_programs import LinearPrograms

PROBLEM = cover_30(3)


def first(problem: Any, context: Context, *, count: int = 1, mark: str = "none") -> Outcome:
    """The first elements."""
    return Outcome(Selection(tuple(range(count))))


FIRST = Heuristic("first", ("selection",), PROBLEM.features(), first, "for tests")


def test_parameters_are_the_keywords_with_their_defaults() -> None:
    assert FIRST.parameters() == {"count": 1, "mark": "none"}
    FIRST.check_parameters({"count": 3})
    with pytest.raises(UsageError, match="first has no option 'size'; it takes count, mark"):
        FIRST.check_parameters({"count": 3, "size": 1})
    with pytest.raises(UsageError, match="it takes none"):
        Heuristic("bare", ("selection",), frozenset(), lambda problem, context: Outcome(None), "").check_parameters({"size": 1})


def test_what_it_lacks_is_named() -> None:
    assert FIRST.missing(PROBLEM) == frozenset()
    assert Heuristic("other", ("routing",), frozenset(), first, "").missing(PROBLEM) == {"selection problems"}
    few = Heuristic("few", ("selection",), frozenset({"function:coverage"}), first, "", refuses=lambda problem: frozenset({"small sets"}))
    assert few.missing(PROBLEM) == {"constraint:cardinality", "small sets"}


def test_everything_that_it_is_told_reaches_it_and_everything_it_says_comes_back(registered: Any) -> None:
    seen: list[Context] = []
    proof = Evidence("marginal-gains", "by hand", 9.0, {"prefix": []})
    promise = Guarantee(2.0, "half", (), "nowhere")

    def run(problem: Any, context: Context, *, count: int = 1) -> Outcome:
        seen.append(context)
        context.publish(Selection((0,)))
        return Outcome(Selection(tuple(range(count))), promise, (proof,), {"looked": 5}, "a word", "time")

    registered(HEURISTICS, "told", Heuristic("told", ("selection",), PROBLEM.features(), run, ""))
    control, start = Control(), Selection((4,))
    options = Options(time_limit=3.0, seed=7, threads=2, start=start, lp_solver="scip", extra={"count": 2})
    result = HeuristicWork("told", PROBLEM, options)(control)
    (context,) = seen
    assert context.rng.random() == np.random.default_rng(7).random()
    assert (context.time_limit, context.start) == (3.0, start)
    assert control.answer == Selection((0,))
    assert (result.answer, result.limit, result.message, result.statistics) == (Selection((0, 1)), "time", "a word", {"looked": 5})
    assert (result.evidence, result.guarantee, result.holds, result.status) == ((proof,), promise, Exactness.NEITHER, "unknown")


def test_a_wish_to_stop_reaches_it(registered: Any) -> None:
    control = Control()

    def run(problem: Any, context: Context) -> Outcome:
        assert not context.stop.reached()
        control.stop()
        return Outcome(Selection(()), limit=context.begin().reached() or "none")

    registered(HEURISTICS, "stopped", Heuristic("stopped", ("selection",), PROBLEM.features(), run, ""))
    assert HeuristicWork("stopped", PROBLEM, Options())(control).limit == "interrupt"


def test_its_time_begins_when_it_does() -> None:
    context = Context(np.random.default_rng(1), 0.0, None, lambda answer: None, Stop(60.0), LinearPrograms())
    assert not context.stop.reached() and context.begin().reached() == "time"
