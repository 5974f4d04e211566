import math

import pytest
from bin_assignments import BOTTLENECKS, OPTIMA, worked

import waybound as wb
from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.formulations.stop import NEVER, Stop
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.auctions.assignment_prices import compute
from waybound.solvers.linear_programs import LinearPrograms


@pytest.mark.parametrize("name", OPTIMA)
def test_sums_and_bottlenecks_are_bounded_by_their_optima(name: str) -> None:
    assert compute(worked(name), NEVER, LinearPrograms()).value == OPTIMA[name]
    if name in BOTTLENECKS:
        assert compute(worked(name, objective="bottleneck"), NEVER, LinearPrograms()).value == BOTTLENECKS[name]


def test_where_there_is_no_answer_that_is_proved_and_when_it_is_stopped_nothing() -> None:
    none = BinAssignment.from_matrix([[1.0], [2.0]], match="robots")
    assert compute(none, NEVER, LinearPrograms()).value == math.inf
    stop = Stop()
    stop.ask()
    assert compute(worked("K4"), stop, LinearPrograms()) is None
    assert wb.bound(worked("K4")).bound == 38.0
    assert BOUNDS["assignment-prices"].missing(wb.read("demo-tiny")) == {"routing problems"}
