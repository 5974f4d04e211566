"""The wheel holds what the tree holds: directly built, and built through the source distribution."""

from __future__ import annotations

import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
FLOORS = ("formulations", "heuristics", "instances", "reports", "solvers")


def packages_in_tree() -> set[str]:
    found = {"waybound"}
    for top in (*FLOORS, "waybound/cli", "waybound/solving"):
        for init in (ROOT / top).rglob("__init__.py"):
            relative = init.parent.relative_to(ROOT).as_posix()
            found.add("waybound." + relative.removeprefix("waybound/").replace("/", "."))
    return found


def test_pyproject_lists_every_package() -> None:
    with (ROOT / "pyproject.toml").open("rb") as file:
        listed = tomllib.load(file)["tool"]["setuptools"]["packages"]
    assert sorted(listed) == sorted(packages_in_tree())


@pytest.mark.parametrize("folder", FLOORS)
def test_a_floor_cannot_be_imported_by_its_bare_name(folder: str) -> None:
    run = subprocess.run([sys.executable, "-c", f"import {folder}"], cwd=ROOT, capture_output=True, text=True)
    assert run.returncode != 0
    assert "relative import" in run.stderr


@pytest.mark.packaging
def test_wheel_from_tree_and_from_sdist_hold_the_same_files(tmp_path: Path) -> None:
    def pip(*arguments: str, cwd: Path) -> None:
        subprocess.run([sys.executable, "-m", "pip", *arguments], cwd=cwd, check=True, capture_output=True)

    checkout = tmp_path / "checkout"
    subprocess.run(["git", "clone", "--quiet", "--no-hardlinks", str(ROOT), str(checkout)], check=True, capture_output=True)
    pip("wheel", "--no-deps", "--wheel-dir", str(tmp_path / "direct"), ".", cwd=checkout)
    subprocess.run(
        [sys.executable, "-m", "build", "--sdist", "--outdir", str(tmp_path / "sdist"), "."], cwd=checkout, check=True, capture_output=True
    )
    (archive,) = (tmp_path / "sdist").glob("*.tar.gz")
    with tarfile.open(archive) as tar:
        tar.extractall(tmp_path / "unpacked", filter="data")
    (unpacked,) = (tmp_path / "unpacked").iterdir()
    pip("wheel", "--no-deps", "--wheel-dir", str(tmp_path / "indirect"), ".", cwd=unpacked)

    def files(folder: Path) -> set[str]:
        (wheel,) = folder.glob("*.whl")
        with zipfile.ZipFile(wheel) as archive:
            return set(archive.namelist())

    direct, indirect = files(tmp_path / "direct"), files(tmp_path / "indirect")
    assert direct == indirect
    for package in packages_in_tree():
        assert package.replace(".", "/") + "/__init__.py" in direct
