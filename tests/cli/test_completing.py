"""What the shell offers: names of what is registered, bundled instances and files, without loading any solver's package."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from waybound.cli import completing
from waybound.cli.app import app
from waybound.formulations.forms import FORMS
from waybound.formulations.problem import PROBLEMS
from waybound.heuristics.heuristic import HEURISTICS
from waybound.instances.bundled import bundled_names
from waybound.instances.formats import FORMATS
from waybound.instances.generators import GENERATORS
from waybound.reports.missions.mission import MISSIONS
from waybound.reports.studies.study import STUDIES
from waybound.solvers.backend import BACKENDS


def offered(*words: str) -> list[str]:
    """What bash is told after these words, the last one being begun."""
    env = {"_WAYBOUND_COMPLETE": "complete_bash", "COMP_WORDS": " ".join(("waybound", *words)), "COMP_CWORD": str(len(words))}
    return CliRunner(env=env).invoke(app, [], prog_name="waybound").stdout.split()


CASES: list[tuple[tuple[str, ...], Callable[[], list[str]]]] = [
    (("solve", "x", "--solver"), BACKENDS.names),
    (("compare", "x", "--solver"), BACKENDS.names),
    (("run", "tracking", "--solver"), BACKENDS.names),
    (("bound", "x", "--lp-solver"), BACKENDS.names),
    (("solve", "x", "--heuristic"), HEURISTICS.names),
    (("compare", "x", "--heuristic"), HEURISTICS.names),
    (("solve", "x", "--form"), FORMS.names),
    (("explain", "x", "--form"), FORMS.names),
    (("export", "x", "--form"), FORMS.names),
    (("info", "x", "--problem"), PROBLEMS.names),
    (("info", "x", "--format"), FORMATS.names),
    (("convert", "x", "--to-format"), FORMATS.names),
    (("solve", "x", "--convention"), lambda: ["file", "exact", "trunc1", "trunc2", "round", "ceil", "dimacs"]),
    (("generate",), GENERATORS.names),
    (("run",), MISSIONS.names),
    (("ratio",), STUDIES.names),
    (("instances", "show"), bundled_names),
]


@pytest.mark.parametrize(("words", "known"), CASES, ids=[" ".join(words) for words, _ in CASES])
def test_names_are_offered_and_those_that_begin_so(words: tuple[str, ...], known: Callable[[], list[str]]) -> None:
    assert sorted(offered(*words, "")) == sorted(known())
    start = known()[-1][:2]
    assert sorted(offered(*words, start)) == sorted(name for name in known() if name.startswith(start))
    assert offered(*words, "zzz") == []


def test_instances_and_campaigns_are_bundled_ones_and_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "demo").mkdir()
    (tmp_path / "demo" / "one.vrp").touch()
    (tmp_path / "demo" / "two.vrp").touch()
    (tmp_path / ".hidden").touch()
    monkeypatch.chdir(tmp_path)
    assert offered("solve", "") == [*bundled_names(), "demo/one.vrp", "demo/two.vrp"]
    assert offered("info", "demo-c") == ["demo-c25"]
    assert offered("solvers", "demo/o") == ["demo/one.vrp"]
    assert completing.files("nowhere/") == completing.files("\0/x") == []
    assert completing.files(f"{tmp_path}/.h") == [f"{tmp_path}/.hidden"]
    assert offered("bench", "demo-") == ["demo-campaign"]


def test_no_heavy_package_is_loaded_for_it() -> None:
    heavy = {"scipy", "pandas", "numba", "matplotlib", "networkx", "highspy", "ortools", "pyvrp", "vroom", "cvxpy", "pulp", "pyscipopt"}
    offers = "from waybound.cli import app, completing\nfor what in completing.PLACES: assert completing.names(what)(''), what"
    asked = f"import sys\n{offers}\nprint({heavy} & set(sys.modules))"
    assert subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True).stdout == "set()\n"
