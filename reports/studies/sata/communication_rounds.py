"""Rounds of communication of greedy and of the local algorithm, after Sung (2019), sections 3.4 and 3.5."""

from typing import Any

from ....formulations.sata.bottleneck_sata import BottleneckSATA
from ....formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from ...plots.drawing import COLOURS, plain
from ...ratios.judged_runs import run_heuristic
from ..findings import Finding
from ..frames import frame_table, mean_interval
from ..processes import spread
from ..study import Report, StudySetting, figure, study
from .experiments import sensing_graph

TEAMS, HEIGHTS = (4, 8, 12, 16, 20), (1, 2, 5)


def rounds(seed: int, robots: int) -> list[dict[str, Any]]:
    """Rounds and messages of each algorithm on one random graph, as robots that only hear their neighbours count them."""
    graph, own = sensing_graph({"robots": robots, "targets": 50, "phi": 15.0, "actions": 2}, seed, 0)
    greedy = run_heuristic(WinnerTakesAllSATA(graph), "sequential-greedy", {}, own)
    row: dict[str, Any] = {"robots": robots, "seed": seed, "greedy": greedy.statistics["communication_rounds"]}
    for h in HEIGHTS:
        talk = run_heuristic(BottleneckSATA(graph, fractional=True), "local", {"h": h, "messages": True}, own).statistics
        row |= {f"local, h = {h}": talk["rounds"], f"messages, h = {h}": talk["messages"]}
    return [row]


@study(
    "communication-rounds",
    "rounds of communication of greedy and of the local algorithm, over the number of robots",
    10,
    short=1,
    source="Sung (2019), Theorem 1 and sections 3.4.1, 3.4.2",
    claim="greedy takes as many rounds as there are robots, the local algorithm O(h log 1/eps) whatever their number",
)
def communication_rounds(setting: StudySetting) -> Report:
    teams = TEAMS if setting.full else TEAMS[:2]
    tasks = [(seed, robots) for seed in setting.seeds for robots in teams]
    done = spread(rounds, tasks, setting.jobs, setting.told, lambda task: f"{task[1]} robots, graph {task[0]}")
    rows = []
    for robots in sorted({row["robots"] for row in done.rows}):
        own = [row for row in done.rows if row["robots"] == robots]
        rows.append(
            {"robots": robots, **{key: mean_interval([float(o[key]) for o in own])[0] for key in own[0] if key not in ("robots", "seed")}}
        )
    every = all(row["greedy"] == row["robots"] for row in done.rows)
    counts = {h: sorted({row[f"local, h = {h}"] for row in done.rows}) for h in HEIGHTS}
    fixed = all(len(own) == 1 for own in counts.values())
    said = "; ".join(f"h = {h}: {', '.join(map(str, own))}" for h, own in counts.items())
    findings = (
        Finding.of_fact("rounds of greedy", "one a robot", "one a robot" if every else "other numbers", every, exact=True),
        Finding.of_fact("rounds of the local algorithm", "independent of the number of robots", said, fixed, exact=True),
    )  # fmt: skip
    return Report(
        "communication-rounds", communication_rounds.summary, frame_table("Rounds, and messages of the local one; means of graphs", rows),
        tuple(rows), tuple(done.rows), figures=(_figure(rows),), findings=findings,
        notes=("the local algorithm's robots send longer messages in 5 h - 4 rounds here, in place of O(h log 1/eps) short ones",),
        **done.progress(),
    )  # fmt: skip


@figure("communication-rounds", 6.5, 3.2)
def _figure(figure: Any, rows: list[dict[str, Any]]) -> None:
    """Rounds over the number of robots."""
    ax = figure.subplots()
    for k, key in enumerate(("greedy", *(f"local, h = {h}" for h in HEIGHTS))):
        ax.plot([row["robots"] for row in rows], [row[key] for row in rows], "o-", color=COLOURS[k], label=key)
    ax.set_xlabel("robots", fontsize=9)
    ax.set_ylim(bottom=0)
    ax.legend(frameon=False, fontsize=8)
    plain(ax, "rounds")
