"""A problem that no module of waybound knows goes through every command that shows, writes or judges it."""

import json

import pytest
from outside_family import LeastWaiting, register

import waybound as wb


@pytest.fixture
def jobs(registered, tmp_path):
    """A file of jobs; ``jobs(horizon=...)`` for another."""
    register(registered)

    def write(**more):
        path = tmp_path / f"jobs{len(more)}.json"
        path.write_text(json.dumps({"waybound": 1, "kind": "jobs", "durations": {"a": 4, "b": 1, "c": 2}, **more}))
        return path

    return write


def test_it_is_read_and_solved_as_its_own_problem(jobs):
    problem = wb.read(jobs())
    assert isinstance(problem, LeastWaiting)
    assert list(wb.solve(problem, heuristic="shortest-first", bound_time=0).to_frame()["job"]) == ["b", "c", "a"]


def test_info_tells_its_facts_and_who_takes_it(json_of, run, jobs):
    told = run("info", jobs()).stdout
    rows = [line.split() for line in told.splitlines()]
    for row in (["problem", "least-waiting,", "min"], ["jobs", "3"], ["longest", "jobs", "a,", "c"]):
        assert row in rows
    data = json_of("info", jobs(horizon=5))
    assert (data["jobs"], data["longest_jobs"], data["horizon"]) == (3, ["a", "c"], 5)
    assert {h["name"] for h in data["heuristics"] if not h["missing"]} == {"shortest-first"}


def test_heuristics_lists_what_takes_it_and_what_the_others_lack(json_of, jobs):
    missing = {h["name"]: h["missing"] for h in json_of("heuristics", jobs())["heuristics"]}
    assert missing["shortest-first"] == []
    assert missing["savings"] == ["one-machine problems"]


@pytest.mark.parametrize("suffix", [".json", ".order"])
def test_its_answers_are_shown_written_and_checked(run, strict_json, jobs, tmp_path, suffix):
    file, out = jobs(), tmp_path / f"answer{suffix}"
    solved = run("solve", file, "--heuristic", "shortest-first", "--bound-time", 0, "--out", out, "-q", code=0)
    rows = [line.split() for line in solved.stdout.splitlines()]
    assert [row for row in rows if row[:1] in (["a"], ["b"], ["c"])] == [["b", "1"], ["c", "3"], ["a", "7"]]
    checked = run("check", file, out, "--json")
    data = strict_json(checked.stdout)
    assert (checked.exit_code, data["objective"], data["stated_objective"], data["notes"]) == (0, 11, 11, [])
    assert data["quantities"] == {"end": 7}


def test_another_stated_objective_is_told_without_talk_of_distances(json_of, jobs, tmp_path):
    (tmp_path / "answer.order").write_text("a > b > c\n3\n")
    data = json_of("check", jobs(), tmp_path / "answer.order")
    assert data["notes"] == ["the file states 3.0, recomputed from the data it is 16.0"]


def test_files_that_are_no_answers_to_it_are_refused_with_what_is(refused, jobs, tmp_path):
    file = jobs()
    assert "answers to least-waiting problems are written as .json, .order" in refused("solve", file, "--out", tmp_path / "a.sol", "-q")
    (tmp_path / "b.sol").write_text("Route #1: 1 2\n")
    assert "is no solution file of least-waiting problems" in refused("check", file, tmp_path / "b.sol")


@pytest.mark.parametrize(
    "held", ['{"kind": "order"}', '{"kind": "order", "jobs": 7}', '{"kind": "order", "jobs": [["a"]]}', "a > b\nmany\n", "a > z\n3\n"]
)
def test_an_answer_that_its_family_fails_at_is_refused_in_one_line(refused, jobs, tmp_path, held):
    file, answer = jobs(), tmp_path / "answer.order"
    answer.write_text(held)
    for words in (("check", file, answer), ("solve", file, "--heuristic", "shortest-first", "--start", answer, "-q")):
        assert "it fails as an answer to a least-waiting problem; found" in refused(*words)


def test_a_picture_that_nobody_draws_is_refused_before_the_search(refused, jobs, tmp_path):
    told = refused("solve", jobs(), "--heuristic", "shortest-first", "--plot", tmp_path / "a.png", "-q")
    assert "answers to least-waiting problems cannot be drawn" in told


def test_its_reasons_explain_why_there_is_no_answer(run, strict_json, jobs):
    result = run("explain", jobs(horizon=5), "--json")
    data = strict_json(result.stdout)
    assert (result.exit_code, data["verdict"], data["according_to"]) == (3, "infeasible", "the data")
    assert [(r["kind"], r["where"], r["evidence"]["kind"]) for r in data["reasons"]] == [("machine", "hours", "machine-time")]
    assert "the jobs take longer than 5" in run("explain", jobs(horizon=5)).stdout
