"""The site: pages that are made hold what is registered, notebooks have a title and a place, and all of it builds without a warning."""

import ast
import os
import re
import subprocess
import sys
from pathlib import Path

import api_pages
import command_line_page
import formats_page
import guarantees_page
import pytest
import variants_page
from markdown_tables import markdown_table, plain
from typer.testing import CliRunner

import waybound as wb
from waybound.cli.app import app
from waybound.heuristics.heuristic import HEURISTICS
from waybound.instances.formats import FORMATS
from waybound.instances.generators import GENERATORS
from waybound.solvers.backend import BACKENDS

ROOT = Path(__file__).resolve().parents[2]
NAVIGATION = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
NOTEBOOKS = sorted((ROOT / "reports" / "notebooks").glob("*.py"))


def cells(page: str) -> list[list[str]]:
    return [[c.strip() for c in re.split(r"(?<!\\)\|", line)[1:-1]] for line in page.splitlines() if line.startswith("| ")]


def test_cells_of_tables_keep_their_places() -> None:
    table = markdown_table(("a", "b|c"), [("1|2", "x\ny"), (plain("<b> *s* [l](u) `c`"), "")])
    assert cells(table) == [["a", "b\\|c"], ["---", "---"], ["1\\|2", "x y"], ["&lt;b> \\*s\\* \\[l\\](u) \\`c\\`", ""]]


def test_every_command_and_option_is_told() -> None:
    page, runner = command_line_page.page(), CliRunner(env={"COLUMNS": "200"})
    for command in (
        "solve",
        "check",
        "bound",
        "explain",
        "info",
        "export",
        "convert",
        "generate",
        "solvers",
        "heuristics",
        "ratio",
        "report",
        "run",
    ):
        assert f"## waybound {command}\n" in page
        asked = runner.invoke(app, [command, "--help"])
        section = page.split(f"## waybound {command}\n")[1].split("\n## ")[0]
        options = set(re.findall(r"(?<![\w-])--[a-z][a-z-]+", asked.stdout)) - {"--help"}
        assert options
        assert not [option for option in options if option not in section]


def test_every_heuristic_stands_beside_its_guarantee() -> None:
    told = {(row[0], row[2]) for row in cells(guarantees_page.page())}
    assert not [h.name for h in HEURISTICS.values() if (f"`{h.name}`", plain(h.stated).replace("|", "\\|")) not in told]


def test_every_format_and_generator_is_told() -> None:
    page = formats_page.page()
    assert {f"`{name}`" for name in (*FORMATS, *GENERATORS)} <= {row[0] for row in cells(page)}


@pytest.mark.slow
def test_every_solver_takes_some_variant_and_every_cell_is_the_tables_own_word() -> None:
    rows = cells(variants_page.page())
    told = " ".join(row[1] for row in rows)
    only_programs = {"outer-approximation", "cvxpy", "exact-joint"}
    assert {name for name in BACKENDS if f"`{name}`" not in told} <= only_programs
    problem = variants_page.ROUTING["skills"]()
    (row,) = [row for row in rows if row[0] == "skills"]
    assert row[1] == ", ".join(f"`{info.name}`" for info in wb.solvers(problem) if not info.missing)


def test_every_public_name_has_its_place_in_the_reference() -> None:
    told = [name for page in api_pages.pages().values() for name in re.findall(r"^ +heading: (\w+)$", page, flags=re.MULTILINE)]
    assert sorted(told) == sorted(set(wb.__all__) - {"__version__"})


@pytest.mark.parametrize("script", NOTEBOOKS, ids=lambda script: script.stem)
def test_a_notebook_is_a_script_with_a_title_and_a_place_in_the_navigation(script: Path) -> None:
    text = script.read_text(encoding="utf-8")
    ast.parse(text)
    assert re.match(r"# %% \[markdown\]\n# # \S", text)
    assert f": notebooks/{script.stem}.md\n" in NAVIGATION
    for page in re.findall(r"\]\(\.\./([\w/-]+\.md)", text):
        assert (ROOT / "docs" / page).is_file()


def first_cells() -> tuple[str, str]:
    """Of the notebook on one's own data: what makes up the frame, and from ``import waybound`` to the picture."""
    text = (ROOT / "reports" / "notebooks" / "own_data.py").read_text(encoding="utf-8")
    frame, _, rest = text.partition("import waybound as wb")
    return frame, "import waybound as wb" + rest.split("# %%")[0]


def test_from_the_import_to_a_picture_of_fifty_sites_are_six_lines() -> None:
    _, cell = first_cells()
    assert len([line for line in cell.splitlines() if line.strip()]) <= 6
    assert "solution.plot()" in cell


@pytest.mark.slow
def test_from_the_import_to_a_picture_of_fifty_sites_are_five_seconds_of_compute() -> None:
    frame, cell = first_cells()
    timed = f"{frame}\nimport time\nbegun = time.process_time()\n{cell}\nprint(len(orders) - 1, time.process_time() - begun)"
    ended = subprocess.run([sys.executable, "-c", timed], capture_output=True, text=True, env={**os.environ, "MPLBACKEND": "agg"})
    sites, seconds = ended.stdout.split()
    assert int(sites) == 50
    assert float(seconds) < 5


@pytest.mark.slow
def test_the_site_builds_without_a_warning_and_fetches_nothing(tmp_path: Path) -> None:
    """With the notebooks as they are written; ``make docs`` executes them."""
    pytest.importorskip("mkdocs", reason="needs the extra docs")
    env = {**os.environ, "NO_MKDOCS_2_WARNING": "1", "WAYBOUND_EXECUTE_NOTEBOOKS": "false", "PYTHONPATH": str(ROOT)}
    words = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(tmp_path)]
    ended = subprocess.run(words, cwd=ROOT, env=env, capture_output=True, text=True)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "", "")
    pages = list(tmp_path.rglob("index.html"))
    assert len(pages) > 50 and tmp_path / "index.html" in pages
    outside = r"""=["']?(?:https?:)?//"""
    fetched = re.compile(rf"""<(?:script|img|iframe)[^>]*\ssrc{outside}|<link[^>]*rel=["']?stylesheet[^>]*href{outside}""")
    assert not [page for page in pages if fetched.search(page.read_text(encoding="utf-8"))]
    assert not (tmp_path / "building").exists()


def test_names_in_code_are_not_broken_and_longer_code_may_be() -> None:
    pytest.importorskip("mkdocs", reason="needs the extra docs")
    import site_hooks

    told = site_hooks.on_page_content("<code>--time-limit</code> <code>waybound solve</code> <code>" + "x" * 40 + "</code>")
    assert told.count('<code class="name">') == 1 and '<code class="name">--time-limit' in told
