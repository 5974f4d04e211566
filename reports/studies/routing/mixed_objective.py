"""Reward and makespan in one sum, after Mitchell (2020), section 5.5.4: how often the printed weight gives up reward for makespan."""

from typing import Any

import numpy as np

from ....formulations.routing.named_problems import makespan_orienteering
from ....formulations.routing.problem import RoutingProblem
from ....instances.errors import CheckFailedError
from ....instances.routing.instance import Sites
from ....instances.routing.travel import Travel
from ....solving.request import Request
from ....solving.solve import solve
from ...plots.drawing import COLOURS, plain
from ..findings import Finding
from ..frames import frame_table
from ..processes import spread
from ..study import Report, StudySetting, broken, figure, study

SITES, SIDE, LIMIT = 5, 10.0, 18.0
"""Waypoints, side of the square whose corner is the depot, and the limit of the route."""

KINDS = ("whole 1 to 10", "real 5 to 10")

ALIKE = 1e-6


def rewards_of(problem: RoutingProblem) -> tuple[float, float]:
    """Reward and makespan of an optimum; that of one route without waiting is its length."""
    best = solve(problem, Request(solver="highs", bound_time=0.0))
    if best.status != "optimal":
        raise CheckFailedError(f"highs did not find the optimum of {problem.name}: {best.status}")
    quantities = problem.evaluate(best.answer).quantities
    return float(quantities["reward"]), float(quantities["distance"])


def both(places: Any, reward: Any, limit: float) -> dict[str, float]:
    """Reward and makespan by priority, and by the sum with the printed weight."""
    sites, travel = Sites.of(range(len(places)), reward=reward), Travel("euclidean", np.asarray(places, dtype=float))
    first, second = (makespan_orienteering(sites, travel, vehicles=1, max_duration=limit, weight=w) for w in (None, "printed"))
    (most, makespan), (printed, sooner) = rewards_of(first), rewards_of(second)
    return {
        "reward": most,
        "makespan": makespan,
        "printed_reward": printed,
        "printed_makespan": sooner,
        "least": min(r for r in reward if r),
    }


def drawn(seed: int, kind: str) -> list[dict[str, Any]]:
    """One random instance."""
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    places = np.vstack([np.zeros(2), rng.uniform(0.0, SIDE, (SITES, 2))])
    reward = rng.integers(1, 11, SITES).astype(float) if kind == KINDS[0] else rng.uniform(5.0, 10.0, SITES)
    return [{"rewards": kind, "seed": seed, **both(places, [0.0, *reward.tolist()], LIMIT)}]


@study(
    "mixed-objective",
    "reward minus a weight times makespan, beside reward first and makespan then",
    60,
    short=4,
    source="Mitchell (2020), section 5.5.4",
    claim="with the weight min r_i zeta / B_max the makespan never decides over reward",
)
def mixed_objective(setting: StudySetting) -> Report:
    tasks = [(seed, kind) for seed in setting.seeds for kind in KINDS]
    done = spread(drawn, tasks, setting.jobs, setting.told, lambda task: f"instance {task[0]}, rewards {task[1]}")
    example = both([(0.0, 0.0), (5.0, 0.0), (-0.5, 0.0)], [0.0, 10.0, 9.0], 10.0)
    rows = []
    for kind in dict.fromkeys(row["rewards"] for row in done.rows):
        own = [row for row in done.rows if row["rewards"] == kind]
        less = [row["reward"] - row["printed_reward"] for row in own]
        rows.append({"rewards": kind, "instances": len(own), "less_reward": sum(lost > ALIKE for lost in less), "most_lost": max(less),
                     "beyond_the_least": sum(lost > row["least"] + ALIKE for lost, row in zip(less, own, strict=True))})  # fmt: skip
    lost = sum(row["less_reward"] for row in rows)
    beyond = sum(row["beyond_the_least"] for row in rows)
    said = f"{lost} of {len(done.rows)} give up reward"
    why = "the whole makespan weighs less than the least reward, but two plans' rewards may differ by less"
    bound = Finding.of_fact("reward given up is at most the least reward", "-", f"{beyond} of {len(done.rows)} beyond", beyond == 0)
    findings = [
        Finding.of_fact("random instances", "reward decides first", said, lost == 0, why),
        Finding.of_fact("sites (5, 0) of 10 and (-0.5, 0) of 9, limit 10", "reward 10", f"reward {example['printed_reward']:g}",
                        example["printed_reward"] >= example["reward"] - ALIKE, why),
        bound,
    ]  # fmt: skip
    return Report(
        "mixed-objective", mixed_objective.summary, frame_table("Optima of the sum that collect less than the largest reward", rows),
        tuple(rows), tuple(done.rows), figures=(_figure(done.rows),), findings=tuple(findings), **broken([bound]),
        notes=(f"{SITES} waypoints in a square of side {SIDE:g}, one robot, routes up to {LIMIT:g}; all optima are proved",),
        **done.progress(),
    )  # fmt: skip


@figure("mixed-objective", 7.0, 3.4)
def _figure(figure: Any, observations: list[dict[str, Any]]) -> None:
    """Reward and makespan given up by each optimum of the sum."""
    ax = figure.subplots()
    for k, kind in enumerate(KINDS):
        own = [row for row in observations if row["rewards"] == kind]
        x, y = ([row[key] - row[f"printed_{key}"] for row in own] for key in ("makespan", "reward"))
        ax.plot(x, y, "os"[k], color=COLOURS[k], alpha=0.6, markersize=4, label=f"rewards {kind}")
    ax.set_xlabel("makespan saved", fontsize=9)
    ax.legend(frameon=False, fontsize=8)
    plain(ax, "reward given up by the sum")
