"""Who has a turn, from which routes, and what is told of it; that answers are right is held by the conformance suite."""

import contextlib
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from coded import coded
from small_routing import plane, small, varied

import waybound as wb
from waybound.instances.errors import UnsupportedError, UsageError
from waybound.instances.routing.sites import Group
from waybound.solvers.backend import Control, Options, RawResult
from waybound.solvers.engines.routing import portfolio
from waybound.solvers.engines.routing.best_routes import BestRoutes
from waybound.solvers.engines.routing.portfolio import Portfolio
from waybound.solvers.engines.routing.pyvrp import PyVRP
from waybound.solvers.engines.routing.ruin_recreate import RuinRecreate


def run(problem: wb.RoutingProblem, **options: object) -> RawResult:
    return Portfolio().run(problem, Options(**{"time_limit": 60.0, **options}), Control())  # type: ignore[arg-type]


def paused() -> wb.RoutingProblem:
    """Vehicles reload and recharge, which OR-Tools alone takes."""
    problem = varied("recharging", 0)
    return replace(problem, fleet=tuple(replace(v, reloads=(0,)) for v in problem.fleet))


def engines(result: RawResult) -> list[str]:
    return [turn["engine"] for turn in result.statistics["turns"]]


@pytest.mark.parametrize(
    ("kind", "names"),
    [
        ("several-depots", ["ruin-recreate", "pyvrp"]), ("overtime", ["ruin-recreate", "pyvrp"]), ("groups", ["ruin-recreate", "pyvrp"]),
        ("several-windows", ["ruin-recreate", "pyvrp"]), ("recharging", ["ruin-recreate"]), ("route-risk", ["ruin-recreate"]),
    ],
)  # fmt: skip
def test_who_has_a_turn_is_told_by_what_the_problem_has(kind: str, names: list[str]) -> None:
    assert [turn.engine.name for turn in Portfolio().turns(varied(kind, 0))] == names


@pytest.mark.parametrize(
    ("customers", "settings", "proof"), [(150, {}, True), (151, {}, False), (250, {"windows": True}, True), (251, {"windows": True}, False)]
)
def test_branch_price_cut_has_a_turn_where_customers_are_few(customers: int, settings: dict[str, Any], proof: bool) -> None:
    problem = wb.generate("random", customers=customers, capacity=40)
    if settings:
        ready = np.zeros(len(problem.sites))
        problem = replace(problem, sites=replace(problem.sites, ready=ready, due=ready + 500.0))
    names = ["ruin-recreate", *(["branch-price-cut"] if proof else []), "pyvrp"]
    assert [turn.engine.name for turn in Portfolio().turns(problem)] == names
    grouped = replace(problem, sites=replace(problem.sites, required=problem.sites.depot & False, groups=(Group((1, 2), True),)))
    assert [turn.engine.name for turn in Portfolio().turns(grouped)] == ["ruin-recreate", "pyvrp"]


def test_what_no_engine_takes_is_refused_by_what_the_nearest_one_lacks() -> None:
    problem = paused()
    with pytest.MonkeyPatch.context() as patch:
        for kind in (portfolio.ORTools, portfolio.VROOM):
            patch.setattr(kind, "installed", classmethod(lambda cls: False))
        least = min(len(kind().missing(problem)) for kind in (PyVRP, RuinRecreate))
        with pytest.raises(UnsupportedError) as caught:
            run(problem)
    assert len(caught.value.missing) == least > 0


def test_the_second_goes_on_from_the_routes_of_the_first_and_all_repeats() -> None:
    problem = wb.generate("random", customers=40, capacity=40)
    one, again = run(problem, iterations=20), run(problem, iterations=20)
    assert one.answer == again.answer and one.objective == again.objective
    first, second = one.statistics["turns"]
    assert (first["engine"], first["iterations"]) == ("ruin-recreate", 2000) and (second["engine"], second["iterations"]) == ("pyvrp", 20)
    assert first["before"] is None and second["before"] == first["after"] and second["after"][0] <= second["before"][0] == first["after"][0]
    assert one.statistics["iterations"] == 20 and [one.objective] == second["after"]


def test_no_answer_is_worse_than_the_start() -> None:
    problem = wb.generate("random", customers=30, capacity=40)
    start = run(problem, iterations=200).answer
    found = run(problem, iterations=1, start=start)
    assert found.statistics["start"] == "used"
    assert found.objective <= problem.evaluate(start).values[0]


def test_an_engine_that_fails_leaves_the_turn_to_the_next(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object) -> RawResult:
        raise RuntimeError("out of luck")

    problem = small("capacity", 0, "round")
    monkeypatch.setattr(RuinRecreate, "search", fails)
    found = run(problem, iterations=50)
    assert found.status == "feasible" and found.message == "ruin-recreate failed: RuntimeError: out of luck"
    monkeypatch.setattr(PyVRP, "search", fails)
    ended = run(problem, iterations=50)
    assert ended.status == "error" and ended.message == "ruin-recreate failed: RuntimeError: out of luck"


def test_a_library_searches_while_loops_are_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    from waybound.solvers.engines.routing.ruin_recreate_steps import search_kernels

    search_kernels.anneal.make()
    commands: list[list[str]] = []

    @contextlib.contextmanager
    def short(command: list[str], **given: Any) -> Iterator[subprocess.Popen[bytes]]:
        commands.append(command)
        with subprocess.Popen([sys.executable, "-c", "import time; time.sleep(0.3)"]) as process:
            yield process

    monkeypatch.setattr(portfolio, "child", short)
    monkeypatch.setattr(portfolio, "COMPILING", 0.0)
    monkeypatch.setattr(portfolio, "ENOUGH", 0)
    monkeypatch.setattr(portfolio, "ENOUGH_BEFORE_PROOF", 0)  # however slow this machine is, the second one has a turn
    looks: list[bool] = []
    monkeypatch.setattr(type(search_kernels.anneal), "kept", lambda kernel: looks.append(True) or len(looks) > 1)
    problem = wb.generate("random", customers=30, capacity=40)
    with_compiler = run(problem, time_limit=2.0)
    assert engines(with_compiler)[:3] == ["pyvrp", "ruin-recreate", "branch-price-cut"]
    assert [command[-6:] for command in commands] == [[sys.executable, "-m", "waybound", "warm", "--quiet", "ruin_recreate_steps"]]
    monkeypatch.setattr(type(search_kernels.anneal), "kept", lambda kernel: False)
    assert engines(run(problem, time_limit=1.0)) == ["pyvrp", "pyvrp"] and commands.pop()  # where nothing that is compiled can be kept
    assert engines(run(problem, iterations=10)) == ["ruin-recreate", "pyvrp"] and len(commands) == 1  # which shall repeat
    monkeypatch.setattr(portfolio, "COMPILING", 10.0)
    assert engines(run(problem, time_limit=1.0)) == ["pyvrp"] and len(commands) == 1  # too short to compile anything


def test_one_companion_searches_beside_all_turns_of_others(monkeypatch: pytest.MonkeyPatch) -> None:
    began, accompanied = [], portfolio.accompanied

    def told(
        companion: RuinRecreate, problem: wb.RoutingProblem, options: Options, best: BestRoutes
    ) -> contextlib.AbstractContextManager[None]:
        began.append(options.start)
        return accompanied(companion, problem, options, best)

    monkeypatch.setattr(portfolio, "accompanied", told)
    monkeypatch.setattr(portfolio, "ENOUGH", 0)
    monkeypatch.setattr(portfolio, "ENOUGH_BEFORE_PROOF", 0)  # however slow this machine is, others have turns
    problem = wb.generate("random", customers=30, capacity=40)
    found = run(problem, threads=2, time_limit=2.0)
    assert engines(found)[:2] == ["ruin-recreate", "branch-price-cut"] and len(began) == 1 and began[0] is not None
    assert problem.evaluate(found.answer).values[0] <= problem.evaluate(began[0]).values[0]
    assert run(problem, threads=2, iterations=20).answer == run(problem, iterations=20).answer and len(began) == 1


def test_what_the_only_engine_that_takes_a_problem_does_not_keep_to_is_refused() -> None:
    with pytest.raises(
        UsageError, match="ortools, which alone takes this problem, does not keep to no_improvement", check=coded("unsupported")
    ):
        run(paused(), no_improvement=5)


def test_it_has_no_options_of_its_own() -> None:
    with pytest.raises(UsageError, check=coded("unknown-name")):
        run(small("capacity", 0, "round"), extra={"string": 3.0})


def test_the_default_of_the_family_is_the_portfolio() -> None:
    problem = wb.generate("random", customers=8, capacity=40)
    assert wb.solve(problem, time_limit=0.5, bound_time=0).solver == "portfolio"


def test_the_gap_that_is_asked_for_ends_it() -> None:
    """Branch, price and cut ends at the gap, and PyVRP has no turn after it."""
    result = run(plane(3, 20, 40.0), time_limit=60.0, gap=0.5)
    assert result.limit in ("gap", "none") and engines(result)[-1] == "branch-price-cut"
