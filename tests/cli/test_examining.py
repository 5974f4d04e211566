"""``waybound solvers --examine``: who is right on programs whose optima are known."""

from __future__ import annotations

import pytest


@pytest.mark.slow
def test_solvers_are_examined_on_programs_whose_optima_are_known(run, strict_json):
    told = run("solvers", "--examine", "highs", "--count", 20, "-q")
    assert told.exit_code == 0, told.stderr
    for word in ("wrong optimum", "false infeasible", "gave up", "highs"):
        assert word in told.stdout
    data = strict_json(run("solvers", "--examine", "highs", "--count", 5, "--seed", 3, "--json", "-q").stdout)
    assert (data["count"], data["seed"], data["solvers"][0]["cases"], data["solvers"][0]["wrong_optimum"]) == (5, 3, 5, 0)


@pytest.mark.slow
def test_a_solver_that_says_what_is_false_ends_with_5_and_the_programs(run, strict_json, tmp_path):
    asked = ("--kind", "time-windows", "--form", "two-index-mtz", "--count", 20, "--option", "presolve_rule_off=0", "-q")
    told = run("solvers", "--examine", "highs", *asked, "--out", tmp_path / "wrong", "--json")
    assert told.exit_code == 5
    (one,) = strict_json(told.stdout)["solvers"]
    assert one["false_infeasible"] == 1
    (kept,) = (tmp_path / "wrong").iterdir()
    assert one["told"][0]["file"] == str(kept)
    assert "case 16" in told.stderr
    assert "the solver says infeasible" in told.stderr


def test_options_of_an_examination_are_refused_without_one_and_others_with_it(refused):
    assert "--count" in refused("solvers", "--count", 3)
    assert "--problem" in refused("solvers", "--examine", "--problem", "vrptw")
    assert "--count" in refused("solvers", "--examine", "highs", "--count", 0)
    assert "--examine NAME" in refused("solvers", "--examine", "--option", "presolve=off")
    assert "kind or form" in refused("solvers", "--examine", "highs", "--by", "size")
    assert "pyvrp" in refused("solvers", "--examine", "pyvrp", "--count", 1)
    assert "presolve_rul_off" in refused("solvers", "--examine", "highs", "--count", 1, "--option", "presolve_rul_off=0", "-q")
