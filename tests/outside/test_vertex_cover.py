"""A family from an installed package outside the tree is solved, certified, read, checked and listed; no module of waybound knows of it."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
TEXT = "vertex-cover\nvertex a 3\nvertex b 2\nvertex c 2\nvertex d 5\nedge a b\nedge b c\nedge c a\nedge c d\n"
"""Weight 4: b and c."""


@pytest.fixture
def cover(tmp_path: Path) -> Path:
    path = tmp_path / "square.cover"
    path.write_text(TEXT)
    return path


def run(*words: object) -> subprocess.CompletedProcess[str]:
    env = {**os.environ, "PYTHONPATH": os.pathsep.join([str(HERE), os.environ.get("PYTHONPATH", "")])}
    return subprocess.run([sys.executable, *map(str, words)], capture_output=True, text=True, env=env)


def command(*words: object) -> subprocess.CompletedProcess[str]:
    return run("-m", "waybound", *words)


@pytest.mark.slow
def test_its_file_is_solved_written_and_checked_by_the_command_line(cover: Path, tmp_path: Path) -> None:
    out, certificate = tmp_path / "answer.json", tmp_path / "certificate.json"
    solved = command("solve", cover, "--bound-time", 20, "--json", "-q", "--out", out, "--certificate", certificate)
    assert solved.returncode == 0, solved.stderr
    told = json.loads(solved.stdout)
    assert (told["problem"], told["objective"], told["status"], told["bound_kind"]) == ("vertex-cover", 4.0, "optimal", "verified")
    assert told["answer"]["vertices"] == ["b", "c"]
    checked = command("check", cover, out, "--certificate", certificate)
    assert checked.returncode == 0, checked.stderr
    assert "verified: edge-prices" in checked.stdout
    data = json.loads(out.read_text())
    data["answer"]["vertices"] = ["b", "d"]
    out.write_text(json.dumps(data))
    broken = command("check", cover, out)
    assert broken.returncode == 5
    assert "edge c a is not met" in broken.stdout


@pytest.mark.slow
def test_its_heuristic_states_its_guarantee_and_proves_its_bound(cover: Path) -> None:
    told = json.loads(command("solve", cover, "--heuristic", "edge-payments", "--json", "-q", "--bound-time", "0").stdout)
    assert told["certificate"]["guarantee"]["ratio"] == 2.0
    assert told["certificate"]["observed_ratio"] <= 2.0
    assert told["bound"] == pytest.approx(4.0)


@pytest.mark.parametrize(
    "words", [("info",), *(pytest.param(w, marks=pytest.mark.slow) for w in (("bound", "--bound-time", "2"), ("explain",)))]
)
def test_every_command_takes_its_file(cover: Path, words: tuple[str, ...]) -> None:
    made = command(words[0], cover, *words[1:])
    assert made.returncode == 0, made.stderr
    assert "vertex-cover" in made.stdout


@pytest.mark.slow
def test_it_is_listed_and_exported(cover: Path, tmp_path: Path) -> None:
    assert "edge-payments" in command("heuristics").stdout
    model = tmp_path / "model.lp"
    assert command("export", cover, "--to", model).returncode == 0
    assert "edge(1)" in model.read_text() or "edge" in model.read_text()


SCRIPT = """
import json, sys
import waybound as wb
problem = wb.read(sys.argv[1])
told = {}
for row in wb.solvers(problem):
    if row.installed and not row.missing:
        found = wb.solve(problem, row.name, time_limit=20, bound_time=0, isolate=row.name == "highs")
        told[row.name] = [found.status, found.objective, sorted(found.answer), found.certificate.feasible]
print(json.dumps(told))
"""


@pytest.mark.slow
def test_every_backend_for_integer_programs_solves_it(cover: Path) -> None:
    made = run("-W", "ignore", "-c", SCRIPT, cover)
    assert made.returncode == 0, made.stderr
    told = json.loads(made.stdout)
    assert {"highs", "pulp", "cpsat", "mathopt", "cvxpy"} <= set(told)
    assert all(found == ["optimal", 4.0, [1, 2], True] for found in told.values()), told


@pytest.mark.slow
def test_bad_lines_are_refused_in_one(tmp_path: Path) -> None:
    path = tmp_path / "bad.cover"
    path.write_text(TEXT + "edge a x\n")
    made = command("solve", path)
    assert made.returncode == 2
    assert "bad.cover:10: no vertex and no edge" in made.stderr
    assert len(made.stderr.strip().splitlines()) <= 2


def test_it_is_small_and_unknown_to_waybound() -> None:
    assert len((HERE / "vertex_cover.py").read_text().splitlines()) < 300
    floors = ("instances", "formulations", "solvers", "heuristics", "reports", "waybound")
    text = "".join(path.read_text() for floor in floors for path in (ROOT / floor).rglob("*.py"))
    assert "vertex-cover" not in text
    assert "vertex_cover" not in text
