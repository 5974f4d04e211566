import time

import pytest
from small_routing import small

from waybound.solvers.backend import Control, Options
from waybound.solvers.engines.routing.ortools import ORTools, _parameters
from waybound.solvers.engines.routing.ortools_model import Model
from waybound.solvers.engines.routing.routing_integers import integer_routing


@pytest.mark.slow
def test_it_asks_for_a_process_because_it_holds_the_global_lock() -> None:
    # The lock is held during the whole search: a thread that should tick every 10 ms hears nothing.
    import threading

    assert ORTools.needs_process
    problem = small("time-windows", 0, "exact")
    model = Model(problem, integer_routing(problem), 5)
    ticks: list[float] = []
    done = threading.Event()

    def tick() -> None:
        while not done.wait(0.01):
            ticks.append(time.perf_counter())

    parameters = _parameters(Options(), 1.0)
    thread = threading.Thread(target=tick)
    thread.start()
    began = time.perf_counter()
    model.routing.SolveWithParameters(parameters)
    ended = time.perf_counter()
    done.set()
    thread.join()
    inside = [t for t in ticks if began + 0.1 < t < ended - 0.1]
    assert len(inside) <= 1, "the library now releases the lock: needs_process can go"


def test_answers_that_leave_customers_out_are_not_published() -> None:
    problem = small("capacity", 0, "round")
    model = Model(problem, integer_routing(problem), 5, droppable=True)
    assert model.routing.GetNumberOfDisjunctions() == len(problem.customers)
    seen = []
    control = Control(seen.append)
    result = ORTools().run(problem, Options(time_limit=60.0, iterations=50), control)
    assert problem.evaluate(control.answer).feasible
    assert problem.evaluate(result.answer).feasible
