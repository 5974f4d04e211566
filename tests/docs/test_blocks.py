"""Every fenced block of Python and every console session on the pages runs; what a session shows is what comes out."""

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
RUNNER = Path(__file__).parent / "run_blocks.py"

FOLLOWED = set((ROOT / "docs").glob("adding-*.md"))
"""Pages that ``test_extending_pages`` follows to the letter."""

EXECUTED = {*(ROOT / "docs" / "formulations").glob("*.md"), ROOT / "docs" / "selection.md", ROOT / "docs" / "data.md"}
"""Pages of which ``test_documentation``, ``test_selection_page`` and ``test_data_page`` execute every block."""

PAGES = sorted(
    page
    for page in {ROOT / "README.md", *(ROOT / "docs").rglob("*.md")} - FOLLOWED - EXECUTED
    if re.search(r"^```(?:python|console)$", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
)
QUICK = {"faq.md", "proofs.md", "limits.md"}

PEERS = {"pyvrp": ("pyvrp",), "ortools": ("ortools",), "vroom": ("vroom",), "cvxpy-and-pulp": ("cvxpy", "pulp")}
"""Pages for those who come from a peer, and its modules, which their blocks run beside waybound."""


def marked(page: Path) -> Any:
    return page if page.name in QUICK else pytest.param(page, marks=pytest.mark.slow)


@pytest.mark.parametrize("page", [marked(page) for page in PAGES], ids=lambda page: page.stem)
def test_blocks_of_a_page_run(page: Path, tmp_path: Path) -> None:
    for module in PEERS[page.stem] if page.parent.name == "coming-from" else ():
        pytest.importorskip(module, reason=f"{module} is not installed, whose model the page runs beside waybound's")
    env = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(RUNNER.parent)]), "MPLBACKEND": "agg"}
    ended = subprocess.run([sys.executable, str(RUNNER), str(page)], cwd=tmp_path, env=env, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stdout + ended.stderr


def test_pages_that_begin_with_an_example_are_among_them() -> None:
    assert {"README.md", "quick-start.md", "how-to.md", "faq.md"} <= {page.name for page in PAGES}


@pytest.mark.parametrize("page", [page for page in PAGES if page.parent.name == "coming-from"], ids=lambda page: page.stem)
def test_pages_for_users_of_peers_run_both_and_show_equal_objectives(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert all(re.search(rf"^(import|from) {module}\b", text, flags=re.MULTILINE) for module in (*PEERS[page.stem], "waybound"))
    shown = re.search(r"^>>> [^\n]*proved\.objective$|^>>> [^\n]*solution\.objective$", text, flags=re.MULTILINE)
    assert shown is not None, "the values of both sides stand in one line, and the tests run it"
    values = text[shown.end() :].splitlines()[1]
    assert len({float(value) for value in re.findall(r"\d+(?:\.\d+)?", values)} - {0.0, 6.0}) == 1


def test_no_block_is_left_out() -> None:
    """Blocks are Python, console sessions, or say that they are something that is not run."""
    known = {"python", "console", "text", "toml", "json", "csv", "bibtex", ""}
    for page in PAGES:
        opened = re.findall(r"^```(\w*)", page.read_text(encoding="utf-8"), flags=re.MULTILINE)[::2]
        assert set(opened) <= known, page
