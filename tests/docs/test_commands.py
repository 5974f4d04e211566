"""Every command line on the pages and in docstrings is one that the program takes: its options, the names it gives, the values it sets.

Blocks that show what comes out are run by ``test_blocks``; here nothing is solved.
"""

import ast
import re
import shlex
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import typer

from waybound.cli.app import app
from waybound.cli.options import Source, parse_pairs
from waybound.formulations.forms import FORMS
from waybound.formulations.problem import PROBLEMS, Problem
from waybound.heuristics.heuristic import HEURISTICS
from waybound.instances.bundled import bundled_names
from waybound.instances.errors import UsageError, WayboundError
from waybound.instances.formats import FORMATS
from waybound.instances.generators import GENERATORS
from waybound.instances.worlds import setting_values
from waybound.reports.missions.mission import MISSIONS
from waybound.reports.studies.study import STUDIES
from waybound.solvers.backend import BACKENDS
from waybound.solving.method import missing_features

ROOT = Path(__file__).resolve().parents[2]
FLOORS = ("instances", "formulations", "solvers", "heuristics", "reports", "waybound/cli", "waybound/solving")

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
FOLLOWED = {page for page in PAGES if page.stem.startswith("adding-")}
"""Pages that ``test_extending_pages`` follows to the letter: they name what the reader has just added."""

WORDS = re.compile(r"`{1,2}(\$? ?(?:waybound |--)[^`]*)`|^(?:\$ |    )?(waybound [a-z].*)$", re.MULTILINE)
PLACEHOLDER = re.compile(r"[A-Z]{2,}|\.\.\.|[|\[\]]")

SAMPLES = [
    ("random", "customers=4 deviation=0.3 max-duration=900"), ("random", "customers=4"), ("robot-tasks", ""),
    ("assignment", "costs=orchard robots=4 bins=4"), ("risk-allocation", ""), ("uncertain-graph", ""),
]  # fmt: skip
"""Recipes whose problems a fragment such as ``--set capacity=9``, which names no file, may be meant for."""


OF_LIBRARIES = {"presolve_rule_off", "preprocess"}
"""Options of HiGHS and CBC, which check them themselves."""


def lines(text: str) -> Iterator[str]:
    """Commands, and fragments of them that begin with an option."""
    for found in WORDS.finditer(text):
        line = " ".join((found[1] or found[2]).removeprefix("$").split())
        if not line.startswith("waybound ") or line.split()[1] in COMMANDS:
            yield line


COMMANDS: dict[str, Any] = dict(typer.main.get_command(app).commands)  # type: ignore[attr-defined]

PAGE_LINES = [(page, line) for page in PAGES if page not in FOLLOWED for line in dict.fromkeys(lines(page.read_text(encoding="utf-8")))]
MODULE_LINES = [
    (path, line)
    for floor in FLOORS
    for path in sorted((ROOT / floor).rglob("*.py"))
    for line in dict.fromkeys(re.findall(r"``(waybound [a-z]+[^`]*)``", path.read_text(encoding="utf-8")))
    if re.fullmatch(r"waybound [a-z]+( .*)?", line)
]


@cache
def known_options() -> frozenset[str]:
    """Options of all commands, and of the measurements that pages tell how to repeat."""
    own = {name for made in COMMANDS.values() for option in made.params for name in option.opts}
    for path in (ROOT / "reports").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        own |= set(re.findall(r"add_argument\(\s*\"(--[\w-]+)\"", text))
        if "@command\ndef main(" in text:  # of a benchmark: its parameters are its options
            (main,) = (node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef) and node.name == "main")
            own |= {f"--{argument.arg.replace('_', '-')}" for argument in main.args.args}
    return frozenset(own)


NAMED = {"--heuristic": HEURISTICS, "--problem": PROBLEMS, "--form": FORMS, "--format": FORMATS, "--to-format": FORMATS}


def values(words: list[str], option: str) -> list[str]:
    return [words[k + 1] for k, word in enumerate(words[:-1]) if word == option and not PLACEHOLDER.search(words[k + 1])]


def check_names(words: list[str]) -> None:
    """Names of what is registered; options of solvers and heuristics are theirs."""
    for option, registry in NAMED.items():
        for name in values(words, option):
            registry[name]
    for name in values(words, "--solver"):
        BACKENDS[name.partition(":")[0]]
    given = parse_pairs(values(words, "--option"), "--option")
    heuristics = [HEURISTICS[name] for name in values(words, "--heuristic")]
    if given and "--solver" not in words and "--examine" not in words:
        takers = [one for one in heuristics or list(HEURISTICS.values()) if accepted(one, given)]
        solvers = [] if heuristics else [one for one in BACKENDS.values() if one.options is not None and given.keys() <= one.options.keys()]
        assert takers or solvers or given.keys() <= OF_LIBRARIES, f"nothing takes {given}"


def accepted(heuristic: Any, given: dict[str, Any]) -> bool:
    try:
        heuristic.check_parameters(given)
    except UsageError:
        return False
    return True


@cache
def generated(folder: Path, kind: str, settings: str) -> str:
    from waybound.instances.generating import generate
    from waybound.instances.writing import write_instance

    path = folder / f"{kind}-{abs(hash(settings))}.json"
    write_instance(generate(kind, 1, **parse_pairs(settings.split(), "--set")), path, None)
    return str(path)


def check_settings(words: list[str], folder: Path) -> None:
    """Settings of a problem, in a fragment that names no file: some problem of the recipes takes them all, or some format."""
    settings = values(words, "--set")
    if not settings and "--objective" not in words:
        return
    problem = next(iter(values(words, "--problem")), None)
    objective = next(iter(values(words, "--objective")), None)
    faults = []
    for kind, recipe in SAMPLES:
        try:
            Source(generated(folder, kind, recipe), None, problem, None, settings, objective).read()
            return
        except WayboundError as fault:
            faults.append(f"{kind}: {fault}")
    if "--objective" not in words and any(set(parse_pairs(settings, "--set")) <= set(FORMATS[name].settings) for name in FORMATS):
        return
    for played in MISSIONS.values():
        try:
            setting_values("mission", played().settings, parse_pairs(settings, "--set"))
            return
        except WayboundError as fault:
            faults.append(str(fault))
    raise AssertionError("\n".join(faults))


def check_command(words: list[str], folder: Path, made: dict[str, str]) -> None:
    """A whole command: parsed as the program parses it, and what it would read is read."""
    name, rest = words[0], words[1:]
    if PLACEHOLDER.search(" ".join(words)) or name == "instances":
        assert {word.strip("[]") for word in rest if word.strip("[").startswith("--")} <= known_options()
        return
    if not rest or "--help" in rest:
        return
    if name == "generate" and "--out" not in rest:
        rest += ["--out", "any.json"]
    with COMMANDS[name].make_context(name, list(rest)) as context:
        given = context.params
    if name == "generate":
        recipe = GENERATORS[given["kind"]]
        settings = parse_pairs(given["settings"], "--set")
        recipe.values(settings)
        made[str(given["out"])] = f"{given['kind']}|{' '.join(given['settings'] or [])}"
    elif name == "run":
        played = MISSIONS[given["mission"]]()
        setting_values(given["mission"], played.settings, parse_pairs(given["settings"], "--set"))
        assert given["policy"] is None or given["policy"] in played.policies()
    elif name in ("ratio", "report"):
        assert given["study"] in (None, "all") or given["study"] in STUDIES
    elif given.get("file") is not None:
        file = given["file"]
        if file in made:
            kind, _, settings = made[file].partition("|")
            file = generated(folder, kind, settings)
        if file in bundled_names() or file.startswith(str(folder)):
            problem = Source(file, None, *(given.get(key) for key in ("problem", "convention", "settings", "objective"))).read()
            check_takers(words, problem)


def check_takers(words: list[str], problem: Problem) -> None:
    for name in values(words, "--heuristic"):
        assert not HEURISTICS[name].missing(problem), name
    for name in values(words, "--solver"):
        assert not missing_features(name, problem)[0], name


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("commands")


def checked(line: str, folder: Path, made: dict[str, str]) -> str | None:
    try:
        words = shlex.split(line, comments=True)
        if words[0] == "waybound":
            check_names(words[1:])
            check_command(words[1:], folder, made)
        else:
            assert {word for word in words if word.startswith("--")} <= known_options(), "no such option"
            check_names(words)
            check_settings(words, folder)
    except Exception as fault:  # of whatever kind: the line is not taken
        return f"{line}\n    {type(fault).__name__}: {fault}"
    return None


@pytest.mark.parametrize("page", sorted({page for page, _ in PAGE_LINES}), ids=lambda page: page.stem)
def test_commands_of_a_page_are_taken(page: Path, folder: Path) -> None:
    made: dict[str, str] = {}
    faults = [fault for where, line in PAGE_LINES if where == page if (fault := checked(line, folder, made))]
    assert not faults, "\n".join(faults)


def test_commands_in_docstrings_are_taken(folder: Path) -> None:
    faults = [f"{path.relative_to(ROOT)}: {fault}" for path, line in MODULE_LINES if (fault := checked(line, folder, {}))]
    assert not faults, "\n".join(faults)


def test_lines_are_found() -> None:
    assert len(PAGE_LINES) > 150 and len(MODULE_LINES) > 10


@pytest.mark.parametrize(
    "line",
    [
        "waybound solve demo-c25 --solver nobody", "waybound solve demo-c25 --fast", "waybound solve demo-c25 --set nothing=1",
        "waybound solve demo-c25 --solver lapjv", "waybound generate sata --set robbots=3 --out x.json",
        "waybound run tracking --policy nobody", "waybound ratio nothing", "waybound report nothing", "--set objective=mini-mix",
        "--option nothing=1", "--heuristic nobody", "--fast",
    ],
)  # fmt: skip
def test_wrong_lines_are_seen(line: str, folder: Path) -> None:
    assert checked(line, folder, {}) is not None
