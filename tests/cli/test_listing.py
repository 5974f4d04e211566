"""``waybound info, solvers, heuristics, instances``."""

import json
import subprocess
import sys

import pytest

import waybound as wb
from waybound.instances.bundled import bundled_path
from waybound.solvers.backend import BACKENDS


def test_info_tells_what_an_instance_holds(json_of):
    data = json_of("info", "demo-c25")
    problem = wb.read("demo-c25")
    assert isinstance(problem, wb.RoutingProblem)
    assert data["sites"]["customers"] == len(problem.customers)
    assert data["demand"]["total"] == problem.sites.demand.sum()
    assert data["instance_hash"] == problem.digest()
    assert data["fleet"][0]["count"] == problem.vehicle_limit
    assert {s["name"] for s in data["solvers"]} >= {"highs", "pulp", "ortools", "pyvrp"}
    assert {h["name"] for h in data["heuristics"]} >= {"savings"}
    assert data["format"] == "solomon"


def test_infinite_limits_are_null_in_json(json_of):
    assert json_of("info", "demo-tiny")["fleet"][0]["max_duration"] is None


def test_info_for_people_names_features_and_takers(run):
    told = run("info", "demo-c25").stdout
    for words in ("25 customers", "capacity", "time-windows", "takes it", "pyvrp", "savings", "sha256:"):
        assert words in told


def test_info_counts_sites_out_of_reach(run):
    assert "cannot be reached" in run("info", "demo-tiny", "--set", "capacity=9").stdout


def test_solvers_are_listed_with_versions(json_of, run):
    listed = {s["name"]: s for s in json_of("solvers")["solvers"]}
    assert listed["highs"]["installed"]
    assert listed["highs"]["version"].startswith("1.")
    assert "OR-Tools" in run("solvers").stdout


def test_a_solver_that_is_not_installed_is_listed_with_the_command_that_brings_it(run, monkeypatch):
    monkeypatch.setattr(BACKENDS["pyvrp"], "modules", ("no_such_module_anywhere",))
    assert "pip install pyvrp" in run("solvers").stdout


def test_a_solver_that_is_not_installed_cannot_be_used_and_says_how_to_get_it(refused, monkeypatch):
    monkeypatch.setattr(BACKENDS["pyvrp"], "modules", ("no_such_module_anywhere",))
    assert "pip install pyvrp" in refused("solve", "demo-tiny", "--solver", "pyvrp", "-q")


def test_with_a_file_solvers_say_whether_they_take_it(json_of):
    assert any(not s["missing"] for s in json_of("solvers", "demo-tiny")["solvers"])


def test_heuristics_say_what_they_guarantee(json_of, run):
    assert all(h["guarantee"] for h in json_of("heuristics")["heuristics"])
    assert "guarantee" in run("heuristics", "demo-tiny").stdout


def test_a_pipe_is_read_once(tmp_path):
    text = bundled_path("demo-tiny").read_bytes()
    told = subprocess.run([sys.executable, "-m", "waybound", "info", "/dev/stdin", "--json"], input=text, capture_output=True, check=True)
    assert json.loads(told.stdout)["instance_hash"] == wb.read("demo-tiny").digest()


@pytest.mark.parametrize("command", ["info", "solvers", "heuristics"])
def test_what_applies_comes_first_and_the_rest_is_a_count(run, json_of, command):
    shown, every = (run(command, "demo-tiny", *more).stdout for more in ((), ("-v",)))
    data = json_of(command, "demo-tiny")
    for what in {"solvers", "heuristics"} & set(data):
        able, unable = ([row["name"] for row in data[what] if bool(row["missing"]) == lacks] for lacks in (False, True))
        assert able and unable and sorted([*able, *unable]) == [row["name"] for row in data[what]]
        assert all(f"\n {name} " in every or f"\n{name} " in every for name in able + unable)
        assert all(f"\n {name} " in shown or f"\n{name} " in shown for name in able)
        assert not [name for name in unable if f"\n {name} " in shown or f"\n{name} " in shown]
        assert max(every.index(f"{name} ") for name in able) < every.index(f"{unable[-1]} ")
        assert f"and {len(unable)} that do not take it; -v shows all" in shown


def test_bundled_instances_are_listed_shown_and_found(json_of, run):
    names = [entry["name"] for entry in json_of("instances", "list")["bundled"]]
    assert "demo-c25" in names
    assert "demo-c25" in run("instances", "list").stdout
    assert wb.read(run("instances", "path", "demo-c25").stdout.strip()).digest() == wb.read("demo-c25").digest()
    assert run("instances", "show", "demo-x40").stdout.startswith("NAME")


@pytest.mark.parametrize("command", ["path", "show"])
def test_an_unknown_bundled_name_lists_the_known_ones(refused, command):
    assert "demo-c25" in refused("instances", command, "demo-z99")


@pytest.mark.slow
def test_solvers_are_examined_on_programs_whose_optima_are_known(json_of, run):
    told = run("solvers", "--examine", "highs", "--count", 20, "-q", code=0)
    for word in ("wrong optimum", "false infeasible", "gave up", "highs"):
        assert word in told.stdout
    data = json_of("solvers", "--examine", "highs", "--count", 5, "--seed", 3, "-q")
    assert (data["count"], data["seed"], data["solvers"][0]["cases"], data["solvers"][0]["wrong_optimum"]) == (5, 3, 5, 0)


@pytest.mark.slow
def test_a_solver_that_says_what_is_false_ends_with_5_and_the_programs(run, strict_json, tmp_path):
    asked = ("--kind", "time-windows", "--form", "two-index-mtz", "--count", 20, "--option", "presolve_rule_off=0", "-q")
    told = run("solvers", "--examine", "highs", *asked, "--out", tmp_path / "wrong", "--json", code=5)
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
