import math
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest
from programs import sane

from tests.programs import program as dense
from waybound import Exactness, UnsupportedError
from waybound.formulations.programs.program import INTEGERS, LINEAR, QUADRATIC, Program, Rows
from waybound.formulations.programs.reductions.minimisation import MINIMISATION
from waybound.solvers.backend import Control, Options, RawResult, solver_named
from waybound.solvers.program_backend import ProgramBackend, kinds_of, settled, takers


def test_crossed_bounds_settle_a_program_by_name() -> None:
    result = settled(sane(lower=(0.0, 2.0)))
    assert result.status == "infeasible"
    assert "x[1]" in result.message


def test_crossed_sides_settle_a_program_by_name() -> None:
    result = settled(sane(side=(3.0, 2.0)))
    assert (result.status, "need" in result.message) == ("infeasible", True)


def test_every_other_program_is_left_to_the_solver() -> None:
    assert settled(sane()) is None


@pytest.mark.parametrize("side", [(1e-9, math.inf), (-math.inf, -1e-9)])
def test_an_empty_row_that_excludes_zero_settles_a_program_by_name_however_small_its_side(side) -> None:
    result = settled(sane(data=(0.0, 0.0), side=side))
    assert (result.status, "need" in result.message) == ("infeasible", True)
    assert settled(sane(data=(0.0, 0.0), side=(-1e-9, 1e-9))) is None


class Says(ProgramBackend):
    """Says what it is told to say, in this order."""

    name, package, modules, summary, title = "says", "numpy", ("json",), "for tests", "Says"
    programs = (INTEGERS,)

    def __init__(self, *words: RawResult, publishes: np.ndarray | None = None, reductions=()) -> None:
        super().__init__()
        self.words, self.publishes, self.reductions, self.seen = list(words), publishes, reductions, []

    def search(self, program: Program, options: Options, control: Control) -> RawResult:
        self.seen.append(program)
        if self.publishes is not None:
            control.publish(self.publishes, 0.0)
        return self.words.pop(0)


def knapsack(**changes) -> Program:
    """Worth 5 and 3, weights 2 and 3 of 3, both whole: the best is 5 + 10."""
    return replace(dense([5, 3], [[2, 3]], -math.inf, 3, 0, 1, integer=[0, 1], sense="max", offset=10.0), **changes)


GOOD, BAD = np.array([1.0, 0.0]), np.array([1.0, 1.0])


@pytest.mark.parametrize(
    ("said", "status", "limit", "objective", "message"),
    [
        (RawResult("optimal", answer=GOOD, bound=15.0), "optimal", "none", 15.0, ""),
        (RawResult("optimal", answer=GOOD, bound=18.0), "feasible", "gap", 15.0, ""),
        (RawResult("optimal", answer=GOOD), "feasible", "gap", 15.0, ""),
        (RawResult("optimal", answer=BAD, bound=18.0), "unknown", "none", None, "Says reports a point that is not feasible within 1e-05"),
        (RawResult("optimal"), "unknown", "none", None, "Says reports a point that is not feasible within 1e-05"),
        (RawResult("unknown", "time", GOOD, bound=18.0), "feasible", "time", 15.0, ""),
        (RawResult("unknown", "time", GOOD, bound=15.0), "optimal", "none", 15.0, ""),
        (RawResult("unknown", "iterations", bound=18.0), "unknown", "nodes", None, "Says found no feasible point within the nodes limit"),
        (RawResult("infeasible", answer=GOOD, bound=3.0), "infeasible", "none", None, ""),
        (RawResult("error", message="no licence"), "error", "none", None, "no licence"),
    ],
)  # fmt: skip
def test_the_last_word_is_taken_for_what_it_is_worth(said, status, limit, objective, message) -> None:
    result = Says(said).run(knapsack(), Options(), Control())
    assert (result.status, result.limit, result.objective, result.message) == (status, limit, objective, message)


def test_an_optimum_that_no_point_shows_is_no_bound() -> None:
    assert Says(RawResult("optimal", answer=BAD, bound=18.0)).run(knapsack(), Options(), Control()).bound is None
    assert Says(RawResult("feasible", "time", answer=BAD, bound=18.0)).run(knapsack(), Options(), Control()).bound == 18.0


def test_the_optimum_of_a_continuous_program_is_its_bound() -> None:
    linear = dense([5, 3], [[1, 1]], -math.inf, 1, 0, 1, sense="max")
    result = Says(RawResult("optimal", answer=GOOD)).run(linear, Options(), Control())
    assert (result.status, result.objective, result.bound) == ("optimal", 5.0, 5.0)


def test_a_point_at_which_a_limit_ended_a_continuous_program_claims_no_value() -> None:
    result = Says(RawResult("feasible", "time", answer=np.array([1.0, 0.5]))).run(sane(), Options(), Control())
    assert result.status == "feasible" and result.answer is not None and result.objective is None


def test_an_incumbent_stands_in_for_a_last_point_that_breaks_a_row() -> None:
    result = Says(RawResult("optimal", answer=BAD, bound=15.0), publishes=GOOD).run(knapsack(), Options(), Control())
    assert (result.status, result.objective) == ("optimal", 15.0)


@pytest.mark.parametrize(
    ("again", "status"), [("optimal", "unbounded"), ("infeasible", "infeasible"), ("unknown", "infeasible_or_unbounded")]
)
def test_infeasible_and_unbounded_are_told_apart_without_the_objective(again, status) -> None:
    backend = Says(RawResult("infeasible_or_unbounded"), RawResult(again))
    assert backend.run(knapsack(), Options(), Control()).status == status
    assert not backend.seen[1].cost.any()


def test_results_come_back_through_the_chain_and_say_how() -> None:
    backend = Says(RawResult("unknown", "time", GOOD, bound=-6.0, row_duals=np.array([-2.0])), reductions=(MINIMISATION,), publishes=GOOD)
    events: list[dict] = []
    result = backend.run(knapsack(), Options(), Control(events.append))
    assert (result.objective, result.bound, result.row_duals.tolist()) == (15.0, 16.0, [2.0])
    assert events[0]["objective"] == 15.0
    assert [str(link) for link in result.links] == ["minimisation (exact): sign turned, constant 10 left out"]
    assert result.holds is Exactness.EXACT


def test_coefficients_that_cancel_leave_an_empty_row() -> None:
    twice = Rows(
        "need", indptr=np.array([0, 2]), indices=np.array([0, 0]), data=np.array([1.0, -1.0]), lower=np.array([1e-7]), upper=np.ones(1)
    )
    assert Says().run(replace(dense([1], [[1]], 0, 1), rows=(twice,)), Options(), Control()).status == "infeasible"


def test_integers_have_whole_bounds_in_a_search_and_none_is_needed_where_these_cross() -> None:
    backend = Says(RawResult("optimal", answer=np.array([1.0]), bound=1.0))
    assert backend.run(dense([1], [[1]], 0, 1, 0.3, 1.5, integer=[0]), Options(), Control()).status == "optimal"
    assert (backend.seen[0].lower, backend.seen[0].upper) == (1, 1)
    assert Says().run(dense([1], [[1]], 0, 1, 0.3, 0.7, integer=[0]), Options(), Control()).status == "infeasible"


def test_a_constant_left_out_makes_no_optimum_of_a_gap() -> None:
    said = RawResult("unknown", "time", GOOD, bound=-1e6 - 0.5)
    result = Says(said, reductions=(MINIMISATION,)).run(
        knapsack(variables=dense([1e6, 3], [[2, 2]], 0, 3, 0, 1, integer=[0, 1]).variables, offset=-1e6), Options(), Control()
    )
    assert (result.status, result.limit, result.objective, result.bound) == ("feasible", "time", 0.0, 0.5)


def test_the_second_search_has_no_options_of_its_own_and_a_program_without_answer_no_duals() -> None:
    duals = np.ones(1)
    given = Options(extra={"tolerance": 1.0}, iterations=3, start=GOOD)

    class Has(Says):
        options = MappingProxyType({"tolerance": 0.0})

        def search(self, program: Program, options: Options, control: Control) -> RawResult:
            told.append((options.extra, options.iterations, options.start is None))
            return super().search(program, options, control)

    told: list[tuple] = []
    result = Has(RawResult("infeasible_or_unbounded", row_duals=duals), RawResult("infeasible")).run(knapsack(), given, Control())
    assert told == [({"tolerance": 1.0}, 3, False), ({}, None, True)]
    assert result.row_duals is None


def test_a_refusal_names_those_who_take_the_numbers_too() -> None:
    squares = dense([1], [[1]], 0, 3, 0, 3, integer=[0], quadratic=[[-2]])
    with pytest.raises(UnsupportedError, match=r"squares of variables that are not binary; can take it: cpsat, mathopt:gscip, scip$"):
        solver_named("highs").run(squares, Options(), Control())


def test_a_program_of_whole_numbers_is_searched_as_it_is() -> None:
    backend, given = Says(RawResult("unknown")), knapsack()
    backend.run(given, Options(), Control())
    assert backend.seen == [given]


def test_an_optimum_is_one_in_every_unit() -> None:
    """Whether value and bound meet is asked in the solver's numbers, whatever the objective counts."""
    for power in (-60, 0, 60):
        near = knapsack(variables=tuple(replace(b, cost=np.ldexp(b.cost, power)) for b in knapsack().variables), offset=0.0)
        for bound, status in ((5e-7, "optimal"), (5e-4, "feasible")):
            said = RawResult("optimal", answer=np.zeros(2), bound=bound)
            assert Says(said).run(near, Options(), Control()).status == status


def test_a_wish_to_stop_reaches_the_search_of_a_program_in_other_units() -> None:
    class Waits(Says):
        def search(self, program: Program, options: Options, control: Control) -> RawResult:
            assert program is not huge
            outer.stop()
            return RawResult("unknown", "interrupt" if control.stopped else "none")

    outer = Control()
    huge = dense([3e12, 2e12], [[2e12, 3e12]], -math.inf, 1e25, 0, [4e12, 5e12])
    assert Waits().run(huge, Options(), outer).limit == "interrupt"


def test_a_program_that_it_cannot_take_is_refused_with_those_that_can() -> None:
    squares = dense([1, 1], [[1, 1]], 0, 1, quadratic=[[2, 0], [0, 2]])
    assert Says().missing(squares) == {"QP programs"} and Says().missing(knapsack()) == frozenset()
    with pytest.raises(UnsupportedError, match=r"says cannot take this problem: it does not handle QP programs; can take it: .*highs"):
        Says().run(squares, Options(), Control())


@pytest.mark.parametrize(
    ("features", "programs", "only_integers", "takes"),
    [
        (LINEAR, (LINEAR,), False, True), (INTEGERS, (LINEAR,), False, False), (LINEAR, (INTEGERS,), False, True),
        (LINEAR, (INTEGERS,), True, False), (INTEGERS, (INTEGERS,), True, True),
        (INTEGERS | QUADRATIC, (INTEGERS, QUADRATIC), False, False), (INTEGERS | QUADRATIC, (INTEGERS | QUADRATIC,), True, True),
        (LINEAR, (), False, False),
    ],
)  # fmt: skip
def test_features_are_taken_together(features, programs, only_integers, takes) -> None:
    backend = Says()
    backend.programs, backend.only_integers = programs, only_integers
    assert backend.able(features) == takes


def test_takers_leave_out_the_one_that_was_asked() -> None:
    assert {"highs", "scip"} <= set(takers(LINEAR)) and "highs" not in takers(LINEAR, but="highs")
    assert kinds_of(Says) == ["LP", "MILP"]
