"""The commands on sensing graphs, selections and max-min programs."""

import json

import pytest

import waybound as wb
from waybound.instances.bundled import bundled_path
from waybound.instances.writing import write_instance

SENSING = ("bottleneck", "bottleneck-lp", "winner-takes-all", "selection")
VALUES = {"bottleneck": 1.0, "bottleneck-lp": 4 / 3, "winner-takes-all": 3.0, "selection": 3.0}


@pytest.fixture
def max_min_file(tmp_path):
    path = tmp_path / "program.json"
    write_instance(wb.MaxMinLP([[1, 1], [0, 2]], [[1, 0], [0, 3]], name="program").instance, path)
    return path


@pytest.mark.parametrize("problem", SENSING)
def test_solve_writes_an_answer_and_a_certificate_that_check_verifies(json_of, run, strict_json, tmp_path, problem):
    out, certificate = tmp_path / "a.json", tmp_path / "c.json"
    data = json_of("solve", "figure-3-3", "--problem", problem, "--solver", "highs", "--out", out, "--certificate", certificate, "-q")
    assert data["problem"] == problem
    assert data["objective"] == pytest.approx(VALUES[problem], abs=1e-9)
    verdict = run("check", "figure-3-3", out, "--problem", problem, "--certificate", certificate, "--json", code=0)
    assert strict_json(verdict.stdout)["objective"] == pytest.approx(VALUES[problem], abs=1e-9)


def test_a_selection_and_a_max_min_program_are_solved_too(json_of, max_min_file):
    assert json_of("solve", "cover-30", "--solver", "highs", "-q")["objective"] == 142.0
    program = json_of("solve", max_min_file, "--solver", "highs", "-q")
    assert program["objective"] == pytest.approx(3 / 4, abs=1e-9)  # x = 3/4, 1/4


@pytest.mark.parametrize(
    ("arguments", "shown"),
    [
        (("figure-3-3",), ["robot", "action", "p3"]),
        (("figure-3-3", "--problem", "winner-takes-all"), ["target", "weight", "t3"]),
        (("cover-30",), ["element", "gain", "142"]),
    ],
)
def test_people_see_the_answer_as_a_table(run, arguments, shown):
    result = run("solve", *arguments, "--solver", "highs", "-q", code=0)
    assert all(word in result.stdout for word in ("Answer", *shown))


def test_a_long_answer_is_cut_in_the_table_and_whole_in_the_file(run, tmp_path):
    graph, out = tmp_path / "g.json", tmp_path / "a.json"
    run("generate", "sensing-regular", "--set", "robots=40", "--seed", 40, "--out", graph, code=0)
    result = run("solve", graph, "--solver", "highs", "--out", out, "-q", code=0)
    shares = json.loads(out.read_text())["answer"]["actions"]
    assert f"and {len(shares) - 20} more" in result.stdout


@pytest.mark.parametrize("suffix", [".sol", ".tour"])
def test_answers_other_than_routes_are_json_alone(refused, tmp_path, suffix):
    told = refused("solve", "figure-3-3", "--out", tmp_path / f"a{suffix}", "-q")
    assert "answers to bottleneck problems are written as .json" in told
    (tmp_path / f"b{suffix}").write_text("Route #1: 1 2\nCost 5\n")
    assert "is no solution file of bottleneck problems; expected JSON" in refused("check", "figure-3-3", tmp_path / f"b{suffix}")


def test_an_answer_that_breaks_a_rule_is_found_out(run, tmp_path):
    path = tmp_path / "a.json"
    path.write_text(json.dumps({"kind": "assignment", "actions": [{"action": "p1"}, {"action": "p2"}]}))
    assert "robot r1 takes 2 actions" in run("check", "figure-3-3", path, code=5).stdout


@pytest.mark.parametrize("problem", SENSING)
def test_info_tells_sizes_and_who_takes_it(json_of, problem):
    data = json_of("info", "figure-3-3", "--problem", problem)
    assert data["problems"] == list(SENSING)
    assert {"highs", "ortools"} <= {s["name"] for s in data["solvers"]}
    assert data["heuristics"]
    if problem == "selection":
        assert data["constraint"] == {"kind": "partition", "groups": 3, "limits": [1], "rank": 3}
    else:
        graph = data["graph"]
        assert (graph["robots"], graph["actions"], graph["targets"], graph["edges"]) == (3, 6, 3, 7)
        assert (graph["delta_r"], graph["delta_t"], graph["idle_robots"], graph["unseen_targets"]) == (2, 3, [], [])


def test_info_names_idle_robots_and_unseen_targets(json_of, run, tmp_path):
    path = tmp_path / "g.csv"
    path.write_text("robot,action,target\na,p,x\nb,q,\nc,,\n,,y\n")
    table = run("info", path, code=0)
    assert "2: b, c" in table.stdout
    assert "1: y" in table.stdout
    assert "UserWarning" not in table.stderr
    graph = json_of("info", path)["graph"]
    assert (graph["idle_robots"], graph["unseen_targets"], graph["seeing_actions"]) == (["b", "c"], ["y"], 1)


def test_info_of_a_selection_and_of_a_max_min_program(json_of, run, max_min_file):
    assert "coverage of 61 items by 30 elements" in run("info", "cover-30").stdout
    data = json_of("info", max_min_file)
    assert data["packing"] == {"rows": 2, "entries": 3, "longest_row": 2}
    assert data["one_packing_row"] is False
    assert "some variables in several packing rows" in run("info", max_min_file).stdout


def test_instances_go_from_one_format_to_another_and_back(run, tmp_path):
    run("convert", "figure-3-3", "--to", tmp_path / "a.json", code=0)
    run("convert", tmp_path / "a.json", "--to", tmp_path / "b.csv", code=0)
    assert (tmp_path / "b.csv").read_bytes() == bundled_path("figure-3-3").read_bytes()


def test_conversion_names_what_a_format_cannot_hold(run, refused, tmp_path):
    assert "no format of a sensing instance" in refused("convert", "figure-3-3", "--to", tmp_path / "a.vrp")
    assert "holds no routing data" in refused("convert", "figure-3-3", "--to", tmp_path / "a.txt", "--to-format", "solomon")
    assert "no format of a selection instance" in refused("convert", "cover-30", "--to", tmp_path / "a.csv")
    run("generate", "sensing-geometric", "--set", "robots=9", "--out", tmp_path / "g.json", code=0)
    assert "no place for positions" in refused("convert", tmp_path / "g.json", "--to", tmp_path / "g.csv")
    assert {p.name for p in tmp_path.iterdir()} == {"g.json"}


@pytest.mark.parametrize("kind", ["sata", "sensing-regular", "sensing-ring", "sensing-geometric", "coverage"])
def test_generated_instances_repeat_themselves_and_are_read_back(run, tmp_path, kind):
    for name, seed in (("a", 3), ("b", 3), ("c", 4)):
        run("generate", kind, "--set", "name=x", "--seed", seed, "--out", tmp_path / f"{name}.json", code=0)
    a, b, c = ((tmp_path / f"{name}.json").read_text() for name in "abc")
    assert a == b != c
    assert wb.read(tmp_path / "a.json").name == "x"


def test_a_density_that_is_too_low_is_explained(refused, tmp_path):
    told = refused("generate", "sata", "--set", "robots=4", "--set", "phi=12", "--out", tmp_path / "a.csv")
    assert "ask for phi of at least 13.25" in told
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("figure-3-3", "--problem", "vrptw"), "holds no routing data"),
        (("demo-tiny", "--problem", "winner-takes-all"), "holds no sensing graph"),
        (("figure-3-3", "--convention", "trunc1"), "the convention can only be exact"),
        (("figure-3-3", "--set", "vehicles=3"), "bottleneck has no setting 'vehicles'"),
        (("figure-3-3", "--solver", "pyvrp"), "pyvrp cannot take this problem: it does not handle max-min problems"),
        (("figure-3-3", "--heuristic", "savings"), "heuristic savings cannot take this problem"),
        (("cover-30", "--form", "three-index"), "form three-index cannot take this problem"),
    ],
)
def test_solve_refuses_what_makes_no_sense(refused, arguments, says):
    assert says in refused("solve", *arguments, "-q")


@pytest.mark.parametrize(
    ("rows", "line", "says"),
    [
        ("1,p,x,-1", 2, "not negative"),
        ("1,p,x,nan", 2, "weight must be a finite number"),
        ("1,p,x,1\n1,p,x,2", 3, "the edge stands already in line 2"),
        (",p,x,1", 2, "the action has no robot"),
    ],
)
def test_a_bad_edge_list_is_one_line_with_its_place(refused, tmp_path, rows, line, says):
    path = tmp_path / "bad.csv"
    path.write_text(f"robot,action,target,weight\n{rows}\n")
    told = refused("info", path)
    assert f"bad.csv:{line}: " in told
    assert says in told


@pytest.mark.parametrize("arguments", [("figure-3-3",), ("figure-3-3", "--problem", "winner-takes-all"), ("cover-30",)])
def test_bound_and_explain_take_them(run, arguments):
    assert "verified" in run("bound", *arguments, "--bound-time", "60", "-q", code=0).stdout
    assert "there is a solution" in run("explain", *arguments, code=0).stdout


@pytest.mark.parametrize("problem", SENSING)
def test_a_plot_is_written(run, tmp_path, problem):
    run("solve", "figure-3-3", "--problem", problem, "--solver", "highs", "--bound-time", 0, "--plot", tmp_path / "a.png", "-q", code=0)
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_a_program_of_a_sensing_graph_is_exported(run, tmp_path):
    assert "variables" in run("export", "figure-3-3", "--to", tmp_path / "a.mps", code=0).stdout


def test_small_cases_are_listed_with_their_source(json_of):
    listed = {entry["name"]: entry for entry in json_of("instances", "list")["bundled"]}
    assert listed["figure-3-3"]["recipe"] is None
    assert "Figure 3.3" in listed["figure-3-3"]["source"]
    assert listed["demo-c25"]["source"] is None
