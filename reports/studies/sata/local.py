"""The local algorithm for max-min LPs: heights, searches and smoothings against Delta_R (1 + eps) (1 + 1/h) (1 - 1/Delta_T)."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ....formulations.sata.bottleneck_sata import BottleneckSATA
from ....formulations.sata.max_min_lp import MaxMinLP
from ....heuristics.heuristic import Outcome
from ....instances.sata.sensing_graph import SensingGraph
from ...ratios.guarantees import guarantee_study
from ...ratios.judged_runs import TOLERANCE, Configuration, run_heuristic
from ...tables.table import Column, Table
from ..findings import Finding
from ..study import STUDIES, Fault, Report, Study, StudySetting
from ..violations import instance_of
from .families import max_min as families

EPS = 0.01
"""Finer than the default, so that it hides little of how tight the rest of the bound is."""


def degrees(problem: Any) -> tuple[int, int]:
    """Delta_R and Delta_T: most live actions of a robot, most actions that see a target; both at least 2."""
    if isinstance(problem, MaxMinLP):
        live = np.unique(problem.covering.indices)
        rows = np.repeat(np.arange(problem.packing.rows), np.diff(problem.packing.indptr))
        owner = np.zeros(problem.num_variables, dtype=np.int64)
        owner[problem.packing.indices] = rows
        return max(2, int(np.bincount(owner[live]).max())), max(2, int(np.diff(problem.covering.indptr).max()))
    graph = problem.graph
    live = np.unique(graph.action_of_edge)
    return max(2, int(np.bincount(graph.robot_of_action[live]).max())), max(2, int(np.bincount(graph.indices).max()))


def _ratio(h: int, eps: float = EPS) -> Any:
    """Delta_R (1 + eps) (1 + 1/h) (1 - 1/Delta_T) (Floréen et al. 2011, corollary 4.7; Sung 2019, theorem 1), of shares alone."""

    def expected(problem: Any) -> float:
        delta_r, delta_t = degrees(problem)
        return delta_r * (1.0 + eps) * (1.0 + 1.0 / h) * (1.0 - 1.0 / delta_t)

    return expected


def _at_least(h: int) -> Any:
    """The additive search must state a guarantee, with whatever eps > 0 its step amounts to."""
    return lambda problem: (_ratio(h, 0.0)(problem), math.inf)


Faults = Iterator[tuple[str, str]]


def _agrees(problem: Any, options: Mapping[str, Any], seed: int, outcome: Outcome) -> Faults:
    """Shares depend on what is near, so another graph beside this one changes none; and on no unit, so double weights do neither."""
    if isinstance(problem, MaxMinLP):
        return
    g = problem.graph
    beside = _again(problem, options, seed, families.side_by_side(g, 3.0))[0][: g.num_actions]
    yield from _differing(beside, outcome.answer, "beside another graph")
    doubled = {**options, "step": 2.0 * options.get("step", 0.1)} if options.get("search") == "step" else options
    shares, stated = _again(problem, doubled, seed, replace(g, weights=2.0 * g.weights))
    yield from _differing(shares, outcome.answer, "with all weights doubled")
    own = None if outcome.guarantee is None else outcome.guarantee.ratio
    if stated != own:
        yield "guarantee", f"the stated ratio is {own}, and {stated} with all weights, and steps, doubled"


def _again(problem: Any, options: Mapping[str, Any], seed: int, graph: SensingGraph) -> tuple[Any, float | None]:
    """Shares and stated ratio on another graph."""
    outcome = run_heuristic(BottleneckSATA(graph, fractional=True), "local", {**options, "ball": False}, seed)
    return outcome.answer, None if outcome.guarantee is None else outcome.guarantee.ratio


def _differing(other: Any, own: Any, how: str) -> Faults:
    apart = float(np.abs(np.asarray(other) - np.asarray(own)).max(initial=0.0))
    if apart > TOLERANCE:
        yield "order", f"a share is another one, by {apart:.3g}, {how}"


def _configuration(label: str, expected: Any, checks: Any = _agrees, **options: Any) -> Configuration:
    return Configuration(label, "local", expected, {"eps": EPS, "ball": False, **options}, checks=checks)


def _of_each_height(problem: Any, options: Mapping[str, Any], seed: int, outcome: Outcome) -> Faults:
    """The best of several heights is worth as much as the best of their runs."""
    runs = [run_heuristic(problem, "local", {"eps": EPS, "ball": False, "h": h}, seed).answer for h in range(1, options["heights"] + 1)]
    best, own = (max(problem.evaluate(answer).values[0] for answer in answers) for answers in (runs, [outcome.answer]))
    if abs(best - own) > TOLERANCE * max(best, own):
        yield "order", f"the best of the heights has {best!r}, all of them together {own!r}"


guarantee_study(
    "local",
    "the local algorithm, stated Delta_R (1 + eps) (1 + 1/h) (1 - 1/Delta_T) on shares",
    1000,
    [
        *(_configuration(f"h={h}", _ratio(h), h=h) for h in (1, 2, 3, 5, 10)),
        _configuration("h=3 raw", _ratio(3), h=3, normalise=False),
        _configuration("h=3 ball", _ratio(3), h=3, smoothing="ball"),
        _configuration("h=2 step", _at_least(2), h=2, search="step"),
        _configuration("h=1..4", _ratio(4), _of_each_height, heights=4),
        Configuration("default", "local", _ratio(4, 0.1), checks=_agrees),
    ],
    (
        *families.RANDOM_FAMILIES, families.RANDOM_PROGRAMS, families.REFERENCE_GRAPHS, families.TIGHT, families.PRIVATE,
        families.CYCLES, families.REGULAR_TREES,
    ),
    source="Sung (2019), Theorem 1", claim="within Delta_R (1 + eps) (1 + 1/h) (1 - 1/Delta_T) of the linear program",
)  # fmt: skip


# -- table 3.1 of Sung (2019), all 18 entries, beside the values without its coarse steps --------------------------------

HEIGHTS = (2, 10, 30)

PRINTED = {
    2: (0.5, 0.5, 0.6667, 0.3333, 0.3333, 0.6667),
    10: (0.5, 0.5, 0.7591, 0.2409, 0.2409, 0.7591),
    30: (0.5, 0.5, 0.7855, 0.2145, 0.2145, 0.7855),
}
"""As printed: shares of the actions p1 to p6 on the graph of figure 3.3."""

EXACT = {
    2: (0.5, 0.5, 0.6667, 0.3333, 0.3333, 0.6667),
    10: (0.5106, 0.4894, 0.7905, 0.2095, 0.2498, 0.7502),
    30: (0.5042, 0.4958, 0.8172, 0.1828, 0.1980, 0.8020),
}
"""With exact levels in place of steps of 0.1, from exact rationals; docs/formulations/bottleneck.md#errata."""

DIGITS = 5e-5
"""Half a unit of the last printed digit."""

STEPS = {"search": "step", "step": 0.1, "ball": False}
FINE = {"search": "secant", "eps": 1e-6, "ball": False}

TITLE = "Table 3.1 of Sung (2019): shares on the graph of figure 3.3"

NOTES = (
    "printed: the thesis; steps: levels lowered in steps of 0.1, as the thesis' table needs; exact, fine: known values with exact levels, "
    "and the search to 1e-6",
    "the values show that more layers are not better by themselves: 7/6 at h = 2, 1.2409 at h = 10, 1.2145 at h = 30 with steps of 0.1",
)


def table_3_1(setting: StudySetting) -> Report:
    """Both searches at the three heights; every entry must agree with its published value."""
    problem = families.robots(families.REFERENCES["A"][0], "figure-3.3")
    rows, body, faults = [], [], []
    for h in HEIGHTS:
        shares = {
            name: [float(x) for x in run_heuristic(problem, "local", {"h": h, **options}, setting.seed).answer]
            for name, options in (("steps", STEPS), ("fine", FINE))
        }
        for action in range(6):
            row: dict[str, Any] = {
                "h": h, "action": f"p{action + 1}", "printed": PRINTED[h][action], "steps": shares["steps"][action],
                "exact": EXACT[h][action], "fine": shares["fine"][action],
            }  # fmt: skip
            rows.append(row)
            body.append((str(h), f"p{action + 1}", *(f"{row[key]:.4f}" for key in ("printed", "steps", "exact", "fine"))))
            for known, own in (("printed", "steps"), ("exact", "fine")):
                if abs(row[own] - row[known]) > DIGITS:
                    text = f"h = {h}, p{action + 1}: {row[own]:.6f}, {known} {row[known]:.4f}"
                    faults.append(Fault("values", text, instance_of(problem, text), own))
    columns = (Column("h", right=True), Column("action"), *(Column(key, right=True) for key in ("printed", "steps", "exact", "fine")))
    setting.told(1, 1, "")
    return Report(
        "table-3-1", TITLE, Table(TITLE, columns, tuple(body)), tuple(rows), (), tuple(faults), len(faults), (), NOTES, 1, 1,
        findings=tuple(_findings(rows)),
    )  # fmt: skip


def _findings(rows: Sequence[dict[str, Any]]) -> list[Finding]:
    """Entries as printed, and what becomes of them with exact levels."""
    apart = {key: sum(abs(row[key] - row["printed"]) > DIGITS for row in rows) for key in ("steps", "fine")}
    count = len(rows)
    return [
        Finding.of_fact("entries, by steps of 0.1", f"{count} shares", f"{count - apart['steps']} equal", not apart["steps"], exact=True),
        Finding.of_fact("entries, by exact levels", f"{count} shares", f"{count - apart['fine']} equal", not apart["fine"],
                        "robot 1 divides itself evenly only where levels are coarse", exact=True),
    ]  # fmt: skip


STUDIES.add(
    "table-3-1",
    Study(
        "table-3-1", TITLE, 1, table_3_1, source="Sung (2019), Table 3.1 and Fig. 3.3",
        claim="shares at 2, 10 and 30 layers, nearer to whole actions with more layers",
    ),
)  # fmt: skip
