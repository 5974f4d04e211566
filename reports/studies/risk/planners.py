"""Planners of least risk on random maps, after Xiao (2019), section 4.2.2: sums of risks, and labels that look back."""

from typing import Any

import numpy as np

from ....formulations.risk.risky_path import RiskyPath
from ....instances.errors import CheckFailedError
from ....instances.generating import generate
from ....instances.risk.risky_graph import RiskyGraph
from ....solving.request import Request
from ....solving.solve import solve
from ...plots.drawing import COLOURS, plain
from ...plots.risk.risky_path import plot_risky_path
from ..findings import LOST, Finding
from ..frames import HALF, frame_table, mean_interval
from ..processes import spread
from ..study import Report, StudySetting, figure, study

PLANNERS: dict[str, Request] = {
    "additive": Request(heuristic="additive-risk", bound_time=0.0),
    **{f"look-back {steps}": Request(heuristic="look-back", options={"steps": steps}, bound_time=0.0) for steps in (1, 2, 3)},
}
"""The conventional planner, which adds up risks of places; Dijkstra's search, the source's approximate planner, and one state more."""

LEAST = Request(solver="risk-labels", bound_time=0.0)

MAP = {"rows": 9, "columns": 9, "occupied": 0.25, "block": 2, "connectivity": 4, "turn": 0.04, "clearance": 0.06, "length": 0.05}

KINDS: dict[str, dict[str, Any]] = {"places and moves": {}, "and a tether": {"tether": True}, "and mud": {"mud": 0.3, "mud-risk": 0.15}}
"""Risks of places, lengths and turns alone; with such as depend on all of the way."""

SHORT_OF = 1e-9
"""Risk by which a path must be worse to count as such."""


def map_of(seed: int, kind: str) -> RiskyPath:
    """One random map."""
    graph = generate("risky-grid", seed, **MAP, **KINDS[kind])
    assert isinstance(graph, RiskyGraph)
    return RiskyPath(graph)


def compared(seed: int, kind: str) -> list[dict[str, Any]]:
    """Risk of the path of each planner on one map, and the least."""
    problem = map_of(seed, kind)
    best = solve(problem, LEAST)
    if best.status != "optimal":
        raise CheckFailedError(f"risk-labels did not find the least risk of {problem.name}: {best.status}")
    risks = {name: solve(problem, request).objective for name, request in PLANNERS.items()}
    return [{"kind": kind, "seed": seed, "least": best.objective, **risks}]


@study(
    "risky-planners",
    "risk of the paths of the additive planner and of labels that look back, beside the least",
    200,
    short=4,
    source="Xiao (2019), section 4.2.2, Figs. 4.4 to 4.10",
    claim="one label a cell loses the least risk and two states find it, but not with risks of the whole way; sums take riskier paths",
)
def risky_planners(setting: StudySetting) -> Report:
    tasks = [(seed, kind) for seed in setting.seeds for kind in KINDS]
    done = spread(compared, tasks, setting.jobs, setting.told, lambda task: f"map {task[0]}, {task[1]}")
    rows = []
    for kind in dict.fromkeys(row["kind"] for row in done.rows):
        own = [row for row in done.rows if row["kind"] == kind]
        for name in PLANNERS:
            more = np.array([row[name] - row["least"] for row in own])
            row: dict[str, Any] = {"risks of": kind, "planner": name, "maps": len(own), "worse": int((more > SHORT_OF).sum())}
            row["more_risk"], row[f"more_risk{HALF}"] = mean_interval(more)
            rows.append(row | {"most": float(more.max())})
    first = [row for row in done.rows if row["kind"] == "places and moves"]
    widest = max(first, key=lambda row: row["additive"] - row["least"])
    return Report(
        "risky-planners", risky_planners.summary, frame_table("Paths worse than the least risk, and by how much", rows), tuple(rows),
        tuple(done.rows), figures=(_figure(widest),), findings=tuple(findings(rows)),
        notes=("the least risk is proved on each map, by labels with memory", "maps of 9 x 9 cells, four neighbours, a quarter occupied"),
        **done.progress(),
    )  # fmt: skip


def findings(rows: list[dict[str, Any]]) -> list[Finding]:
    """The source's claims on these maps."""
    known = {(row["risks of"], row["planner"]): row for row in rows}

    def worse(kind: str, planner: str) -> tuple[str, int]:
        row = known[kind, planner]
        return f"worse on {row['worse']} of {row['maps']} maps", int(row["worse"])

    found = [
        Finding("Fig. 4.7: risk by the narrow gap, and by the detour of sums", "0.14 and 0.31", "-", LOST, "the map is lost"),
        Finding("Fig. 4.4: the best way to a cell is not part of the best way through it", "two paths", "look-back 1, below", LOST,
                "numbers and map are lost; as told the two cells seem exchanged"),
        Finding("Figs. 4.9 and 4.10: work grows exponentially with the states looked back", "plotted", "-", LOST, "no sizes or times"),
    ]  # fmt: skip
    places, mud = "places and moves", "and mud"
    if (places, "additive") in known:
        row = known[places, "additive"]
        found.append(Finding.of_lead("additive planner above the least risk", "riskier", row["more_risk"], row[f"more_risk{HALF}"]))
        said, count = worse(places, "look-back 1")
        found.append(Finding.of_fact("one label a cell, places and moves", "may lose the least risk", said, count > 0, "too few maps"))
        said, count = worse(places, "look-back 2")
        found.append(Finding.of_fact("two states, places and moves", "the least risk", said, count == 0, "walks that loop", exact=True))
    if (mud, "additive") in known:
        said, count = worse(mud, "look-back 2")
        found.append(Finding.of_fact("two states, mud", "may lose the least risk", said, count > 0, "too few maps"))
    return found


@figure("risky-planners", 9.6, 4.2)
def _figure(figure: Any, row: dict[str, Any]) -> None:
    """The paths of the additive planner and of least risk on the map where they lie farthest apart."""
    problem = map_of(row["seed"], row["kind"])
    ways = {"additive planner": solve(problem, PLANNERS["additive"]), "least risk": solve(problem, LEAST)}
    for k, (ax, (name, way)) in enumerate(zip(figure.subplots(1, 2), ways.items(), strict=True)):
        plot_risky_path(problem, way.answer, ax=ax, title=name)
        plain(ax, f"{name}: {way.objective:.3f}")
        ax.title.set_color(COLOURS[k])
