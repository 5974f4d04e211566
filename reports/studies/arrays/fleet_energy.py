"""Fleet energy after Mitchell (2020), appendix A: what a fleet sustains, and how far exchanges one by one are from the fewest."""

from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from ....formulations.arrays.exchange_schedule import ExchangeCase, faults, uncovered
from ....formulations.arrays.problem import ArrayProblem
from ....heuristics.arrays._exchanges import exchange_program, feasible, one_by_one, robots_for_ever, scheduled
from ....instances.arrays.worlds.fleet_energy import NEVER
from ....solving.request import Request
from ....solving.solve import solve
from ...missions.arrays.fleet_energy import FleetEnergy
from ...missions.running import run
from ...plots.drawing import COLOURS, plain
from ..findings import LOST, NOT, SIGN, UNDECIDED, Finding
from ..frames import HALF, apart, completed, decision_times, film_of, frame_table, framed, mean_interval, times_apart
from ..processes import called, spread
from ..study import Clip, Fault, Report, StudySetting, figure, study, thinned

if TYPE_CHECKING:
    import pandas as pd

LOOPS: dict[str, dict[str, Any]] = {"fewest takeoffs": {"solver": "highs"}, "one by one": {"policy": "one-by-one"}}

PLAYS: dict[str, dict[str, Any]] = {
    "100 robots": {"robots": 100, "persistent": 6, "jobs": 0, "steps": 1080},
    "100 robots, ways counted": {"robots": 100, "persistent": 6, "jobs": 0, "steps": 1080, "count_ways": True},
    "26 robots, charge believed short": {"believed_charge": 840, "jobs": 0, "steps": 540},
}
"""Three hours of a fleet of 100, and an hour and a half of one of 26 that takes 14 minutes for its charging time of 40 at first."""

FLEET: dict[str, Any] = {"robots": 60, "steps": 360}
"""The fleet that is played in closed loop, for an hour."""

NOTES = (
    "intervals are of confidence 95 % over seeds; both methods meet the same fleets and jobs",
    "areas, speeds, pads, reserves, requests, scatter and the step of the charging time are not published: settings of the mission",
)

MEANS = "Means; lost: against the fewest takeoffs, on the same fleets"

SCARCE = "the plans of scarce fleets leave places alone, as few steps as possible; takeoffs are compared where no plan does"

HISTOGRAM = "the histogram of charges is lost"

WAYS = "the ways there and back are no time at the place: (A.2) leaves them out"


def small_case(seed: int) -> ExchangeCase:
    """Robots from three stations and places to be watched for some flight times; batteries charge within the schedule."""
    rng = np.random.Generator(np.random.PCG64(seed))
    places, robots = int(rng.integers(1, 4)), int(rng.integers(6, 19))
    travel = rng.integers(1, 4, (3, places))[np.arange(robots) % 3]
    end = np.full(places, 24)
    return ExchangeCase(
        travel, int(rng.integers(8, 11)), int(rng.integers(4, 14)), rng.integers(0, 4, robots), rng.integers(3, 8, places), end
    )  # fmt: skip


def small(seed: int) -> list[dict[str, Any]]:
    """One small fleet scheduled both ways: a task for ``spread``."""
    case = small_case(seed)
    program, columns = exchange_program(case)
    solution = solve(ArrayProblem(program), Request(solver="highs", time_limit=60.0))
    plans = {"one by one": one_by_one(case), "fewest takeoffs": scheduled(case, columns, np.asarray(solution.answer))}
    return [
        {
            "part": "schedule", "seed": seed, "method": method, "takeoffs": len(plan), "alone": uncovered(case, plan),
            "faults": "; ".join(faults(case, plan)), "proved": solution.status == "optimal",
        }
        for method, plan in plans.items()
    ]  # fmt: skip


def looped(seed: int) -> list[dict[str, Any]]:
    """Run both methods in the closed loop for one seed: a task for ``spread``."""
    rows = []
    for method, how in LOOPS.items():
        log = completed("fleet-energy", seed=seed, **FLEET, **how)
        last = log.iloc[-1]
        rows.append(
            {"part": "loop", "seed": seed, "method": method, **{key: float(last[key]) for key in ("covered", "takeoffs", "lost")},
             **decision_times(log, log["problems"] >= ("solver" in how))}
        )  # fmt: skip
    return rows


def claimed(seed: int, name: str) -> list[dict[str, Any]]:
    """A fleet of the appendix at play: robots in the air, and how many jobs for ever it supported in turn: a task for ``spread``."""
    mission, supported = FleetEnergy(), []

    def watch(world: Any, row: dict[str, Any]) -> None:
        if row:
            supported.append(sum(world.jobs[number].end == NEVER for number in mission.taken))

    log = run(mission, seed=seed, policy="one-by-one", watch=watch, **PLAYS[name])
    levels = [level for level, _ in groupby(supported)]
    row = {"airborne": float(log["airborne"].mean()), **{key: float(log[key].iloc[-1]) for key in ("covered", "takeoffs", "lost")}}
    return [
        {"part": "claim", "seed": seed, "method": name, **row, "supported": " ".join(map(str, levels)), "for_ever": mission.robots_for_ever}
    ]


@study(
    "fleet-energy",
    "which jobs a fleet with small batteries sustains, and exchanges one by one beside the fewest",
    100,
    short=4,
    source="Mitchell (2020), appendix A",
    claim="ceil(charge / flight) + 1 robots sustain a job for ever; 100 robots fly 4 to 5 at a time; of 26 the supported jobs fall 3, 2, 1",
)
def fleet_energy(setting: StudySetting) -> Report:
    tasks: list[tuple[Any, ...]] = [(part, seed) for part in (small, looped) for seed in setting.seeds]
    tasks += [(claimed, seed, name) for name in PLAYS for seed in setting.seeds]
    done = spread(called, tasks, setting.jobs, setting.told, lambda t: " ".join([t[0].__name__, *map(str, t[1:])]))
    played_rows, times = times_apart(done.rows)
    runs = framed(played_rows)
    broken = broken_schedules(played_rows)
    rows = means(runs)
    played = film_of(FleetEnergy(), setting.seed, policy="one-by-one", robots=60, steps=120)
    return Report(
        "fleet-energy", fleet_energy.summary, frame_table(MEANS, rows), tuple(rows),
        tuple(played_rows), thinned(broken), len(broken), figures=(supported_figure(setting.seed),), notes=(*NOTES, SCARCE),
        findings=tuple(findings(runs)), further=(times,),
        clips=(Clip(lambda: played, "sixty robots keep jobs going for twenty minutes"),), **done.progress(),
    )  # fmt: skip


def broken_schedules(rows: list[dict[str, Any]]) -> list[Fault]:
    """Schedules that the checker rejects, programs without a proof, and plans that are better than the proved best."""
    broken = []
    pairs: dict[int, dict[str, Any]] = {}
    for row in rows:
        if row["part"] != "schedule":
            continue
        pairs.setdefault(row["seed"], {})[row["method"]] = (row["alone"], row["takeoffs"])
        if row["faults"] or not row["proved"]:
            broken.append(Fault("answer", f"seed {row['seed']}, {row['method']}: {row['faults'] or 'not proved'}", None, row["method"]))
    better = [seed for seed, pair in pairs.items() if pair["one by one"] < pair["fewest takeoffs"]]
    return [*broken, *(Fault("bound", f"seed {seed}: one by one is better than the fewest takeoffs", None, "order") for seed in better)]


def means(runs: "pd.DataFrame") -> list[dict[str, Any]]:
    """Each part and method with intervals, and by how much one by one loses."""
    rows: list[dict[str, Any]] = []
    for (part, method), own in runs.groupby(["part", "method"], sort=False) if len(runs) else ():
        alike, reference = runs[runs["part"] == part], next(iter(LOOPS))
        if part == "schedule":
            worst = alike.groupby("seed")["alone"].max()
            alike, own = (frame[frame["seed"].map(worst) == 0] for frame in (alike, own))
        row: dict[str, Any] = {"part": part, "method": method, "runs": len(own)}
        for name in ("takeoffs", "covered", "airborne"):
            row[name], row[f"{name}{HALF}"] = mean_interval(own[name].dropna()) if name in own else (np.nan, np.nan)
        if part != "claim" and len(own):
            row["takeoffs_lost"], row[f"takeoffs_lost{HALF}"] = apart(alike, "takeoffs", str(method), reference)
        rows.append(row)
        if part == "schedule":
            every = runs[(runs["part"] == part) & (runs["method"] == method)]
            row["alone"], row[f"alone{HALF}"] = mean_interval(every["alone"])
            row["alone_lost"], row[f"alone_lost{HALF}"] = apart(runs[runs["part"] == part], "alone", str(method), reference)
    return rows


def findings(runs: "pd.DataFrame") -> list[Finding]:
    """The claims of the appendix."""
    fleet = np.zeros(30, dtype=np.int64)
    longest = max(minutes for minutes in range(1, 61) if feasible(fleet, [(1, np.inf), (1, minutes)], 2, 34))
    second = feasible(fleet, [(1, np.inf)] * 2, 2, 34)
    found = [
        Finding.of_number("demonstration: robots of a job for ever, 2 min of flight, 34 of charging", "18", robots_for_ever(34, 2)),
        Finding.of_fact(
            "demonstration: a second job for ever of 30 robots",
            "infeasible",
            "feasible" if second else "infeasible",
            not second,
            exact=True,
        ),
        Finding(
            "demonstration: a further job of one robot lasts up to", "28 min, 17 robots taken", f"{longest} min, 18 taken", LOST, HISTOGRAM
        ),
        Finding("power cycles of the hardware", "more than 1,000", "none", LOST, "no hardware here"),
    ]
    plays = {str(name): own for name, own in runs[runs["part"] == "claim"].groupby("method", sort=False)} if len(runs) else {}
    if "100 robots" in plays:
        mean, half = mean_interval(plays["100 robots"]["airborne"])
        verdict = SIGN if mean - half >= 4.0 and mean + half <= 5.0 else NOT if mean + half < 4.0 or mean - half > 5.0 else UNDECIDED
        why = "" if verdict == SIGN else "jobs of unlike ways" if verdict == NOT else "the interval is not within"
        found.append(Finding("100 robots, 3 h: in the air at a time", "4 to 5", f"{mean:.3f} ± {half:.3f}", verdict, why))
        for name, own in list(plays.items())[:2]:
            gap, half = mean_interval(own["covered"] - 99.5)
            found.append(
                Finding.of_lead(f"{name}: percent of the time places are watched, above 99.5", "sustained", gap, half, "points", WAYS)
            )
    if "26 robots, charge believed short" in plays:
        falls = plays["26 robots, charge believed short"]["supported"].str.fullmatch(r"(0 )?3 2 1")
        said, most = f"3, 2, 1 in {int(falls.sum())} of {len(falls)} runs", bool(falls.mean() > 0.5)
        found.append(Finding.of_fact("26 robots: supported jobs as estimates settle", "3, 2, 1", said, most, "estimates settle otherwise"))
    return found


@figure("fleet-energy", 7.0, 4.6)
def supported_figure(figure: Any, seed: int) -> None:
    """Jobs for ever that a fleet of 26 supports, and its estimate of the charging time, over the run."""
    mission = FleetEnergy()
    trace: list[tuple[float, float, float]] = []
    run(
        mission, seed=seed, policy="one-by-one", **PLAYS["26 robots, charge believed short"],
        watch=lambda world, row: trace.append((world.time / 6.0, len(mission.taken), mission.charge / 6.0)),
    )  # fmt: skip
    minutes, jobs, charge = np.array(trace[1:]).T
    above, below = figure.subplots(2, 1, sharex=True)
    above.step(minutes, jobs, color=COLOURS[0], where="post")
    above.set_ylim(0, 3.5)
    below.plot(minutes, charge, color=COLOURS[3])
    below.axhline(40.0, color=COLOURS[8], linestyle=":", linewidth=1.0)
    below.set_ylim(0, 45)
    below.set_xlabel("minutes", fontsize=9)
    plain(above, "jobs for ever that are supported")
    plain(below, "charging time, minutes: estimate, and the true mean")
