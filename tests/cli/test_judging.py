"""``waybound check, bound, explain``."""

import json

import pytest
from programs import Counting

import waybound as wb
from waybound.solvers.backend import BACKENDS


@pytest.fixture
def solved(run, tmp_path):
    """Files of a solved instance: answer, certificate."""
    out, proof = tmp_path / "a.sol", tmp_path / "c.json"
    run("solve", "demo-tiny", "--solver", "pyvrp", "--iterations", "50", "--out", out, "--certificate", proof, "-q", code=0)
    return out, proof


def test_a_feasible_solution_is_exit_0(run, strict_json, solved):
    result = run("check", "demo-tiny", solved[0], "--json")
    data = strict_json(result.stdout)
    assert (result.exit_code, data["feasible"], data["violations"]) == (0, True, [])
    assert data["stated_objective"] == pytest.approx(data["objective"])
    assert "in the file, as recomputed" in run("check", "demo-tiny", solved[0]).stdout


def test_a_dropped_visit_is_exit_5_and_named(run, strict_json, solved):
    routes = solved[0].read_text().splitlines()
    head, _, visits = routes[0].partition(":")
    dropped = visits.split()[0]
    solved[0].write_text("\n".join([f"{head}: {' '.join(visits.split()[1:])}", *routes[1:]]))
    result = run("check", "demo-tiny", solved[0], "--json")
    data = strict_json(result.stdout)
    assert (result.exit_code, data["feasible"]) == (5, False)
    assert [(v["check"], v["site"]) for v in data["violations"] if v["check"] == "visits"] == [("visits", dropped)]
    assert "visited 0 times" in run("check", "demo-tiny", solved[0]).stdout


def test_a_stated_cost_that_is_not_the_recomputed_one_is_told_with_both(run, strict_json, solved):
    solved[0].write_text("\n".join([*solved[0].read_text().splitlines()[:-1], "Cost 12.5"]))
    result = run("check", "demo-tiny", solved[0], "--json")
    data = strict_json(result.stdout)
    assert result.exit_code == 0
    assert "12.5" in data["notes"][0]
    assert repr(data["objective"]) in data["notes"][0]
    shown = run("check", "demo-tiny", solved[0]).stdout
    assert data["notes"][0].split()[0] in shown and "12.5 in the file, another objective, see the note" in shown


def test_a_certificate_is_verified(run, strict_json, solved):
    result = run("check", "demo-tiny", solved[0], "--certificate", solved[1], "--json", code=0)
    assert strict_json(result.stdout)["bound"] == json.loads(solved[1].read_text())["bound"]


@pytest.mark.share(3)
@pytest.mark.parametrize(
    ("change", "code", "says"),
    [
        ({"bound": 10**400}, 2, "not a finite number"),
        ({"objective": -(10**400)}, 5, "the answer's is"),
        ({"bound": 1e6}, 5, "its evidence proves"),
        ({"objective": 1.0}, 5, "the answer's is"),
        ({"convention": "trunc1"}, 2, "convention differs"),
        ({"instance_hash": "sha256:0"}, 2, "instance_hash differs"),
        ({"kind": "recipe"}, 2, "not a waybound certificate"),
        ({"evidence": "trust me"}, 2, "not a list"),
        ({"evidence": [{"kind": "trust", "source": "me", "value": 1.0, "data": {}}]}, 2, "unknown kind of evidence"),
    ],
)
def test_a_certificate_that_does_not_hold_is_refused(refused, solved, change, code, says):
    solved[1].write_text(json.dumps({**json.loads(solved[1].read_text()), **change}))
    assert says in refused("check", "demo-tiny", solved[0], "--certificate", solved[1], code=code)


@pytest.mark.share(3)
@pytest.mark.parametrize("text", ["", "[1, 2]", "{", "\x00"])
def test_a_file_that_is_no_certificate_is_refused_by_name(refused, solved, text):
    solved[1].write_text(text)
    assert str(solved[1]) in refused("check", "demo-tiny", solved[0], "--certificate", solved[1])


@pytest.mark.parametrize("text", ["", "Route #1: 1 99\n", "Route #1: 1 x\n", "hello\n", '{"answer": null}'])
def test_a_file_that_is_no_solution_is_refused_by_name(refused, tmp_path, text):
    path = tmp_path / "a.sol"
    path.write_text(text)
    assert str(path) in refused("check", "demo-tiny", path)


def test_settings_are_part_of_the_instance_that_is_checked_against(run, solved):
    run("check", "demo-tiny", solved[0], "--set", "capacity=10", code=5)


def test_published_solutions_are_feasible_at_their_value(json_of, benchmarks):
    folder = benchmarks / "vrptw-solomon"
    data = json_of("check", folder / "C101.txt", folder / "C101.dimacs.sol", "--convention", "dimacs")
    assert (data["feasible"], data["objective"]) == (True, pytest.approx(827.3, abs=1e-6))


def test_a_bound_is_told_with_its_source(run, strict_json, tmp_path):
    proof = tmp_path / "b.json"
    result = run("bound", "demo-tiny", "--bound-time", "60", "--json", "-q", "--certificate", proof)
    data = strict_json(result.stdout)
    assert result.exit_code == 0
    assert data["bound_kind"] == "verified"
    assert data["bound_source"]
    assert data["bound"] >= max(0.0, *(f["value"] for f in data["found"])) - 1e-6
    assert json.loads(proof.read_text())["bound"] == data["bound"]
    assert "verified:" in run("bound", "demo-tiny", "--bound-time", "60", "-q").stdout


@pytest.mark.slow
def test_each_level_of_an_objective_is_bounded(json_of, run, tmp_path):
    proof, answer = tmp_path / "b.json", tmp_path / "a.json"
    asked = ("demo-tiny", "--objective", "vehicles then total-cost")
    data = json_of("bound", *asked, "--bound-time", "60", "-q", "--certificate", proof)
    (level,) = data["levels"]
    assert data["bound"] == [2.0, level["bound"]] and level["given"] == [2.0] and 300 < level["bound"] <= 384.7341402
    assert data["bound_source"].endswith(f", then {level['source']}")
    told = run("bound", *asked, "--bound-time", "60", "-q").stdout
    assert "2 then " in told and "level 2: of solutions that are worth 2 before it" in told
    run("solve", *asked, "--heuristic", "insertion", "--bound-time", "0", "--out", answer, "-q", code=0)
    checked = run("check", *asked, answer, "--certificate", proof)
    assert checked.exit_code == 0 and "bound" in checked.stdout


def test_bounding_what_has_no_solution_says_so_and_is_exit_3(run, strict_json):
    result = run("bound", "demo-tiny", "--set", "capacity=9", "--bound-time", "60", "-q", code=3)
    assert "there is no solution, verified: no vehicle can serve site" in result.stdout
    assert "inf" not in result.stdout.split()
    result = run("bound", "demo-tiny", "--set", "capacity=9", "--bound-time", "60", "-q", "--json")
    data = strict_json(result.stdout)
    assert (result.exit_code, data["infeasible"], data["bound"]) == (3, True, None)


@pytest.mark.parametrize("value", ["0", "-1", "nan", "inf"])
def test_bounding_needs_a_finite_time(refused, value):
    assert "--bound-time" in refused("bound", "demo-tiny", f"--bound-time={value}")


def test_seed_threads_and_the_solver_of_linear_programs_reach_bounding(run, strict_json, registered):
    registered(BACKENDS, "counting", Counting)
    Counting.told.clear()
    given = ("bound", "sata-s3", "--bound-time", "20", "--json", "-q")
    own = strict_json(run(*given).stdout)["bound"]
    result = run(*given, "--lp-solver", "counting", "--seed", "9", "--threads", "2")
    assert (result.exit_code, strict_json(result.stdout)["bound"]) == (0, pytest.approx(own))
    assert {(options.seed, options.threads) for _, options in Counting.told} == {(9, 2)}


@pytest.mark.parametrize(
    ("option", "value", "says"),
    [
        ("--lp-solver", "hihgs", "unknown solver 'hihgs'; choose from "),
        ("--lp-solver", "pyvrp", "pyvrp cannot take this problem: it does not handle LP programs; can take it: "),
        ("--lp-solver", "", "unknown solver ''"),
        ("--seed", "-1", "--seed must be a whole number"),
        ("--threads", "0", "--threads must be a whole number"),
    ],
)
def test_bounding_refuses_what_it_cannot_use(refused, option, value, says):
    assert says in refused("bound", "demo-tiny", f"{option}={value}", "-q")


def test_a_bound_cannot_be_written_into_a_missing_folder(refused, tmp_path):
    assert "no folder" in refused("bound", "demo-tiny", "--certificate", tmp_path / "missing" / "b.json")


def test_explain_names_sites_and_is_exit_3(run, strict_json):
    result = run("explain", "demo-tiny", "--set", "capacity=9", "--json")
    data = strict_json(result.stdout)
    assert (result.exit_code, data["verdict"], data["according_to"]) == (3, "infeasible", "the data")
    problem = wb.read("demo-tiny")
    assert isinstance(problem, wb.RoutingProblem)
    heavy = {problem.sites.ids[i] for i in problem.customers if problem.sites.demand[i] > 9}
    assert {r["where"] for r in data["reasons"]} == heavy


def test_explain_names_the_fleet(run):
    assert "2 vehicles can carry" in run("explain", "demo-c25", "--set", "vehicles=2", code=3).stdout


def test_explain_of_an_instance_with_a_solution_is_exit_0(run):
    result = run("explain", "demo-tiny", "--time-limit", "60")
    assert (result.exit_code, "there is a solution" in result.stdout) == (0, True)


def test_explain_refuses_an_unknown_form(refused):
    assert "unknown form" in refused("explain", "demo-tiny", "--form", "four-index")


def test_a_certificate_that_holds_a_tree_is_verified_and_refused_where_a_leaf_was_lost(json_of, run, refused, tmp_path):
    graph, answer, proof = (tmp_path / name for name in ("graph.json", "answer.json", "proof.json"))
    sizes = ("robots=10", "actions=2", "targets=40", "phi=25", "weights=uniform")
    run("generate", "sata", *(word for size in sizes for word in ("--set", size)), "--seed", "3", "--out", graph)
    asked = (graph, "--problem", "winner-takes-all")
    told = json_of("solve", *asked, "--solver", "highs", "--out", answer, "--certificate", proof, "-q")
    assert told["status"] == "optimal" and told["bound_kind"] == "verified"
    data = json.loads(proof.read_text())
    assert data["evidence"][0]["kind"] == "branching-tree"
    verdict = json_of("check", graph, answer, "--problem", "winner-takes-all", "--certificate", proof)
    assert verdict["feasible"] and verdict["bound"] == pytest.approx(told["objective"])
    data["evidence"][0]["data"]["nodes"].pop()
    proof.write_text(json.dumps(data))
    said = refused("check", graph, answer, "--problem", "winner-takes-all", "--certificate", proof, code=2)
    assert "the branching tree lacks nodes" in said


@pytest.mark.parametrize(
    ("instance", "solution", "options", "objective"),
    [
        ("op/oplib-gen1/gr48-gen1-50.oplib", "gr48-gen1-50.sol", (), 31.0),
        ("top/set1/p1.2.c.txt", "p1.2.c.sol", (), 20.0),
        ("pdptw-lilim/100/lc101.txt", "lc101.hier.sol", ("--problem", "min-cost-vrp"), 828.9368669428338),
        ("vrpspd-salhi/CMT1X.vrpspd", "CMT1X.sol", ("--set", "vehicles=unlimited"), 466.7729),
        ("minmax-mtsp/mtsplib/eil51-m5.txt", "eil51-m5.sol", (), 118.133753),
        ("tsplib/gr17.tsp", "gr17.tour", (), 2085.0),
    ],
)
def test_a_solution_file_of_each_family_is_exit_0_and_a_visit_made_twice_exit_5(
    run, strict_json, benchmarks, tmp_path, instance, solution, options, objective
):
    place = (benchmarks / instance).parent
    result = run("check", benchmarks / instance, place / solution, *options, "--json")
    data = strict_json(result.stdout)
    assert (result.exit_code, data["feasible"], data["objective"]) == (0, True, pytest.approx(objective, rel=1e-6))
    text = (place / solution).read_text()
    spoilt = tmp_path / solution
    if "SECTION" in text:
        head, _, rest = text.partition("SECTION\n")
        nodes = rest.split("\n")
        claims = "".join(f"{line}\n" for line in head.split("\n")[:-1] if not line.startswith(("ROUTE_NODES", "DIMENSION")))
        title = head.split("\n")[-1]
        spoilt.write_text(f"{claims}{title}SECTION\n" + "\n".join([*nodes[:2], *nodes[1:]]))
    else:
        first = next(line for line in text.split("\n") if ":" in line)
        spoilt.write_text(text.replace(first, f"{first} {first.split()[-1]}", 1))
    run("check", benchmarks / instance, spoilt, *options, code=5)


def test_a_file_of_two_formats_is_exit_2_until_one_is_chosen(run, benchmarks):
    path = benchmarks / "toptw" / "c101.txt"
    refused = run("info", path, code=2)
    assert (
        "choose with --format, or --problem, from cordeau (mdvrp, cvrp, vrptw, min-cost-vrp); toptw (team-orienteering," in refused.output
    )
    for options in (("--format", "toptw"), ("--problem", "team-orienteering", "--set", "vehicles=3", "--convention", "trunc1")):
        run("info", path, *options, code=0)
