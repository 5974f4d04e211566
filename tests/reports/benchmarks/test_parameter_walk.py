from pathlib import Path

import pytest

from waybound.reports.benchmarks.parameter_walk import figures, main, stays

MODULES = {
    "formulations/problem.py": """
        class Problem:
            def features(self) -> set[str]:
                return {self.name}

            def size(self) -> int:
                return width(3)

        def width(number: int) -> int:
            return number
        """,
    "solvers/backend.py": """
        from typing import Annotated, Any, Literal
        from ..formulations.problem import Problem

        NAMES: Annotated["set[str]", "names of features"] = set()
        WAYS: Literal["in any", "in order"] = "in any"

        class Backend:
            def missing(self, problem: "Problem") -> set[str]:
                return problem.features()

        def solver_named(name: str) -> Backend:
            return Backend()

        def told(text: str) -> None:
            print(text)

        def keep(work: Any) -> None:
            return None

        def run_later(work: Any) -> None:
            work()
        """,
    "solving/method.py": """
        from dataclasses import dataclass
        from ..formulations.problem import Problem
        from ..solvers.backend import solver_named

        @dataclass
        class Run:
            problem: Problem
            name: str

            @property
            def title(self) -> str:
                return self.name

            def begin(self) -> None:
                return None

        def chosen(problem: Problem, name: str) -> Run:
            backend = solver_named(name)
            if backend.missing(problem):
                return Run(problem, name)
            return Run(problem, "")
        """,
    "solving/solve.py": """
        from ..formulations.problem import Problem
        from ..solvers import backend
        from .method import chosen

        def solve(problem: Problem) -> int:
            run = chosen(problem, "one")
            backend.told(run.name)
            backend.told(run.title)
            backend.keep(run.begin)
            backend.run_later(lambda: again(run.problem))
            problem.features()
            return outcome(problem.size())

        def again(problem: Problem) -> None:
            return None

        def outcome(number: int) -> int:
            return number
        """,
}


def test_stays_rooms_and_climbs_are_those_counted_by_hand(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, text in MODULES.items():
        path = tmp_path / "tiny" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(line[8:] for line in text.splitlines()))
        for package in (path.parent, path.parent.parent):
            (package / "__init__.py").touch()
    monkeypatch.syspath_prepend(tmp_path)
    made = stays("tiny.solving.solve.solve", "tiny.formulations.problem.Problem")
    assert made == [
        ("tiny.solving.solve", ["solve"]),
        ("tiny.solving.method", ["chosen"]),
        ("tiny.solvers.backend", ["Backend.missing"]),  # solver_named takes no problem
        ("tiny.formulations.problem", ["Problem.features"]),
        ("tiny.solving.method", ["Run"]),  # once; a first climb
        ("tiny.solvers.backend", ["keep", "run_later"]),  # told takes names; these a method of the run, and what speaks of it
        ("tiny.solving.solve", ["again"]),  # a second climb
        ("tiny.formulations.problem", ["Problem.size"]),  # features was there before; width and outcome take numbers
    ]
    assert figures(made) == (8, 4, 2)


def test_the_command_tells_the_way_through_solve(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    assert main(["-v"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "solving.solve: solve" and lines[-1] == line and line.startswith(f"{len(lines) - 1} stays, ")
    assert f" counts {line}, " in (Path(__file__).parents[3] / "docs/architecture.md").read_text(encoding="utf-8")
