import importlib.util
from fractions import Fraction
from pathlib import Path

from waybound.reports.battery.truth import Truth
from waybound.reports.benchmarks import highs_versions as benchmark
from waybound.solvers.backend import solver_named

HERE = Path(str(importlib.util.find_spec("highspy").origin)).parents[1]


def test_the_bare_library_of_a_folder_reads_what_was_written(tmp_path):
    file = tmp_path / "programs.npz"
    true = benchmark.written("two-index-load-flow", 6, 3, file)
    version, told = benchmark.said(HERE, file, {"presolve": "off"})
    assert version == solver_named("highs").version()
    assert len(told) == 6
    assert benchmark.wrong(true, told) == (0, 0)


def test_what_is_wrong_is_counted():
    ten, none, seven = Truth("optimal", Fraction(10)), Truth("infeasible"), Truth("optimal", Fraction(7))
    told = [("Infeasible", 0.0), ("Optimal", 10.1), ("Optimal", 3.0), ("Infeasible", 0.0), ("Optimal", 7.0)]
    assert benchmark.wrong([ten, ten, none, none, seven], told) == (1, 2)


def test_a_version_that_cannot_be_had_is_said_and_costs_nothing(monkeypatch, capsys):
    def refused(version, folder):
        raise benchmark.WayboundError(f"highspy {version} cannot be installed: a test")

    monkeypatch.setattr(benchmark, "installed", refused)
    assert benchmark.main(["--count", "2", "--versions", "0.0"]) == 0
    assert "| 0.0 | highspy 0.0 cannot be installed: a test |" in capsys.readouterr().out
