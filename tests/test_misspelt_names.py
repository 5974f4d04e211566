"""Misspelt names, wherever they are given, are answered with what may have been meant."""

from collections.abc import Callable

import pytest

import waybound as wb
from waybound.reports.battery.cases import Draw
from waybound.reports.studies.study import STUDIES


def tiny() -> wb.Problem:
    return wb.read("demo-tiny")


@pytest.mark.parametrize(
    ("call", "meant"),
    [
        (lambda: wb.solve(tiny(), "hihgs"), "highs"),
        (lambda: wb.solve(tiny(), "pulp:HiGSH"), "HiGHS"),
        (lambda: wb.solve(tiny(), "mathopt:higs"), "highs"),
        (lambda: wb.solve(tiny(), "cvxpy:CLARABLE"), "CLARABEL"),
        (lambda: wb.solve(tiny(), heuristic="saving"), "savings"),
        (lambda: wb.bound(tiny(), lp_solver="hihgs"), "highs"),
        (lambda: wb.compare(tiny(), ["hihgs"]), "highs"),
        (lambda: wb.compare(tiny(), ["saving"]), "savings"),
        (lambda: wb.explain(tiny(), form="two-index-mtx"), "two-index-mtz"),
        (lambda: tiny().compile("three-indx"), "three-index"),
        (lambda: wb.solve(tiny(), heuristic="savings").plot(view="schedul"), "schedule"),
        (lambda: wb.read("demo-tny"), "demo-tiny"),
        (lambda: wb.read("demo-c52"), "demo-c25"),
        (lambda: tiny().save("x.vpr"), ".vrp"),
        (lambda: wb.Objective.of("total-cots"), "total-cost"),
        (lambda: STUDIES["tabel-3-1"], "table-3-1"),
        (lambda: Draw(10, 1, kind="time-windos"), "time-windows"),
        (lambda: wb.solve(tiny(), form="three-indx"), "three-index"),
        (lambda: wb.solve(tiny(), "pyvrp", min_iterations=3, neighbourhod=2), None),
        (lambda: wb.solve(tiny(), "highs", mip_rel_gapp=0.1), "mip_rel_gap"),
        (lambda: wb.read("demo-tiny", problem="vrptv"), "vrptw"),
        (lambda: wb.read("demo-tiny", format="solomn"), "solomon"),
        (lambda: wb.read("demo-tiny", convention="dimcas"), "dimacs"),
        (lambda: wb.read("demo-tiny", vehicels=3), "vehicles"),
        (lambda: wb.read("cover-30", problem="selection", kk=3), None),
        (lambda: wb.generate("solmon"), "solomon"),
        (lambda: wb.generate("random", customrs=3), "customers"),
        (lambda: wb.run("trackin", heuristic="greedy", steps=1), "tracking"),
        (lambda: wb.run("tracking", heuristic="greedy", steps=1, robts=3), "robots"),
    ],
)
def test_one_function_finds_typos_everywhere(call: Callable[[], object], meant: str | None) -> None:
    with pytest.raises(wb.WayboundError) as told:
        call()
    assert "\n" not in str(told.value)
    assert ("did you mean" in str(told.value)) == (meant is not None)
    if meant is not None:
        assert str(told.value).endswith(f"; did you mean {meant!r}?")


def test_the_face_knows_what_was_meant() -> None:
    with pytest.raises(AttributeError, match=r"no attribute 'RoutingProblm'; did you mean 'RoutingProblem'\?"):
        wb.RoutingProblm  # noqa: B018
