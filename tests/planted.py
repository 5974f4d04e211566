"""Faults planted into modules, as one edit of their source each, and taken out again by pytest's ``monkeypatch``."""

import importlib
import sys
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from waybound.instances.registry import Registry
from waybound.reports.ratios import guarantees
from waybound.reports.studies.study import STUDIES, Fault, StudySetting

INSTANCES, SEED = 300, 1
"""As in ``waybound ratio all --instances 300 --seed 1``."""


@dataclass(frozen=True)
class Planted:
    """A fault: edits as (module, text that stands there once, text in its place), and the studies that should notice it."""

    name: str
    studies: tuple[str, ...]
    edits: tuple[tuple[str, str, str], ...]


class NoticedError(Exception):
    """The first fault of a study, which ends it."""

    def __init__(self, fault: Fault) -> None:
        super().__init__(fault.message)
        self.fault = fault


def plant(fault: Planted, monkeypatch: Any, folder: Path) -> None:
    """Put a fault in place: whatever holds something of an edited module gets that of the edited one."""
    for module in dict.fromkeys(f"waybound.{name}" for name, _, _ in fault.edits):
        original = importlib.import_module(module)
        assert original.__file__ is not None
        source = Path(original.__file__).read_text(encoding="utf-8")
        for name, old, new in fault.edits:
            if f"waybound.{name}" == module:
                assert source.count(old) == 1, f"{old!r} stands {source.count(old)} times in {module}"
                source = source.replace(old, new)
        _exchange(original, _made(original, source, folder, monkeypatch), monkeypatch)


def _made(original: ModuleType, source: str, folder: Path, monkeypatch: Any) -> ModuleType:
    """The module of an edited source; what it registers takes the place of the original's."""
    path = folder / f"{original.__name__.rpartition('.')[2]}.py"
    path.write_text(source, encoding="utf-8")
    made = ModuleType(original.__name__)
    made.__dict__.update({key: vars(original)[key] for key in ("__package__", "__spec__", "__loader__")}, __file__=str(path))
    with monkeypatch.context() as during:
        found: list[tuple[Registry[Any], str, Any]] = []
        during.setattr(Registry, "add", lambda registry, name, entry: found.append((registry, name, entry)) or entry)
        exec(compile(source, str(path), "exec"), vars(made))
    for registry, name, entry in found:
        registry.names()  # all that it finds by itself comes first
        monkeypatch.setitem(registry._entries, name, entry)
    return made


def _exchange(original: ModuleType, made: ModuleType, monkeypatch: Any) -> None:
    package, _, own = original.__name__.rpartition(".")
    monkeypatch.setitem(sys.modules, original.__name__, made)
    monkeypatch.setattr(sys.modules[package], own, made)
    theirs = {id(value): key for key, value in vars(original).items() if _source_of(value) == original.__name__}
    for holder in [module for name, module in sys.modules.items() if name.startswith("waybound.") and module is not made]:
        for key, value in list(vars(holder).items()):
            if id(value) in theirs and holder is not original:
                monkeypatch.setattr(holder, key, getattr(made, theirs[id(value)]))


def _source_of(value: Any) -> str | None:
    return getattr(getattr(value, "py_func", value), "__module__", None)  # a kernel has the function that it was made of


def first_fault(study: str, monkeypatch: Any) -> Fault | None:
    """The first fault that a study finds, run as ``waybound ratio`` runs it; None where it finds none."""
    measure = guarantees.measure

    def measured(*task: Any) -> guarantees.Chunk:
        chunk = measure(*task)
        if chunk.faults:
            raise NoticedError(chunk.faults[0])
        return chunk

    with monkeypatch.context() as during:
        during.setattr(guarantees, "measure", measured)
        try:
            report = STUDIES[study](StudySetting(INSTANCES, seed=SEED))
        except NoticedError as noticed:
            return noticed.fault
    return report.faults[0] if report.faults else None


_LOCAL = "solvers.engines.sata.local_max_min."
_LOOPS = "heuristics.sata.greedy_steps.loops_kernels"

FAULTS = (
    Planted("greedy whose gains are not lowered for coverage", ("greedy-cardinality", "greedy-partition"), (
        (_LOOPS, "near[item_elements[q]] -= w\n", "near[item_elements[q]] -= 0.0\n"),
    )),
    Planted("lazy greedy that takes stale gains", ("lazy-greedy",), (
        (_LOOPS, "if not full and evaluated[e] != count:", "if not full and evaluated[e] > count:"),
    )),
    Planted("sequential greedy that forgets what others took", ("sequential-greedy",), (
        (_LOOPS, "            take(left[at], best, layout, indptr, indices, weights, matrix, single)\n", ""),
    )),
    Planted("knapsack greedy without the best single element", ("knapsack-greedy",), (
        ("heuristics.sata.knapsack_greedy", "    if len(usable):\n", "    if False:\n"),
    )),
    Planted("stochastic greedy with a quarter of its sample", ("stochastic-greedy",), (
        ("heuristics.sata.stochastic_greedy", "math.ceil(-n / max(k, 1) * math.log(eps))", "math.ceil(-n / max(k, 1) * math.log(eps) / 4)"),
    )),
    Planted("pipage rounding downhill", ("continuous-greedy",), (
        ("heuristics.sata.greedy_steps.multilinear_kernels", "if slope(b, count, steps, data) > slope(a, count, steps, data):",
         "if slope(b, count, steps, data) < slope(a, count, steps, data):"),
    )),
    Planted("local algorithm with validity tested at the root only", ("local",), (
        (_LOCAL + "level_kernels", "        value = least[v]\n    return value", "        value = least[v]\n    return INFINITE"),
    )),
    Planted("local algorithm whose smoothing keeps its own level", ("local",), (
        (_LOCAL + "shares", "layers = tree_minima(cleaned, levels, np.empty(0), h, h, stop)", "layers = np.tile(levels, (h, 1))"),
    )),
    Planted("local algorithm that does not halve targets with one viewer", ("local",), (
        (_LOCAL + "level_kernels", "splat(2.0 / private[v])", "splat(1.0 / private[v])"),
        (_LOCAL + "layer_kernels", "levels[v] * (2.0 / private[v])", "levels[v] * (1.0 / private[v])"),
    )),
    Planted("local algorithm that states the ratio of one layer more", ("local",), (
        ("heuristics.sata.local", "(1.0 + 1.0 / run.h)", "(1.0 + 1.0 / (run.h + 1))"),
    )),
    Planted("local algorithm whose grid of levels hangs on the instance", ("local",), (
        (_LOCAL + "search", "self._grid = clean, h, LevelGrid(eps)",
         "self._grid = clean, h, LevelGrid(eps * min(1.0, clean.num_actions / 16))"),
    )),
    Planted("additive search that states its step", ("local",), (
        (_LOCAL + "search", "return levels, relative", "return levels, step"),
    )),
    Planted("rounding that takes the smallest share", ("rounding",), (
        ("heuristics.sata.rounding", "np.lexsort((turns, -level))", "np.lexsort((turns, level))"),
        ("heuristics.sata.rounding", "most = np.zeros(graph.num_robots)\n    np.maximum.at(most",
         "shares = np.where(shares > 0, 1.0 - shares + 1e-6, 0.0)\n    most = np.zeros(graph.num_robots)\n    np.maximum.at(most"),
    )),
    Planted("checker of marginal gains that counts one gain too few", ("greedy-cardinality",), (
        ("formulations.sata.checking.marginal_gains", "gains[chosen] = 0.0", "gains[chosen] = gains[int(np.argmax(gains))] = 0.0"),
    )),
    Planted("stochastic greedy that states 1 - 1/e", ("stochastic-greedy",), (
        ("heuristics.sata.stochastic_greedy", "Guarantee(1.0 / (most - eps)", "Guarantee(1.0 / most"),
    )),
    Planted("knapsack greedy that states 1 - 1/e from single elements", ("knapsack-greedy",), (
        ("heuristics.sata.knapsack_greedy", "PROVED[1] = PROVED[0]", "PROVED[1] = PROVED[2]"),
    )),
    # -- further ones: of auctions, schedules, risk and tours --
    Planted("greedy that states 1 - 1/e under a partition matroid", ("greedy-partition",), (
        ("heuristics.sata.greedy_steps.outcomes", "Guarantee(2.0,", "Guarantee(1.0 / (1.0 - math.exp(-1.0)),"),
    )),
    Planted("auction in which whoever won a bin keeps it", ("auction",), (
        ("heuristics.auctions.conflict_auction", 'problem.num_bins, mode == "immediate"', "problem.num_bins, True"),
    )),
    Planted("online greedy that states its ratio with fewer bins than robots", ("online-greedy",), (
        ("heuristics.auctions.online_greedy", "n <= min(problem.num_bins, MOST)", "n <= MOST"),
    )),
    Planted("auction of prices that ends early and calls it optimal", ("bertsekas",), (
        ("solvers.engines.auctions.assignment_steps.auction", "least = max(1, span if", "least = max(span // 2, 1, span if"),
        ("solvers.engines.auctions.assignment_steps.auction", "exact and least * part.num_columns < unit * _step(part, unit)", "exact"),
    )),
    Planted("list schedule that is shortest first when asked for longest first", ("list-schedule",), (
        ("heuristics.auctions.list_schedule", 'sign = 1 if order == "nearest" else -1', "sign = 1"),
    )),
    Planted("single-item auction whose bids are whole paths", ("sequential-single-item",), (
        ("heuristics.auctions.sequential_single_item", "for objective in OBJECTIVES].index(rule)",
         'for objective in OBJECTIVES].index("max")'),
    )),
    Planted("local ratios that forget what a job brings elsewhere", ("local-ratio",), (
        ("heuristics.auctions.local_ratio", "instance.values[i], 0.0) - worth, 0.0)", "instance.values[i], 0.0), 0.0)"),
    )),
    Planted("local ratios of knapsacks by profit rates that are called exact", ("local-ratio",), (
        ("heuristics.auctions.local_ratio", "    total, weight = np.zeros(1), np.zeros(1)\n",
         "    return order[np.cumsum(weights[order]) <= most], True\n    total, weight = np.zeros(1), np.zeros(1)\n"),
    )),
    Planted("least mean that states the optimum at every risk", ("least-mean", "uncertain-paths"), (
        ("heuristics.risk.least_mean", "None if problem.z else exact", "exact"),
    )),
    Planted("least mean that weighs variance as well", ("least-mean",), (
        ("heuristics.risk.least_mean", "(1.0, 0.0)", "(1.0, 0.2)"),
    )),
    Planted("look-back with one state a label", ("look-back",), (
        ("heuristics.risk.look_back", "if steps == 2 and not problem.graph.traverse:", "if False:"),
        ("heuristics.risk.look_back", "in look_back(problem, steps, stop).items()", "in look_back(problem, 1, stop).items()"),
    )),
    Planted("look-back that states the least risk whatever risks a path gathers", ("look-back",), (
        ("heuristics.risk.look_back", 'if "traverse" in categories or (', "if ("),
    )),
    Planted("two stages that take the least reward per risk", ("two-stage",), (
        ("heuristics.risk.two_stage", "max(able, key", "min(able, key"),
    )),
    Planted("Christofides' algorithm with any matching", ("christofides",), (
        ("heuristics.routing.tour_steps.giant_tour", "    partner = minimum_weight_perfect_matching(",
         "    partner = np.arange(len(odd)) ^ 1\n    minimum_weight_perfect_matching("),
    )),
    Planted("tour partitioning that states the ratio of an even capacity for an odd one", ("tour-partitioning",), (
        ("heuristics.routing.tour_partitioning", "size = int(capacity) if capacity % 2 == 0 else 2 * int(capacity)",
         "size = int(capacity)"),
    )),
)  # fmt: skip
