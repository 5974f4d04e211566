"""``waybound solve``."""

import dataclasses
import json
import os
import signal
from pathlib import Path

import pytest
from programs import Counting

import waybound as wb
from waybound.cli import main
from waybound.formulations.certificate import check_certificate
from waybound.solvers import interrupts
from waybound.solvers.backend import BACKENDS, Engine, RawResult
from waybound.solvers.backends.highs import Highs

QUICK = ("--solver", "pyvrp", "--iterations", "30", "--bound-time", "0", "--quiet")

JSON_KEYS = {
    "instance", "instance_hash", "problem", "sense", "convention", "solver", "form", "status", "limit", "objective", "bound", "bound_kind",
    "bound_source", "gap", "seconds", "seed", "versions", "answer", "certificate",
}  # fmt: skip
CERTIFICATE_KEYS = {"feasible", "checks", "objective", "bound", "bound_source", "gap", "guarantee", "observed_ratio"}


def test_json_is_one_object_with_the_promised_keys_and_nothing_else(json_of):
    data = json_of("solve", "demo-tiny", "--solver", "pyvrp", "--iterations", "30")
    assert data.keys() >= JSON_KEYS
    assert data["certificate"].keys() >= CERTIFICATE_KEYS
    assert data["seconds"].keys() == {"compile", "solve", "bound", "check"}
    assert data["certificate"]["feasible"] is True
    assert data["bound"] <= data["objective"] + 1e-6


def test_json_holds_null_where_there_is_no_number(run, strict_json):
    result = run("solve", "demo-c25", "--set", "vehicles=2", *QUICK, "--json")
    data = strict_json(result.stdout)
    assert result.exit_code in (3, 4)
    assert data["answer"] is None
    assert data["objective"] is None
    assert data["gap"] is None


def test_the_readable_answer_tells_routes_checks_objective_and_bound(run):
    told = run("solve", "demo-tiny", "--solver", "pyvrp", "--iterations", "30").stdout
    for words in ("vehicle 1", "sites in order", "feasible: all", "recomputed from the data", "verified:", "gap"):
        assert words in told


def test_without_a_solver_named_one_that_can_take_it_is_chosen(run, strict_json):
    result = run("solve", "demo-tiny", "--iterations", "30", "--bound-time", "0", "--json", "-q")
    assert strict_json(result.stdout)["solver"] in BACKENDS


def test_a_heuristic_is_named_instead_of_a_solver(run, strict_json):
    result = run("solve", "demo-tiny", "--heuristic", "savings", "--option", "shape=1.2", "--bound-time", "0", "--json", "-q", code=0)
    assert strict_json(result.stdout)["solver"] == "savings"


def test_an_answer_of_a_search_without_proof_is_not_called_optimal(json_of):
    assert json_of("solve", "demo-c25", *QUICK)["status"] == "feasible"


def test_an_optimum_on_the_solvers_word_names_the_solver(run):
    told = run("solve", "demo-tiny", "--solver", "highs", "--bound-time", "0", "-q").stdout
    assert "optimal according to highs" in told or "optimal: the verified bound meets the objective" in told


def test_notes_of_the_instance_are_told(run, tmp_path):
    path = tmp_path / "P-n4-k2.vrp"
    path.write_text(
        "NAME : P-n4-k2\nTYPE : CVRP\nDIMENSION : 4\nEDGE_WEIGHT_TYPE : EUC_2D\nCAPACITY : 10\n"
        "NODE_COORD_SECTION\n1 0 0\n2 0 5\n3 5 0\n4 5 5\n"
        "DEMAND_SECTION\n1 0\n2 4\n3 4\n4 4\nDEPOT_SECTION\n1\n-1\nEOF\n"
    )
    told = run("solve", path, *QUICK).stdout
    assert wb.read(path).notes
    assert "note" in told
    assert "P-n4-k2" in told


def test_all_outputs_are_written_and_hold_up(run, tmp_path):
    out, proof, plot = tmp_path / "a.json", tmp_path / "c.json", tmp_path / "map.png"
    run("solve", "demo-tiny", "--solver", "pyvrp", "--iterations", "30", "--out", out, "--certificate", proof, "--plot", plot, "-q", code=0)
    assert plot.read_bytes().startswith(b"\x89PNG")
    problem = wb.read("demo-tiny")
    data = json.loads(proof.read_text())
    made = check_certificate(problem, data, problem.evaluate(problem.answer_from_json(json.loads(out.read_text())["answer"])))
    assert made.bound == data["bound"] is not None
    run("check", "demo-tiny", out, "--certificate", proof, code=0)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.json", "c.json", "map.png"]


def test_a_sol_file_goes_out_and_comes_back_as_the_same_answer(json_of, tmp_path):
    path = tmp_path / "a.sol"
    solved = json_of("solve", "demo-c25", *QUICK, "--out", path)
    checked = json_of("check", "demo-c25", path)
    assert checked["objective"] == pytest.approx(solved["objective"], abs=1e-6)
    assert checked["stated_objective"] == pytest.approx(solved["objective"], abs=1e-9)
    assert checked["notes"] == []


def test_a_start_is_at_least_kept(json_of, run, strict_json, tmp_path):
    good = tmp_path / "good.json"
    best = json_of("solve", "demo-c25", "--solver", "pyvrp", "--iterations", "300", "--bound-time", "0", "-q", "--out", good)
    again = run("solve", "demo-c25", "--solver", "pyvrp", "--iterations", "1", "--bound-time", "0", "-q", "--json", "--start", good)
    assert strict_json(again.stdout)["objective"] <= best["objective"] + 1e-6


def test_the_same_seed_and_iterations_give_the_same_answer(json_of):
    first, second = (json_of("solve", "demo-rc50", *QUICK, "--seed", "5")["answer"] for _ in range(2))
    assert first == second


def test_isolation_gives_a_verified_answer_too(run, strict_json):
    result = run("solve", "demo-tiny", "--solver", "highs", "--isolate", "--bound-time", "0", "-q", "--json")
    assert (result.exit_code, strict_json(result.stdout)["certificate"]["feasible"]) == (0, True)


def test_proven_infeasibility_is_exit_3_with_the_reason(run):
    result = run("solve", "demo-tiny", "--set", "capacity=9", "--solver", "highs", "-q", code=3)
    assert "Unserved sites" in result.stdout
    assert "capacity 9" in result.stdout


def test_sites_left_out_are_told_with_the_reason_the_first_of_them_or_all(json_of, run, tmp_path):
    rows = "".join(f"{k},{k},0,5,false\n" for k in range(1, 16))
    file = tmp_path / "prizes.csv"
    file.write_text(f"# vehicles: 1\n# max-duration: 8\nid,x,y,reward,required\n0,0,0,0,true\n{rows}")
    ask = ("solve", file, "--problem", "orienteering", "--solver", "highs", "-q")
    told = run(*ask)
    assert told.exit_code == 0 and "and 1 more rows; -v shows all" in told.stdout
    assert "no vehicle can serve it: a route to it lasts 10 at least, the longest duration is 8" in told.stdout
    assert "more rows" not in run(*ask, "-v").stdout
    left = json_of(*ask)["left_out"]
    assert [one["where"] for one in left] == [str(k) for k in range(5, 16)] and all(one["proved"] for one in left)


def test_nothing_is_written_where_there_is_no_answer(run, tmp_path):
    result = run(
        "solve",
        "demo-tiny",
        "--set",
        "capacity=9",
        "--solver",
        "highs",
        "-q",
        "--out",
        tmp_path / "a.sol",
        "--plot",
        tmp_path / "a.svg",
        code=3,
    )
    assert "was not written" in result.stderr
    assert list(tmp_path.iterdir()) == []


class _Scripted(Engine):
    """An engine that does what a test tells it."""

    family = "routing"
    package = "waybound"
    modules = ("json",)
    summary = "for tests"

    def missing(self, problem):
        return frozenset()


@pytest.fixture
def engine(registered):
    """Registers an engine for one test: ``engine(run)`` with ``run(problem, options, control) -> RawResult``."""
    BACKENDS.names()

    def make(work):
        kind = type("Made", (_Scripted,), {"name": "made", "features": frozenset(), "run": lambda self, *given: work(*given)})
        registered(BACKENDS, "made", kind)

    return make


def test_no_answer_within_the_limit_is_exit_4(run, engine, strict_json):
    engine(lambda problem, options, control: RawResult("unknown", limit="time"))
    result = run("solve", "demo-c25", "--solver", "made", "--bound-time", "0", "-q", "--json", code=4)
    assert strict_json(result.stdout)["limit"] == "time"


def test_a_solver_whose_claimed_answer_breaks_a_constraint_is_exit_5_and_named(refused, engine):
    engine(lambda problem, options, control: RawResult("feasible", answer=wb.Routes.of([[1, 2]]), objective=1.0))
    told = refused("solve", "demo-tiny", "--solver", "made", "--bound-time", "0", "-q", code=5)
    assert "made claims a feasible answer" in told
    assert "visited 0 times" in told


def test_a_program_solver_that_lies_about_its_objective_is_exit_5_with_both_numbers_and_the_answer(run, strict_json, monkeypatch, tmp_path):
    honest = Highs.run

    def lie(self, program, options, control):
        return dataclasses.replace(honest(self, program, options, control), objective=1.0, bound=1.0)

    monkeypatch.setattr(Highs, "run", lie)
    best = wb.solve(wb.read("demo-tiny"), "pyvrp", iterations=300, bound_time=0)
    for extra in ((), ("--json",)):
        result = run("solve", "demo-tiny", "--solver", "highs", "--bound-time", "0", "-q", "--out", tmp_path / "a.json", *extra, code=5)
        assert "error: highs claims the objective 1.0" in result.stderr
        assert f"{best.objective:.6f}"[:-1] in result.stderr
        assert f"{best.objective:.6f}"[:-1] in result.stdout
        assert "highs claims the objective 1.0" in result.stdout
        data = json.loads((tmp_path / "a.json").read_text())
        assert data["objective"] == pytest.approx(best.objective)
        assert (data["status"], data["bound"], len(data["faults"])) == ("feasible", None, 1)
    assert strict_json(result.stdout)["answer"] == data["answer"]


def test_a_solver_that_breaks_down_is_exit_1_with_a_hint(run, refused, engine):
    def fail(problem, options, control):
        raise ZeroDivisionError("oops")

    engine(fail)
    said = refused("solve", "demo-tiny", "--solver", "made", "-q", code=1)
    assert "made failed: ZeroDivisionError: oops; run again with -v" in said
    assert 'raise ZeroDivisionError("oops")' in run("solve", "demo-tiny", "--solver", "made", "-v").stderr


@pytest.fixture
def own_signals(monkeypatch):
    """The command's main changes the handling of signals for the rest of its process, which here goes on."""
    before = {number: signal.getsignal(number) for number in interrupts.SIGNALS}
    for name in ("_ours", "_held"):
        monkeypatch.setattr(interrupts, name, getattr(interrupts, name))
    yield
    signal.set_wakeup_fd(-1)
    for number, handler in before.items():
        signal.signal(number, handler)


def test_what_native_code_prints_does_not_reach_standard_output(engine, capfd, monkeypatch, own_signals):
    def chatty(problem, options, control):
        os.write(1, b"Welcome to the solver\n")
        return RawResult("unknown", limit="time")

    engine(chatty)
    monkeypatch.setattr("sys.argv", ["waybound", "solve", "demo-tiny", "--solver", "made", "--bound-time", "0", "--json"])
    with pytest.raises(SystemExit):
        main()
    out, err = capfd.readouterr()
    json.loads(out)
    assert "Welcome to the solver" in err


def test_the_log_goes_to_standard_error_where_it_is_asked_for(run, engine):
    good = wb.solve(wb.read("demo-tiny"), heuristic="savings", bound_time=0)
    assert isinstance(good.objective, float)
    value = good.objective

    def publish(problem, options, control):
        control.publish(good.answer, value, 1.0)
        return RawResult("feasible", answer=good.answer, objective=value)

    engine(publish)
    loud = run("solve", "demo-tiny", "--solver", "made", "--bound-time", "0", "--json", "--log", "-")
    assert "objective" in loud.stderr
    assert "gap" in loud.stderr
    for quiet in ([], ["-q"]):  # by itself where standard error is no terminal
        assert run("solve", "demo-tiny", "--solver", "made", "--bound-time", "0", "--json", *quiet).stderr == ""


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("no-such-file.txt",), "no such file"),
        ((".",), "is a directory"),
        (("demo-tiny", "--solver", "gurobii"), "unknown solver 'gurobii'"),
        (("demo-tiny", "--solver", "highs:fast"), "no variants"),
        (("demo-tiny", "--heuristic", "magic"), "unknown heuristic 'magic'"),
        (("demo-tiny", "--solver", "highs", "--form", "four-index"), "unknown form 'four-index'"),
        (("demo-tiny", "--format", "xml"), "unknown format 'xml'"),
        (("demo-tiny", "--problem", "knapsack"), "unknown problem 'knapsack'"),
        (("demo-tiny", "--convention", "nearest"), "unknown convention 'nearest'"),
        (("demo-tiny", "--set", "vehicles"), "KEY=VALUE"),
        (("demo-tiny", "--set", "vehicles=3", "--set", "vehicles=4"), "given twice"),
        (("demo-tiny", "--set", "vehicles=0"), "at least 1"),
        (("demo-tiny", "--set", "vehicles=two"), "whole number"),
        (("demo-tiny", "--set", "customers=800"), "out of range"),
        (("demo-tiny", "--set", "colour=red"), "unknown setting colour"),
        (("demo-tiny", "--set", "format=json"), "use --format"),
        (("demo-tiny", "--solver", "highs", "--heuristic", "savings"), "either --solver or --heuristic"),
        (("demo-tiny", "--heuristic", "savings", "--option", "shade=1"), "no option 'shade'"),
        (("demo-tiny", "--solver", "pyvrp", "--form", "three-index"), "no forms"),
        (("demo-tiny", "--time-limit", "0"), "positive"),
        (("demo-tiny", "--time-limit", "nan"), "finite"),
        (("demo-tiny", "--bound-time", "-1"), "negative"),
        (("demo-tiny", "--gap", "-1"), "negative"),
        (("demo-tiny", "--memory-limit", "0"), "positive"),
        (("demo-tiny", "--out", "missing/a.sol"), "no folder"),
        (("demo-tiny", "--out", "a.xlsm"), "suffix"),
        (("demo-tiny", "--out", "a.tour"), "one route"),
        (("demo-tiny", "--certificate", "a.txt"), "suffix"),
        (("demo-tiny", "--plot", "a.jpeg"), "suffix"),
        (("demo-tiny", "--out", "a.json", "--certificate", "a.json"), "same file"),
        (("demo-tiny", "--start", "nothing.sol"), "no such file"),
    ],
)
def test_bad_input_is_one_line_and_exit_2(refused, tmp_path, monkeypatch, arguments, says):
    monkeypatch.chdir(tmp_path)
    assert says in refused("solve", *arguments)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "is empty"),
        (b"\xff\xfe\x00", "text"),
        (b"hello world\n", "no known format"),
        (b'{"waybound": 1', "JSON"),
        (b"Route #1: 1 2\n", "solution file"),
    ],
)
def test_a_file_that_is_no_instance_is_one_line_with_its_name(refused, tmp_path, content, says):
    path = tmp_path / "bad.txt"
    path.write_bytes(content)
    told = refused("solve", path)
    assert says in told
    assert str(path) in told


def test_a_feature_that_a_solver_lacks_is_named_with_those_that_have_it(run, refused, tmp_path):
    path = tmp_path / "priorities.json"
    run("convert", "demo-tiny", "--to", path, code=0)
    data = json.loads(path.read_text())
    data["objective"] = ["total-cost", "vehicles"]
    path.write_text(json.dumps(data))
    taken = [info for info in wb.solvers(wb.read(path)) if "routing problems" not in info.missing]
    lacking = [info.name for info in taken if info.missing and info.installed]
    assert lacking
    told = refused("solve", path, "--solver", lacking[0], "-q")
    assert "it does not handle" in told
    assert "objective:" in told or "form" in told


def test_the_solver_of_linear_programs_is_the_one_named(run, registered, strict_json):
    registered(BACKENDS, "counting", Counting)
    Counting.told.clear()
    result = run("solve", "sata-s3", "--heuristic", "lp-rounding", "--lp-solver", "counting", "--seed", 9, "--threads", 2, "--json", "-q")
    assert result.exit_code == 0 and strict_json(result.stdout)["certificate"]["feasible"]
    assert {(options.seed, options.threads) for _, options in Counting.told} == {(9, 2)}


@pytest.mark.parametrize(("name", "says"), [("hihgs", "unknown solver 'hihgs'; choose from "), ("pyvrp", "it does not handle LP programs")])
def test_who_solves_no_linear_programs_is_refused(refused, name, says):
    assert says in refused("solve", "demo-tiny", "--lp-solver", name, "-q")


@pytest.mark.parametrize(
    "arguments", [("solve",), ("solve", "demo-tiny", "--no-such-option"), ("solve", "demo-tiny", "--seed", "x"), ("fly",)]
)
def test_what_the_command_line_itself_refuses_is_exit_2(run, arguments):
    assert run(*arguments, code=2).stdout == ""


@pytest.mark.long
@pytest.mark.parametrize("setting", ["risk=0.05", "team-risk=0.05"])
def test_thirty_customers_with_risks_get_a_checked_answer_by_default(json_of, run, tmp_path, setting):
    file = tmp_path / "risky.json"
    settings = [word for pair in ("customers=30", "capacity=0", "deviation=0.3", "max-duration=250") for word in ("--set", pair)]
    run("generate", "random", *settings, "--out", file, code=0)
    data = json_of("solve", file, "--set", setting, "--time-limit", "20", "--bound-time", "5")
    assert data["certificate"]["feasible"] is True and data["objective"] < 1000.0
    assert "safety-margins" in (data["solver"], *data["message"].split())
    checks = {check["name"]: check for check in data["certificate"]["checks"]}
    assert checks["route-risk" if setting.startswith("risk") else "team-risk"]["passed"]


def test_a_view_is_drawn_and_one_that_does_not_exist_is_refused(run, refused, tmp_path):
    given = ("solve", "demo-tiny", "--heuristic", "savings", "--bound-time", 0)
    run(*given, "--plot", tmp_path / "a.svg", "--view", "schedule", code=0)
    assert (tmp_path / "a.svg").read_text().startswith("<?xml")
    assert "there are loads, schedule, history" in refused(*given, "--plot", tmp_path / "b.svg", "--view", "gantt")
    assert "give a file with --plot" in refused(*given, "--view", "schedule")


def test_an_objective_is_taken_as_text(run, refused, strict_json):
    result = run("solve", "demo-tiny", "--heuristic", "insertion", "--bound-time", 0, "--objective", "vehicles then total-cost", "--json")
    assert len(strict_json(result.stdout)["objective"]) == 2
    assert "did you mean 'total-cost'?" in refused("info", "demo-tiny", "--objective", "total-costs")
    both = ("solve", "demo-tiny", "--set", "objective=vehicles", "--objective", "vehicles")
    assert "given twice" in refused(*both)
    assert "no setting 'objective'" in refused("solve", "sata-s3", "--objective", "vehicles")


def test_the_log_overwrites_neither_input_nor_other_outputs(refused, tmp_path):
    given = ("solve", "demo-tiny", "--heuristic", "savings", "--bound-time", 0)
    assert "another output" in refused(*given, "--out", tmp_path / "a.sol", "--log", tmp_path / "a.sol")
    assert "no folder" in refused(*given, "--log", tmp_path / "none" / "a.log")


def test_the_page_of_an_answer_and_of_none_is_written(run, tmp_path):
    page = tmp_path / "a.html"
    run("solve", "demo-tiny", *QUICK, "--page", page, code=0)
    assert "feasible: all 7 checks hold" in page.read_text()
    run("solve", "demo-tiny", "--set", "capacity=9", "--solver", "highs", "--quiet", "--page", page, code=3)
    assert "infeasible, verified" in page.read_text()


def test_a_page_that_could_not_be_written_is_refused_before_the_search(refused, run, tmp_path):
    (tmp_path / "folder.html").mkdir()
    for path, says in (("a.png", "suffix must be one of .html"), ("none/a.html", "there is no folder"), ("folder.html", "is a directory")):
        assert says in refused("solve", "demo-tiny", *QUICK, "--page", tmp_path / path)
    assert "name the same file" in refused("solve", "demo-tiny", *QUICK, "--page", tmp_path / "a.html", "--out", tmp_path / "a.html")
    assert [one.name for one in tmp_path.iterdir()] == ["folder.html"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no device that is full here")
def test_a_full_disk_costs_the_page_and_not_the_answer(run, tmp_path):
    (tmp_path / "full.html").symlink_to("/dev/full")
    result = run("solve", "demo-tiny", *QUICK, "--page", tmp_path / "full.html", "--out", tmp_path / "a.json", code=2)
    assert "full.html: cannot be written: No space left on device" in result.stderr and (tmp_path / "a.json").exists()
