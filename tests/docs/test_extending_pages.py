"""The pages for those who extend are followed to the letter, from outside the tree, and show what comes out."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import waybound.extending
from waybound.instances.registry import Registry

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted((ROOT / "docs").glob("adding-*.md"))
OVERVIEW = (ROOT / "docs" / "extending.md").read_text(encoding="utf-8")
REGISTRIES = {name: entry for name, entry in vars(waybound.extending).items() if isinstance(entry, Registry)}


def follow(page: Path, folder: Path) -> dict[str, str]:
    """Does what a page says within ``folder``; returns the environment in which its package is installed."""
    site = folder / "site"
    site.mkdir()
    env = {**os.environ, "PYTHONPATH": os.pathsep.join([str(site), str(ROOT)])}
    words = [sys.executable, str(Path(__file__).parent / "run_page.py"), str(page), str(site)]
    ended = subprocess.run(words, cwd=folder, env=env, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return env


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_does_what_it_shows(page: Path, tmp_path: Path) -> None:
    follow(page, tmp_path)
    assert list(tmp_path.glob("site/*.dist-info"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_imports_nothing_else_of_waybound(page: Path) -> None:
    imported = re.findall(r"^(?:from|>>> from|import|>>> import) (waybound[\w.]*)", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert "waybound.extending" in imported
    assert set(imported) <= {"waybound.extending", "waybound"}


def test_every_name_that_is_exported_has_its_line() -> None:
    listed = [name for cell in re.findall(r"^\| (`\w+`(?:, `\w+`)*) \|", OVERVIEW, flags=re.MULTILINE) for name in re.findall(r"\w+", cell)]
    assert sorted(listed) == sorted(waybound.extending.__all__)


def test_every_group_of_entry_points_has_its_line() -> None:
    listed = re.findall(r"^\| `(waybound\.\w+)` \| `(\w+)` \|", OVERVIEW, flags=re.MULTILINE)
    assert sorted(listed) == sorted((registry.group, name) for name, registry in REGISTRIES.items())


@pytest.mark.slow
def test_the_solver_of_its_page_passes_the_conformance_suite(tmp_path: Path) -> None:
    env = follow(ROOT / "docs" / "adding-a-solver.md", tmp_path)
    words = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests/conformance/test_programs.py", "-k", "scipy"]
    ended = subprocess.run(words, cwd=ROOT, env=env, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stdout
    assert int(re.findall(r"(\d+) passed", ended.stdout)[0]) > 10
