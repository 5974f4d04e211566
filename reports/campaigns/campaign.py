"""Campaign files: which methods run on which instances, under which limits, and where the results go."""

import itertools
import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ...instances.errors import InputError, UsageError
from ...instances.limits import check_number, check_whole
from ...instances.suggestions import did_you_mean
from ...instances.text import read_text
from .best_known import Value, best_known
from .instance_list import Named, files_named, generated_instances, named_instances, with_variables
from .keys import Keys
from .own_modules import import_modules
from .setting import LIMITS, Setting, canonical

OVERTIME = 60.0
"""Seconds after all its limits after which a run is ended."""

_READING = ("problem", "convention", "format", "set")
_LIMITING = ("lp_solver", *LIMITS)
_SEARCHING = ("form", "relax", *_LIMITING)
_TOP = (
    "results", "folder", "instances", "solvers", "heuristics", "seeds", *_LIMITING, "overtime", *_READING, "options", "grid",
    "best_known", "modules",
)  # fmt: skip

Key = tuple[str, str, str, int]
"""An instance's name and hash, the hash of a setting, and a seed: what makes two runs the same."""


@dataclass(frozen=True)
class Planned:
    """One run of a campaign."""

    instance: Named
    setting: Setting
    seed: int

    @property
    def key(self) -> Key:
        return self.instance.name, self.instance.hash, self.setting.hash, self.seed


@dataclass(frozen=True)
class Campaign:
    """A campaign, as its file says it.

    Its paths are relative to ``folder``. ``runs`` are in the order of seeds, instances and methods, each once, so that every method has had
    its turn early; each has ``overtime`` seconds after all its limits before it is ended. ``best_known`` is a table of best known values;
    ``stated`` has, by hash and reading of an instance, the value that the campaign itself says, or whether that of a table holds.
    ``modules`` of its own register solvers and the like.
    """

    file: Path
    folder: Path
    results: Path
    runs: tuple[Planned, ...]
    overtime: float = OVERTIME
    best_known: Path | None = None
    stated: Mapping[tuple[str, str], float | bool] = field(default_factory=dict)
    modules: tuple[str, ...] = ()

    def best_known_values(self) -> dict[tuple[str, str], list[Value]]:
        """Best values known of its instances, by the hash of the file and how it is read.

        Those of tables are of files as they stand: where ``set`` or ``problem`` make something else of them, the campaign must say so.
        """
        tables = best_known({run.instance.hash: run.instance for run in self.runs}.values(), self.best_known)
        values: dict[tuple[str, str], list[Value]] = {}
        for run in self.runs:
            key = run.instance.hash, run.setting.reading
            holds = self.stated.get(key, not run.setting.changes and run.setting.problem is None)
            values[key] = [(None, None, float(holds))] if not isinstance(holds, bool) else tables.get(key[0], []) if holds else []
        return values


def bundled_campaigns() -> dict[str, Path]:
    """Campaign files that come with waybound, by name."""
    return {file.stem: file for file in sorted((Path(__file__).parent / "data").glob("*.toml"))}


def read_campaign(path: str | Path, folder: Path | None = None) -> Campaign:
    """The campaign that a file describes; nothing is run, and no instance is read. Those that it asks to be generated are.

    Paths are relative to ``folder``, by default that of the file. Raises InputError for a file that cannot be read, a key that does not
    exist, a value of another kind, and an instance that is not there; UsageError for a method, a limit or an option that does not exist;
    MissingPackageError for a solver that is not installed.
    """
    file = Path(path)
    folder = (file.parent if folder is None else folder).resolve()
    top = Keys(_parsed(file), file, "", _TOP)
    for key in ("results", "instances"):
        if key not in top:
            raise top.fault(f"the key {key!r} is missing", "missing")
    results, seeds = folder / with_variables(str(top.text("results")), file), top.numbers("seeds", [1])
    known, overtime = top.text("best_known"), top.table.get("overtime", OVERTIME)
    check_number("overtime", overtime, option=f"{file}: overtime")
    for seed in seeds:
        check_whole("seed", seed, option=f"{file}: a seed")
    modules = tuple(name for name in top.texts("modules") if name is not None)
    try:
        import_modules(modules, folder)
    except ImportError as fault:
        raise top.fault(f"a module cannot be imported: {fault}", "missing") from None
    methods, instances = list(_methods(top)), list(_instances(top, folder, results))
    if not methods:
        raise top.fault("names no method: solvers = [...] or heuristics = [...]", "missing")
    if not instances:
        raise top.fault("names no instance: instances = [...]", "missing")
    pairs = [(one, Setting(**reading, **method)) for one, reading, _ in instances for method in methods]
    stated = {(one.hash, Setting(method="", **reading).reading): value for one, reading, value in instances if value is not None}
    planned = (Planned(one, setting, seed) for seed in seeds for one, setting in pairs)
    runs = {run.key: run for run in planned}
    _check({run.setting.hash: run.setting for run in runs.values()}.values(), file)
    table = None if known is None else folder / with_variables(known, file)
    return Campaign(file, folder, results, tuple(runs.values()), float(overtime), table, stated, modules)


def _parsed(file: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(read_text(file))
    except tomllib.TOMLDecodeError as fault:
        place = re.search(r" \(at line (\d+), column \d+\)", str(fault))
        words = str(fault).replace(place[0], "") if place else str(fault)
        raise InputError(f"is no TOML: {words}", file=file, line=int(place[1]) if place else None) from None


def _instances(top: Keys, folder: Path, results: Path) -> Iterator[tuple[Named, dict[str, Any], float | bool | None]]:
    """Each instance with each way to read it, as parts of a ``Setting``, and what is said of its best known value."""
    for entry in top.entries("instances", "file"):
        own = Keys(entry, top.file, "an instance", ("file", "generate", "seeds", "folder", "best_known", *_READING))
        best, place = own.table.get("best_known"), own.text("folder") or top.text("folder") or "."
        if best is not None and not isinstance(best, bool | int | float):
            raise own.expected("best_known", "a value, or true or false", best)
        recipe = own.text("generate")
        if ("file" in own) == (recipe is not None):
            raise top.fault("an instance has no key 'file'" if recipe is None else "an instance has both 'file' and 'generate'", "missing")
        changes = {**top.inner("set"), **(own.inner("set") if recipe is None else {})}
        how = {"changes": changes, "files": files_named(changes, folder), "format": own.text("format") or top.text("format")}
        problems, conventions = ((own if key in own else top).texts(key) for key in ("problem", "convention"))
        looked_in = folder / with_variables(place, top.file)
        if recipe is not None:
            named = generated_instances(recipe, own.numbers("seeds", [1]), own.inner("set"), results.with_suffix(".instances"), top.file)
        else:
            paths = (with_variables(str(said), top.file) for said in own.texts("file"))
            named = [one for path in paths for one in named_instances(path, looked_in, top.file)]
        for one, problem, convention in itertools.product(named, problems, conventions):
            yield one, {**how, "problem": problem, "convention": convention}, best


def _methods(top: Keys) -> Iterator[dict[str, Any]]:
    """Each method with each combination of its options, as parts of a ``Setting``."""
    entries = [(False, entry) for entry in top.entries("solvers", "name")]
    entries += [(True, entry) for entry in top.entries("heuristics", "name")]
    names = [str(entry.get("name")) for _, entry in entries]
    for part in ("options", "grid"):
        for other in top.inner(part):
            if other not in names:
                hint = did_you_mean(other, names)
                raise top.fault(f"{part} has a table for {other!r}, which is no method of this campaign{hint}", "unknown-name")
    for heuristic, entry in entries:
        kind = "a heuristic" if heuristic else "a solver"
        own = Keys(entry, top.file, kind, ("name", "options", "grid", *(_LIMITING if heuristic else _SEARCHING)))
        name = own.text("name")
        if name is None:
            raise top.fault(f"{kind} has no key 'name'", "missing")
        limits = {key: source.table[key] for source in (top, own) for key in _LIMITING if key in source}
        options = {**Keys(top.inner("options"), top.file, "options", names).inner(name), **own.inner("options")}
        grid = {**Keys(top.inner("grid"), top.file, "grid", names).inner(name), **own.inner("grid")}
        for point in _grid(grid, name, top):
            for form in own.texts("form"):
                yield {
                    "method": name, "heuristic": heuristic, "form": form, "relax": own.truth("relax"), "options": {**options, **point},
                    **limits,
                }  # fmt: skip


def _grid(grid: dict[str, Any], name: str, top: Keys) -> Iterator[dict[str, Any]]:
    """All combinations of the values of a grid."""
    for key, values in grid.items():
        if not isinstance(values, list) or not values:
            raise top.fault(f"{key} of the grid of {name} must be a list of values", "malformed")
    for values in itertools.product(*grid.values()):
        yield dict(zip(grid, values, strict=True))


def _check(settings: Any, file: Path) -> None:
    """Raise the error of the first setting that names what does not exist; each method is asked about its own options."""
    from ...formulations.forms import FORMS
    from ...formulations.problem import PROBLEMS
    from ...heuristics.heuristic import HEURISTICS
    from ...solvers.backend import Options, solver_named
    from ...solving.request import Request

    seen: set[str] = set()
    for one in settings:
        searching = canonical({**one.keywords(), "memory_limit": one.memory_limit, "problem": one.problem})
        if searching in seen:
            continue
        seen.add(searching)
        try:
            if one.problem is not None:
                _ = PROBLEMS[one.problem]
            if one.form is not None:
                _ = FORMS[one.form]
            Request(**one.keywords(), memory_limit=one.memory_limit)
            if one.heuristic:
                HEURISTICS[one.method].check_parameters(one.options)
            else:
                solver_named(one.method).converted(Options(extra=one.options))
        except UsageError as fault:
            raise UsageError(f"{file}: {fault}", fault.code) from None
