"""What docstrings and pages refer to is there: pages, sections, and the names of everything that is registered."""

import re
import subprocess
import unicodedata
from functools import cache
from pathlib import Path

import api_pages
import pytest

from waybound.formulations.evidence import CHECKERS, ENDLESS
from waybound.formulations.forms import FORMS
from waybound.formulations.problem import PROBLEMS
from waybound.heuristics.heuristic import HEURISTICS

ROOT = Path(__file__).resolve().parents[1]
FORMULATIONS = sorted((ROOT / "docs" / "formulations").glob("*.md"))

DOCUMENT = re.compile(r"digest,? (?:section |case |column )?S?\d|digest's|digest of (?:Sung|Mitchell|CMU)|in the digest", re.IGNORECASE)
"""A digest that is a text, with sections; hashes have none."""


@cache
def files() -> tuple[Path, ...]:
    """Text files of the repository; all below the root where there is no git."""
    told = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False)
    listed = [ROOT / name for name in told.stdout.decode().split("\0") if name] if told.returncode == 0 else list(ROOT.rglob("*"))
    kept = {".py", ".md", ".toml", ".yml"}
    return tuple(path for path in listed if path.suffix in kept and path.is_file() and not path.is_symlink() and ".venv" not in path.parts)


@cache
def sections(page: Path) -> frozenset[str]:
    """Anchors of a page's headings, as mkdocs makes them."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    found = set()
    for heading in re.findall(r"^#+ (.+)$", text, flags=re.MULTILINE):
        plain = unicodedata.normalize("NFKD", heading).encode("ascii", "ignore").decode()
        found.add(re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", plain).strip().lower()))
    return frozenset(found)


def made(page: Path) -> bool:
    """Whether it is a page that building the site makes."""
    folder, name = page.parent.relative_to(ROOT / "docs").as_posix() if page.is_relative_to(ROOT / "docs") else "", page.stem
    makers = {"notebooks": ROOT / f"reports/notebooks/{name}.py", "generated": ROOT / f"docs/building/{name.replace('-', '_')}_page.py"}
    return makers[folder].is_file() if folder in makers else folder == "reference" and name in api_pages.GROUPS


def missing(page: Path, section: str) -> bool:
    if made(page):
        return bool(section)
    return not page.is_file() or bool(section and section not in sections(page))


def test_no_file_holds_the_marks_of_an_unfinished_merge() -> None:
    marks = tuple(mark * 7 for mark in "<=>")
    held = [path.relative_to(ROOT) for path in files() for line in path.read_text(encoding="utf-8").split("\n") if line.startswith(marks)]
    assert not held


def test_pages_and_sections_that_code_names_exist() -> None:
    named = []
    for path in files():
        text = path.read_text(encoding="utf-8")
        for page, section in re.findall(r"\b(docs/[\w/-]+\.md)(?:#([\w-]+))?", text):
            named.append((path.relative_to(ROOT), page, section))
    assert len([name for name in named if name[2] and name[0].suffix == ".py"]) > 40
    assert not [name for name in named if missing(ROOT / name[1], name[2])]


def test_modules_that_pages_and_code_name_exist() -> None:
    floors = "instances|formulations|solvers|heuristics|reports|waybound|tests|solving|checking|cli|bounds|backends|engines"
    known = ["/" + str(path.relative_to(ROOT)) for path in files()]
    missing = []
    for path in files():
        text = path.read_text(encoding="utf-8").partition("## How what comes next would enter")[0]
        for named in re.findall(rf"(?<![\w/.-])(?:{floors})/[\w/]+\.py", text):
            if not named.endswith("/x.py") and not named.endswith("/test_x.py") and not any(one.endswith("/" + named) for one in known):
                missing.append((str(path.relative_to(ROOT)), named))
    assert not missing


def test_links_between_pages_lead_somewhere() -> None:
    links = []
    for path in files():
        if path.suffix == ".md":
            for target in re.findall(r"\]\((?!https?:)([^)\s]+)\)", path.read_text(encoding="utf-8")):
                page, _, section = target.partition("#")
                links.append((path, (path.parent / page).resolve() if page else path, section))
    assert len(links) > 60
    assert not [(str(path), str(page), section) for path, page, section in links if missing(page, section)]


def test_every_page_is_in_the_navigation() -> None:
    navigation = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    assert not [page for page in (ROOT / "docs").rglob("*.md") if f": {page.relative_to(ROOT / 'docs').as_posix()}" not in navigation]


def test_no_file_cites_a_text_that_is_not_here() -> None:
    me = Path(__file__).resolve()
    cited = [
        f"{path.relative_to(ROOT)}: {found.group()}"
        for path in files()
        if path.resolve() != me
        for found in DOCUMENT.finditer(path.read_text(encoding="utf-8"))
    ]
    assert not cited


@pytest.mark.parametrize(
    "line", ["Source: digest 2.4.", "S10 of digest 4.1", "(digest of Sung 2019)", "as in the digest, section 2.7", "digest S1"]
)
def test_such_citations_are_recognised(line: str) -> None:
    assert DOCUMENT.search(line)


@pytest.mark.parametrize(
    "line", ["What the digest covers.", "its digest is its label", "problem.digest()", "names the function, for the digest of the problem"]
)
def test_hashes_are_none(line: str) -> None:
    assert not DOCUMENT.search(line)


@pytest.mark.parametrize("registry", [PROBLEMS, FORMS, CHECKERS, ENDLESS, HEURISTICS], ids=lambda registry: registry.what)
def test_the_overview_names_everything_that_is_registered(registry) -> None:
    overview = (ROOT / "docs" / "formulations" / "index.md").read_text(encoding="utf-8")
    assert not [name for name in registry if f"`{name}`" not in overview]


@pytest.mark.slow
@pytest.mark.parametrize("page", FORMULATIONS, ids=lambda page: page.stem)
def test_code_on_the_pages_runs(page: Path) -> None:
    namespace: dict[str, object] = {}
    for block in re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL):
        exec(compile(block, str(page), "exec"), namespace)
