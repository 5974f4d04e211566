import re
from dataclasses import replace

import numpy as np
import pytest
from programs import program

from waybound import LongestRoute, Program, RoutingProblem, Sites, Travel, UsageError, Vehicles, VehicleType
from waybound.formulations.forms import FORMS
from waybound.solvers.backend import LIMITS, STATUSES, Control, Options
from waybound.solvers.backends.highs import INTERIOR_POINT, SOUND, STATUS_MAP, Highs, named_options, sound


def lp(size: int = 2) -> Program:
    """Cover every row at least cost."""
    rng = np.random.default_rng(0)
    return program(1.0 + rng.random(size), rng.random((size, size)), 1, np.inf)


def test_every_status_of_highs_has_one_of_ours() -> None:
    import highspy

    assert set(STATUS_MAP) == set(highspy.HighsModelStatus.__members__)
    assert all(status in STATUSES and limit in LIMITS for status, limit in STATUS_MAP.values())


@pytest.mark.parametrize("form", INTERIOR_POINT)
def test_linear_programs_of_some_forms_go_to_the_interior_point_unless_overridden(form: str) -> None:
    asked = replace(lp(30), name=form)
    inner = Highs().run(asked, Options(), Control())
    assert inner.statistics["ipm_iterations"] > 0
    for other in (Highs().run(asked, Options(extra={"solver": "simplex"}), Control()), Highs().run(lp(30), Options(), Control())):
        assert other.statistics["ipm_iterations"] <= 0
        assert other.statistics["simplex_iterations"] > 0
        assert inner.objective == pytest.approx(other.objective)


def test_forms_whose_linear_programs_go_to_the_interior_point_exist() -> None:
    assert set(INTERIOR_POINT) <= set(FORMS)


def test_small_integer_programs_are_searched_without_presolve_unless_the_user_has_a_word() -> None:
    small = program(np.ones(4), [[1, 1, 1, 1]], 2, np.inf, 0, 1, integer=range(4))
    endless = program([-1.0], [[1.0]], 0, np.inf, 0, np.inf, integer=[0])
    large = program(np.ones(80), np.ones((80, 80)), 2, np.inf, 0, 1, integer=range(80))
    assert sound(small, {}) == sound(small, {"presolve": "on"}) == {**SOUND, "presolve": "off"}  # the user's own overrule it
    assert sound(small, {"presolve_rule_off": 0}) == sound(large, {}) == sound(endless, {}) == sound(lp(), {}) == SOUND


def test_an_optimum_that_presolve_loses_is_found() -> None:
    """Three sites with windows; routes are as long as the longest of them and a half a vehicle."""
    xy = np.array([(1.0, 13.0), (9.0, 13.0), (18.0, 3.0), (9.0, 11.0)])
    sites = Sites.of("oabc", coordinates=xy, ready=[0.0, 10.0, 16.0, 24.0], due=[np.inf, 41.0, 45.0, 50.0])
    travel = Travel("euclidean", coordinates=xy, convention="trunc1")
    problem = RoutingProblem(sites, travel, [VehicleType()], LongestRoute() + 0.5 * Vehicles())
    compiled = problem.compile("three-index").program
    result = Highs().run(compiled, Options(time_limit=20.0), Control())
    assert (result.status, result.objective) == ("optimal", pytest.approx(40.4))


@pytest.mark.parametrize(
    ("name", "text", "value"),
    [
        ("presolve", "off", "off"), ("mip_max_leaves", "12", 12), ("presolve_rule_off", "4096", 4096),
        ("primal_feasibility_tolerance", "1e-8", 1e-8), ("mip_detect_symmetry", "false", False),
    ],
)  # fmt: skip
def test_options_given_as_text_get_their_type(name: str, text: str, value) -> None:
    assert named_options("highs", {name: text}) == {name: value}


@pytest.mark.parametrize(
    ("extra", "message"),
    [
        ({"presolv": "off"}, "no option 'presolv'; did you mean 'presolve'?"), ({"mip_max_leaves": "many"}, "takes a whole number"),
        ({"mip_detect_symmetry": "perhaps"}, "takes a truth value"), ({"time_limit": 5}, "the time limit by its own option"),
        ({"presolve": "sometimes"}, "'sometimes' is no value"),
    ],
)  # fmt: skip
def test_wrong_options_are_refused_in_one_line(extra, message: str) -> None:
    with pytest.raises(UsageError, match=re.escape(message)):
        Highs().run(lp(), Options(extra=extra), Control())


def test_nothing_is_written_to_the_standard_output(capfd: pytest.CaptureFixture[str]) -> None:
    Highs().run(lp(), Options(), Control())
    assert capfd.readouterr().out == ""


def test_the_duals_of_an_lp_prove_its_value() -> None:
    asked = lp(30)
    result = Highs().run(asked, Options(), Control())
    assert result.row_duals is not None
    assert (asked.cost - asked.matrix.T @ result.row_duals >= -1e-7).all()
    assert result.row_duals @ asked.row_lower == pytest.approx(result.objective)


def test_an_integer_between_fractional_bounds_is_whole() -> None:
    between = program([-3, -3], [[1, 0]], -1, 1, [0.3, 0], [1.5, 2.5], integer=[0], sense="max")
    result = Highs().run(between, Options(), Control())
    assert (result.status, result.objective) == ("optimal", -3.0)
