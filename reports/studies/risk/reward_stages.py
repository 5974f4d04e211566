"""Reward per risk by two stages and exactly, on random maps, after Xiao (2019), sections 4.2.2.2 and 4.3."""

from typing import Any

from ....formulations.risk.risky_path import RiskyPath
from ....instances.errors import CheckFailedError
from ....instances.generating import generate
from ....instances.risk.risky_graph import RiskyGraph
from ....solving.request import Request
from ....solving.solve import solve
from ...plots.drawing import COLOURS, plain
from ..findings import LOST, Finding
from ..frames import HALF, frame_table, mean_interval
from ..processes import spread
from ..study import Report, StudySetting, figure, study

MAP = {"rows": 4, "columns": 5, "occupied": 0.2, "block": 1, "rewards": 6, "connectivity": 4, "turn": 0.1, "clearance": 0.1, "length": 0.05}

DISCOUNTS = (1.0, 0.0)
"""All rewards on the way count, or the last alone."""

ALIKE = 1e-9


def stages(seed: int, discount: float) -> list[dict[str, Any]]:
    """Reward per risk of one map by both, and whether they end in the same cell."""
    graph = generate("risky-grid", seed, **MAP, discount=discount)
    assert isinstance(graph, RiskyGraph)
    problem = RiskyPath(graph)
    best = solve(problem, Request(solver="risk-labels", bound_time=0.0))
    if best.status != "optimal":
        raise CheckFailedError(f"risk-labels did not find the best of {problem.name}: {best.status}")
    two = solve(problem, Request(heuristic="two-stage", bound_time=0.0))
    most, found = (float(problem.evaluate(one.answer).values[0]) for one in (best, two))
    goal = best.answer[-1] == two.answer[-1]
    return [
        {"discount": discount, "seed": seed, "exact": most, "two_stage": found, "share": found / most if most else 1.0, "same_goal": goal}
    ]


@study(
    "reward-stages",
    "reward per risk by the least risky path to each cell, beside the best of all paths",
    200,
    short=8,
    source="Xiao (2019), sections 4.2.2.2 and 4.3, Fig. 4.11",
    claim="two stages find the same goal as the exact planner, whose path turns once more for more reward",
)
def reward_stages(setting: StudySetting) -> Report:
    tasks = [(seed, discount) for seed in setting.seeds for discount in DISCOUNTS]
    done = spread(stages, tasks, setting.jobs, setting.told, lambda task: f"map {task[0]}")
    rows = []
    for discount in DISCOUNTS:
        own = [row for row in done.rows if row["discount"] == discount]
        if own:
            row: dict[str, Any] = {"rewards": "all on the way" if discount else "the last alone", "maps": len(own)}
            row["optimal"] = sum(one["share"] > 1.0 - ALIKE for one in own)
            row["share"], row[f"share{HALF}"] = mean_interval([one["share"] for one in own])
            rows.append(row | {"least": min(one["share"] for one in own), "same_goal": sum(one["same_goal"] for one in own)})
    findings = [Finding("Fig. 4.11: both paths", "drawn", "-", LOST, "the grid and its rewards are lost")]
    for row in rows:
        said = f"{row['same_goal']} of {row['maps']} maps"
        if row["rewards"] == "the last alone":
            held, why = row["optimal"] == row["maps"], "a walk of least risk loops"
            findings.append(
                Finding.of_fact("the last reward alone (chapter 7)", "-", f"optimal on {row['optimal']} of {row['maps']}", held, why)
            )
        else:
            why = "rewards off the least risky paths are not seen; there is no bound on what that costs"
            findings.append(Finding.of_fact("same goal as the exact planner", "yes", said, row["same_goal"] == row["maps"], why))
    return Report(
        "reward-stages", reward_stages.summary, frame_table("Two stages' share of the best reward per risk", rows), tuple(rows),
        tuple(done.rows), figures=(_figure(done.rows),), findings=tuple(findings),
        notes=("the best reward per risk is proved on each map; maps of 4 x 5 cells, six with a reward",), **done.progress(),
    )  # fmt: skip


@figure("reward-stages", 7.0, 3.4)
def _figure(figure: Any, observations: list[dict[str, Any]]) -> None:
    """The share of each map, from the least to the largest."""
    ax = figure.subplots()
    for k, discount in enumerate(DISCOUNTS):
        shares = sorted(row["share"] for row in observations if row["discount"] == discount)
        ax.step([(i + 1) / len(shares) for i in range(len(shares))], shares, where="post", color=COLOURS[k],
                label="all rewards count" if discount else "the last alone counts")  # fmt: skip
    ax.set_xlabel("share of the maps", fontsize=9)
    ax.set_ylim(0.0, 1.05)
    ax.legend(frameon=False, fontsize=8, loc="lower right")
    plain(ax, "two stages' reward per risk over the best")
