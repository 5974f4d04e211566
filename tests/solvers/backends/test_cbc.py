import os
import signal
import subprocess
import sys
import textwrap
import time

import pytest
from programs import INF, program

from waybound import Program, UsageError
from waybound.solvers.backend import Control, Options
from waybound.solvers.backends.cbc import Log
from waybound.solvers.backends.pulp import PuLP


def knapsack(sense: str = "max") -> Program:
    """Two items, of which one fits; a constant of 5."""
    cost = [3.0, 4.0] if sense == "max" else [-3.0, -4.0]
    return program(cost, [[2, 3]], -INF, 4, 0, 1, integer=[0, 1], sense=sense, offset=5)


def test_bounds_are_read_as_they_come_and_weakened_by_what_printing_may_add() -> None:
    log = Log()
    assert log.feed("Cbc0010I After 0 nodes, 1 on tree, 1e+50 best solution, best possible -21681.64 (0.01 sec") is None
    bound = log.feed("onds)\r\n")
    assert bound == pytest.approx(-21681.64, abs=0.01)
    assert bound is not None
    assert bound < -21681.64
    assert log.feed("Cbc0010I After 9 nodes, 3 on tree, 1e+50 best solution, best possible -21690 (0.02 seconds)\n") is None
    assert log.feed("Lower bound:                    -21680.375\n") == pytest.approx(-21680.3755)


def test_a_bound_that_is_no_bound_is_not_read() -> None:
    log = Log()
    assert log.feed("Cbc0005I Partial search - best objective 1e+50 (best possible -1e+50), took 0 iterations\n") is None


@pytest.mark.parametrize(
    ("line", "end"),
    [
        ("Cbc0020I Exiting on maximum time", "time"), ("Cbc0003I Exiting on maximum nodes", "nodes"),
        ("Cbc0027I Exiting on user event", "interrupt"), ("Cbc0011I Exiting as integer gap of 282.3 less than 1e-10 or 5%", "gap"),
        ("Result - Stopped on time limit", "time"), ("Result - Stopped on node limit", "nodes"), ("Result - Optimal solution found", ""),
    ],
)  # fmt: skip
def test_how_it_ended_is_read_from_the_log(line: str, end: str) -> None:
    log = Log()
    log.feed(line + "\n")
    assert log.end == end


def test_optimal_within_a_gap_is_not_optimal() -> None:
    log = Log()
    log.feed("Result - Optimal solution found (within gap tolerance)\n")
    assert not log.gap_closed


@pytest.mark.parametrize(("sense", "value"), [("max", 9.0), ("min", 1.0)])
def test_values_come_back_in_the_programs_own_sense(sense: str, value: float) -> None:
    result = PuLP().run(knapsack(sense), Options(), Control())
    assert (result.status, result.objective, result.bound) == ("optimal", value, value)
    assert result.answer.tolist() == [0, 1]


def test_points_and_duals_come_with_all_their_digits() -> None:
    result = PuLP().run(program([1], [[0], [3]], -INF, [INF, 1e6], sense="max"), Options(), Control())
    assert result.answer == pytest.approx([1e6 / 3.0], rel=1e-15)
    assert result.row_duals == pytest.approx([0.0, 1.0 / 3.0], rel=1e-15)


def test_parameters_of_cbc_are_passed_on() -> None:
    for extra in ({"cuts": "off"}, {"cutsOnOff": "off", "heuristicsOnOff": "off"}, {"strongBranching": 2}):
        assert PuLP().run(knapsack(), Options(extra=extra), Control()).objective == 9.0


@pytest.mark.parametrize(
    ("extra", "message"),
    [
        ({"cutz": "off"}, "no parameter 'cutz'"), ({"cuts": "sideways"}, "'sideways' is no value"),
        ({"strongBranching": "many"}, "no value"), ({"export": "/tmp/x"}, "no parameter"),
        ({"ratioGap": 0.1}, "the gap"), ({"seconds": 3}, "the time limit"), ({"quit": ""}, "no parameter"),
    ],
)  # fmt: skip
def test_unknown_parameters_and_values_are_refused(extra, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        PuLP().run(knapsack(), Options(extra=extra), Control())


@pytest.mark.slow
def test_the_terminals_interrupt_does_not_reach_cbc(tmp_path) -> None:
    # Ctrl-C goes to the whole foreground group; only the parent may decide what it means.
    script = tmp_path / "script.py"
    script.write_text(
        textwrap.dedent("""
        import signal, threading, time
        import numpy as np
        import scipy.sparse as sp
        from waybound.formulations.programs.program import Program, Rows, Variables
        from waybound.solvers.backend import BACKENDS, Control, Options
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        rng = np.random.default_rng(0)
        m, n = 6, 50
        a = sp.csr_matrix(rng.integers(0, 100, (m, n)).astype(float))
        half = np.floor(np.asarray(a.sum(axis=1)).ravel() / 2)
        x = Variables("x", keys=(np.arange(n),), lower=np.zeros(n), upper=np.ones(n), cost=np.zeros(n), integer=True)
        rows = Rows("r", keys=(np.arange(m),), indptr=a.indptr, indices=a.indices, data=a.data, lower=half, upper=half)
        print("ready", flush=True)
        result = BACKENDS["pulp"]().run(Program("split", "min", (x,), (rows,)), Options(time_limit=2.5), Control())
        print(result.status, result.limit)
        """)
    )
    process = subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE, text=True, start_new_session=False, process_group=0)
    assert process.stdout.readline() == "ready\n"
    time.sleep(1.0)
    os.killpg(process.pid, signal.SIGINT)
    assert process.communicate(timeout=300)[0].split() == ["unknown", "time"]


def test_an_unbounded_program_that_cbc_calls_infeasible_is_unbounded() -> None:
    rows = [[0.5, 3, 0, 3], [-3, 0, 0, 1]]
    endless = program([-5, -4, -2, -3], rows, [1, -1], [INF, -1], [0, -2, -1, -2], [2, INF, INF, INF], integer=range(4))
    assert PuLP().run(endless, Options(), Control()).status == "unbounded"


def test_an_optimum_that_is_lost_in_cbcs_preprocessing_is_found_without_it() -> None:
    rows = [[1, -2, 1, 1], [0, 0, 1, 0]]
    lost = program([0, 3, 3, 2], rows, [-3, -2], [-3, 1], [-2, -1, -2.5, -2.5], [0, 1, INF, INF], integer=[0, 1], sense="max", offset=-1e6)
    result = PuLP().run(lost, Options(), Control())
    assert (result.status, result.objective) == ("optimal", pytest.approx(-999994))
