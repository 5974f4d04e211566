"""What the memory at hand does not hold is refused before it is built, with its numbers, and costs nothing else."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from coded import coded
from small_routing import plane

import waybound as wb
from waybound.formulations.forms import FORMS
from waybound.formulations.programs.size import BYTES, ProgramSize, TooLargeError
from waybound.instances import memory
from waybound.instances.errors import UsageError
from waybound.solvers.backend import Control
from waybound.solving import explaining
from waybound.solving.bounding import find_bounds

PROBLEM = plane(1, 6, 20.0)


@pytest.fixture
def hold(monkeypatch: pytest.MonkeyPatch) -> Callable[[float], None]:
    """``hold(size)``: so many bytes can be had."""
    return lambda size: monkeypatch.setattr(memory, "available", lambda: size / memory.SHARE)


def test_sizes_add_up_to_bytes() -> None:
    size = ProgramSize(10.0, 20.0, 30.0, 7.0) + ProgramSize(1.0, 2.0, 3.0, 1.0)
    assert size == ProgramSize(11.0, 22.0, 33.0, 8.0)
    assert size.bytes == 11 * BYTES["column"] + 22 * BYTES["row"] + 33 * BYTES["entry"] + 8


def test_what_there_is_no_memory_for_is_not_built(hold: Any, registered: Any) -> None:
    form = FORMS["two-index-load-flow"]
    size = form.size(PROBLEM)
    assert size is not None
    registered(FORMS, form.name, replace(form, build=lambda problem: pytest.fail("built")))
    hold(size.bytes * 0.99)
    with pytest.raises(TooLargeError, match=r"about [\d,]+ columns, [\d,]+ rows and [\d,]+ entries and take"):
        PROBLEM.compile("two-index-load-flow")
    registered(FORMS, form.name, form)
    hold(size.bytes)
    assert PROBLEM.compile("two-index-load-flow").program.num_variables <= size.columns


def test_it_is_one_line_that_says_what_to_do(hold: Any) -> None:
    with pytest.raises(UsageError, check=coded("too-large")) as told:
        ProgramSize(1.8e9, 9e8, 7.2e9).refuse_beyond_memory("two-index-load-flow")
    text = str(told.value)
    assert "1,800,000,000 columns, 900,000,000 rows and 7,200,000,000 entries" in text and "GiB" in text and "heuristic" in text
    assert "\n" not in text


def test_a_form_without_an_estimate_is_built_as_before(hold: Any, registered: Any) -> None:
    form = FORMS["two-index-load-flow"]
    registered(FORMS, form.name, replace(form, size=lambda problem: None))
    hold(1.0)
    assert PROBLEM.compile("two-index-load-flow").form == "two-index-load-flow"


def test_a_solver_takes_the_next_form_that_fits_and_says_why_where_there_is_none(hold: Any, registered: Any) -> None:
    first, *_ = PROBLEM.forms()
    registered(FORMS, first, replace(FORMS[first], size=lambda problem: ProgramSize(1e15, 1e15, 1e15)))
    assert wb.solve(PROBLEM, "highs", bound_time=0).form == PROBLEM.forms()[1]
    hold(1.0)
    with pytest.raises(TooLargeError, match=f"form {first} would have"):
        wb.solve(PROBLEM, "highs", bound_time=0)


def test_bounds_go_on_without_and_say_so(hold: Any) -> None:
    hold(1.0)
    unable: list[str] = []
    find_bounds(wb.BottleneckSATA(wb.generate("sata", seed=1).graph, fractional=True), 5.0, unable=unable)
    assert any(line.startswith("no bound by linear-relaxation: form max-min would have about") for line in unable)
    assert max(e.value for e in find_bounds(PROBLEM, 5.0)) > 0


def test_no_rows_are_named_of_what_is_too_large(hold: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    hold(1.0)
    for name in ("_decided", "_proof"):
        monkeypatch.setattr(explaining, name, lambda *given: None)
    told = explaining._explain_by_methods(PROBLEM, math.inf, Control(), [])
    assert told.verdict == "undecided" and "would have about" in told.message
