"""The wheel holds what the tree holds: directly built, and built through the source distribution."""

import json
import subprocess
import sys
import sysconfig
import tomllib
import zipfile
from pathlib import Path

import pytest

import waybound as wb

ROOT = Path(__file__).resolve().parent.parent
FLOORS = ("formulations", "heuristics", "instances", "reports", "solvers")


BENCHMARKS = "waybound.reports.benchmarks"
"""Commands of a checkout, which are no part of the wheel: they compare with the truths and the peers that the tests have."""


def packages_in_tree() -> set[str]:
    """Names of all packages that users install."""
    found = {"waybound"}
    for top in (*FLOORS, "waybound/cli", "waybound/solving"):
        for init in (ROOT / top).rglob("__init__.py"):
            relative = init.parent.relative_to(ROOT).as_posix()
            found.add("waybound." + relative.removeprefix("waybound/").replace("/", "."))
    return found - {BENCHMARKS}


def test_pyproject_finds_every_package_and_nothing_else() -> None:
    with (ROOT / "pyproject.toml").open("rb") as file:
        settings = tomllib.load(file)["tool"]["setuptools"]["packages"]["find"]
    assert settings.pop("namespaces") is False
    setuptools = pytest.importorskip("setuptools", reason="what builds the package has it")
    assert sorted(setuptools.find_packages(str(ROOT), **settings)) == sorted(packages_in_tree())


@pytest.mark.parametrize("folder", FLOORS)
def test_a_floor_cannot_be_imported_by_its_bare_name(folder: str) -> None:
    run = subprocess.run([sys.executable, "-c", f"import {folder}"], cwd=ROOT, capture_output=True, text=True)
    assert run.returncode != 0
    assert "relative import" in run.stderr


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A clone of the tree."""
    subprocess.run(["git", "clone", "--quiet", "--no-hardlinks", str(ROOT), str(tmp_path / "checkout")], check=True, capture_output=True)
    return tmp_path / "checkout"


SCRIPT = """
from pathlib import Path
import numpy as np
import pandas as pd
import waybound as wb

xy = np.array([(0.0, 0.0), (3.0, 0.0), (3.0, 4.0)])
sites = wb.Sites.of(["o", "a", "b"], demand=[0, 1, 1], due=99, coordinates=xy)
travel = wb.Travel("euclidean", xy)
small, large = wb.VehicleType(1, capacity=2), wb.VehicleType(energy=wb.Energy(9), name="large")
wb.RoutingInstance("name", "csv", sites, travel, [small, large])
wb.RoutingProblem(sites, travel, (small, large), wb.Vehicles().then(wb.TotalCost()), min_vehicles=1, name="n", problem="cvrp")
wb.RoutingProblem(sites, travel, [small], objective=2 * wb.TotalCost() + 3 * wb.Vehicles())
problem = wb.RoutingProblem(sites, travel, [wb.VehicleType(1)], objective=wb.TotalCost() - wb.Reward())
solution = wb.solve(problem, heuristic="savings", start=[["a", "b"]])
frame: pd.DataFrame = solution.to_frame()
wb.solve(problem.compile("three-index", relax=True), "highs", time_limit=1)
wb.check(problem, wb.Routes.of([wb.Route((1, 2), vehicle=0), [1, 2]]), Path("certificate.json"))
reveal_type(wb.solve)
problem.colour
"""


EVERY_NAME = "import waybound as wb\n" + "".join(f"reveal_type(wb.{name})\n" for name in wb.__all__)
"""A file of a user that names all that is public, one a line."""


@pytest.fixture
def installed(tmp_path: Path, checkout: Path, request: pytest.FixtureRequest) -> Path:
    """The Python of an environment in which the package alone is installed, and its dependencies are found."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", "env"], cwd=tmp_path, check=True)
    python = tmp_path / "env" / "bin" / "python"
    install = [sys.executable, "-m", "pip", "--python", str(python), "install", "--no-deps", *request.param, str(checkout)]
    subprocess.run(install, check=True, capture_output=True)
    (library,) = (tmp_path / "env").glob("lib/*/site-packages")
    (library / "dependencies.pth").write_text(sysconfig.get_path("purelib") + "\n")
    (tmp_path / "script.py").write_text(SCRIPT)
    (tmp_path / "names.py").write_text(EVERY_NAME)
    return python


def check_with(words: list[str], folder: Path) -> str:
    return subprocess.run([sys.executable, "-m", *words], cwd=folder, capture_output=True, text=True).stdout


@pytest.mark.packaging
@pytest.mark.parametrize("installed", [[], ["--editable"]], ids=["wheel", "editable"], indirect=True)
def test_mypy_checks_a_users_script_against_an_installed_package(tmp_path: Path, installed: Path) -> None:
    mypy = ["mypy", "--strict", "--python-executable", str(installed), "--cache-dir", str(tmp_path / "cache")]
    *told, count = check_with([*mypy, "script.py"], tmp_path).splitlines()
    assert [line for line in told if "error" in line] == ['script.py:20: error: "RoutingProblem" has no attribute "colour"  [attr-defined]']
    assert any(
        "Revealed type" in line and "RoutingProblem" not in line and "waybound.formulations.solution.Solution" in line for line in told
    )
    assert count.startswith("Found 1 error in 1 file")
    names = check_with([*mypy, "names.py"], tmp_path)
    assert names.count("Revealed type") == len(wb.__all__)
    assert 'Revealed type is "Any"' not in names
    assert ": error: " not in names


@pytest.mark.packaging
@pytest.mark.parametrize("installed", [[], ["--editable"]], ids=["wheel", "editable"], indirect=True)
def test_pyright_checks_a_users_script_against_an_installed_package(tmp_path: Path, installed: Path) -> None:
    told = json.loads(check_with(["pyright", "--outputjson", "--pythonpath", str(installed), "script.py", "names.py"], tmp_path))
    faults = [d for d in told["generalDiagnostics"] if d["severity"] == "error"]
    assert [(Path(d["file"]).name, d["range"]["start"]["line"] + 1) for d in faults] == [("script.py", 20)], faults
    assert 'attribute "colour"' in faults[0]["message"]
    revealed = [d["message"] for d in told["generalDiagnostics"] if d["severity"] == "information" and Path(d["file"]).name == "names.py"]
    assert len(revealed) == len(wb.__all__)
    assert not [message for message in revealed if message.endswith(('is "Any"', 'is "Unknown"'))]


@pytest.mark.packaging
def test_wheel_from_tree_and_from_sdist_hold_the_same_files(tmp_path: Path, checkout: Path) -> None:
    def pip(*arguments: str, cwd: Path) -> None:
        subprocess.run([sys.executable, "-m", "pip", *arguments], cwd=cwd, check=True, capture_output=True)

    pip("wheel", "--no-deps", "--wheel-dir", str(tmp_path / "direct"), ".", cwd=checkout)
    subprocess.run(
        [sys.executable, "-m", "build", "--sdist", "--outdir", str(tmp_path / "sdist"), "."], cwd=checkout, check=True, capture_output=True
    )
    (archive,) = (tmp_path / "sdist").glob("*.tar.gz")
    subprocess.run([sys.executable, "-m", "tarfile", "-e", str(archive), str(tmp_path / "unpacked")], check=True, capture_output=True)
    (unpacked,) = (tmp_path / "unpacked").iterdir()
    pip("wheel", "--no-deps", "--wheel-dir", str(tmp_path / "indirect"), ".", cwd=unpacked)

    def files(folder: Path) -> set[str]:
        (wheel,) = folder.glob("*.whl")
        with zipfile.ZipFile(wheel) as archive:
            return set(archive.namelist())

    direct, indirect = files(tmp_path / "direct"), files(tmp_path / "indirect")
    assert direct == indirect
    assert "waybound/py.typed" in direct
    for package in packages_in_tree():
        assert package.replace(".", "/") + "/__init__.py" in direct
    for folder in ("assets", "templates"):
        held = {f"waybound/reports/pages/{folder}/{file.name}" for file in (ROOT / "reports/pages" / folder).iterdir()}
        assert held and held <= direct
    assert not [name for name in direct if name.startswith(BENCHMARKS.replace(".", "/"))]
