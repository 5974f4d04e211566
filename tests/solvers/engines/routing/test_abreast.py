import threading

import pytest

import waybound as wb
from waybound.formulations.routing.routes import Routes
from waybound.solvers.backend import Control, Options, RawResult
from waybound.solvers.engines.routing.abreast import abreast, accompanied
from waybound.solvers.engines.routing.best_routes import BestRoutes
from waybound.solvers.engines.routing.ruin_recreate import RuinRecreate


def line() -> wb.RoutingProblem:
    sites = wb.Sites.of(range(4), coordinates=[[0, 0], [1, 0], [2, 0], [3, 0]])
    return wb.RoutingProblem(sites, wb.Travel("euclidean", sites.coordinates), (wb.VehicleType(3),))


def test_each_thread_has_a_seed_of_its_own_and_the_best_answer_counts() -> None:
    problem, asked, meeting = line(), [], threading.Barrier(3)

    def search(problem: wb.RoutingProblem, options: Options, control: Control) -> RawResult:
        asked.append((options.seed, options.threads))
        meeting.wait(10.0)  # all three at the same time
        answer = Routes.of([[1], [2], [3]] if options.seed == 7 else [[1, 2, 3]])
        control.publish(answer)
        return RawResult("feasible", "time", answer, 12.0, statistics={"iterations": 10, "better": 1, "scale": {}})

    control = Control()
    found = abreast(search, problem, Options(seed=7, threads=3), control, 3)
    assert len({seed for seed, _ in asked}) == 3 and 7 in {seed for seed, _ in asked} and {threads for _, threads in asked} == {1}
    assert found.answer == Routes.of([[1, 2, 3]]) and found.objective == 6.0 and control.answer == found.answer
    assert found.statistics == {"iterations": 30, "better": 3, "scale": {}}


def test_a_wish_to_end_reaches_all() -> None:
    ended = []

    def search(problem: wb.RoutingProblem, options: Options, control: Control) -> RawResult:
        control.on_stop(lambda: ended.append(options.seed))
        return RawResult("unknown", message="nothing")

    control = Control()
    found = abreast(search, line(), Options(threads=2), control, 2)
    control.stop()
    assert len(set(ended)) == 2 and found.answer is None and found.message == "nothing"


def test_a_failure_of_one_is_told() -> None:
    def search(problem: wb.RoutingProblem, options: Options, control: Control) -> RawResult:
        raise ValueError("broken")

    with pytest.raises(ValueError, match="broken"):
        abreast(search, line(), Options(threads=2), Control(), 2)


def test_a_companion_searches_on_the_other_threads_and_ends_with_the_block() -> None:
    problem, control, began, asked = line(), Control(), threading.Event(), []

    class Other(RuinRecreate):
        def run(self, problem: object, options: Options, control: Control) -> RawResult:
            asked.append((options.threads, options.seed))
            ended = threading.Event()
            control.on_stop(ended.set)
            began.set()
            assert ended.wait(10.0)
            return RawResult("feasible", "interrupt", Routes.of([[1, 2, 3]]))

    best = BestRoutes(problem, control)
    with accompanied(Other(), problem, Options(threads=3, seed=5), best):
        assert began.wait(10.0) and best.take(Routes.of([[1], [2, 3]]))
    assert best.answer == Routes.of([[1, 2, 3]]) and control.answer == best.answer
    assert asked[0][0] == 2 and asked[0][1] != 5


def test_a_companion_that_fails_costs_nothing() -> None:
    class Broken(RuinRecreate):
        def run(self, problem: object, options: Options, control: Control) -> RawResult:
            raise ValueError("broken")

    problem = line()
    best = BestRoutes(problem, Control())
    with accompanied(Broken(), problem, Options(threads=2), best):
        best.take(Routes.of([[1, 2, 3]]))
    assert best.values == (6.0,)
