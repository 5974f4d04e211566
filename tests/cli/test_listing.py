"""``waybound info, solvers, heuristics``."""

from __future__ import annotations

import json
import subprocess
import sys

import waybound as wb
from waybound.instances.bundled import bundled_path


def test_info_tells_what_an_instance_holds(run, strict_json):
    data = strict_json(run("info", "demo-c25", "--json").stdout)
    problem = wb.read("demo-c25")
    assert isinstance(problem, wb.RoutingProblem)
    assert data["sites"]["customers"] == len(problem.customers)
    assert data["demand"]["total"] == problem.sites.demand.sum()
    assert data["instance_hash"] == problem.digest()
    assert data["fleet"][0]["count"] == problem.vehicle_limit
    assert {s["name"] for s in data["solvers"]} >= {"highs", "pulp", "ortools", "pyvrp"}
    assert {h["name"] for h in data["heuristics"]} >= {"savings"}
    assert data["format"] == "solomon"


def test_infinite_limits_are_null_in_json(run, strict_json):
    assert strict_json(run("info", "demo-tiny", "--json").stdout)["fleet"][0]["max_duration"] is None


def test_info_for_people_names_features_and_takers(run):
    told = run("info", "demo-c25").stdout
    for words in ("25 customers", "capacity", "time-windows", "takes it", "pyvrp", "savings", "sha256:"):
        assert words in told


def test_info_counts_sites_out_of_reach(run):
    assert "cannot be reached" in run("info", "demo-tiny", "--set", "capacity=9").stdout


def test_solvers_are_listed_with_versions(run, strict_json):
    listed = {s["name"]: s for s in strict_json(run("solvers", "--json").stdout)["solvers"]}
    assert listed["highs"]["installed"]
    assert listed["highs"]["version"].startswith("1.")
    assert "OR-Tools" in run("solvers").stdout


def test_a_solver_that_is_not_installed_is_listed_with_the_command_that_brings_it(run, monkeypatch):
    from waybound.solvers.backend import BACKENDS

    monkeypatch.setattr(BACKENDS["pyvrp"], "modules", ("no_such_module_anywhere",))
    assert "pip install pyvrp" in run("solvers").stdout


def test_a_solver_that_is_not_installed_cannot_be_used_and_says_how_to_get_it(refused, monkeypatch):
    from waybound.solvers.backend import BACKENDS

    monkeypatch.setattr(BACKENDS["pyvrp"], "modules", ("no_such_module_anywhere",))
    assert "pip install pyvrp" in refused("solve", "demo-tiny", "--solver", "pyvrp", "-q")


def test_with_a_file_solvers_say_whether_they_take_it(run, strict_json):
    listed = strict_json(run("solvers", "demo-tiny", "--json").stdout)["solvers"]
    assert any(not s["missing"] for s in listed)


def test_heuristics_say_what_they_guarantee(run, strict_json):
    listed = strict_json(run("heuristics", "--json").stdout)["heuristics"]
    assert all(h["guarantee"] for h in listed)
    assert "guarantee" in run("heuristics", "demo-tiny").stdout


def test_a_pipe_is_read_once(tmp_path):
    text = bundled_path("demo-tiny").read_bytes()
    told = subprocess.run([sys.executable, "-m", "waybound", "info", "/dev/stdin", "--json"], input=text, capture_output=True, check=True)
    assert json.loads(told.stdout)["instance_hash"] == wb.read("demo-tiny").digest()


def test_info_leaves_out_who_takes_other_families(run):
    shown = run("info", "demo-tiny").stdout
    assert " pyvrp " in shown and " outer-approximation " in shown and " lapjv " not in shown and " auction " not in shown
    assert "solvers for other families are left out; `waybound solvers demo-tiny` lists all" in " ".join(shown.split())
    assert " lapjv " in run("solvers", "demo-tiny").stdout
