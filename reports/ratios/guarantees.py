"""Studies of stated guarantees: every configuration of a heuristic on every family, observed ratios beside stated ones."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...formulations.problem import Problem
from ...instances.errors import CheckFailedError
from ..studies.findings import Finding
from ..studies.processes import spread
from ..studies.study import STUDIES, Fault, Report, Study, StudySetting, thinned
from ..studies.violations import instance_of
from ..tables.table import Column, Table
from .families import Family
from .judged_runs import Configuration, Run, audit, judge, ratio_of, run_heuristic

CHUNK = 50
"""Instances of one task: a few tenths of a second of work."""

AUDIT_EVERY = 250
"""Every so many instances of a family also go through ``solve``, and their certificates through the checker; the first always does."""

FALSE_ALARM = 1e-9
"""Probability with which one test reports a true guarantee in expectation as broken."""


@dataclass(frozen=True)
class GuaranteePlan:
    """The configurations of a study of guarantees, and the families that they run on."""

    configurations: tuple[Configuration, ...]
    families: tuple[Family, ...]


@dataclass
class Chunk:
    """The runs on some instances of one family, by configuration: (index, value, optimum, ratio, stated, bound) each."""

    family: int
    runs: dict[int, list[tuple[int, float, float, float, float | None, float | None]]] = field(default_factory=dict)
    faults: list[Fault] = field(default_factory=list)
    num_faults: dict[int, int] = field(default_factory=dict)  # by configuration; -1 for instances without an optimum
    audited: int = 0


def guarantee_study(
    name: str,
    summary: str,
    instances: int,
    configurations: Iterable[Configuration],
    families: Iterable[Family],
    *,
    source: str = "",
    claim: str = "",
) -> Study:
    """Make a study of guarantees and register it; ``source`` and ``claim`` say whose theorem it tests."""
    plan = GuaranteePlan(tuple(configurations), tuple(families))

    def run(setting: StudySetting) -> Report:
        report = run_plan(name, summary, plan, setting)
        if not source or not report.rows:
            return report
        worst = max((row["used"] for row in report.rows if row["used"] is not None), default=0.0)
        ours = f"{len(report.observations):,} results: {report.num_faults} beyond it, at most {worst:.0%} of the stated loss"
        return replace(report, findings=(Finding.of_fact("stated ratio", claim, ours, not report.num_faults),))

    return STUDIES.add(name, Study(name, summary, instances, run, plan=plan, source=source, claim=claim))


def run_plan(name: str, summary: str, plan: GuaranteePlan, setting: StudySetting) -> Report:
    """Work through a plan; see ``Study.run``."""
    random = [family for family in plan.families if family.size is None]
    each = math.ceil(setting.instances / len(random)) if random else 0
    tasks = [
        (name, number, first, min(CHUNK, family.count(each) - first), setting.seed)
        for number, family in enumerate(plan.families)
        for first in range(0, family.count(each), CHUNK)
    ]
    tasks.sort(key=lambda task: task[2])  # all families alike, so that an interrupt leaves something of each
    if name in STUDIES and STUDIES[name].plan is plan:
        done = spread(measure_of, tasks, setting.jobs, setting.told, lambda task: plan.families[task[1]].name)
    else:  # a plan that no other process could look up
        own = [(plan, *task[1:]) for task in tasks]
        done = spread(measure, own, 1, setting.told, lambda task: plan.families[task[1]].name)
    chunks = [chunk for chunk in done.results if chunk is not None]
    return _report(name, summary, plan, chunks, setting, len(tasks), done.interrupted)


def measure_of(study: str, family: int, first: int, count: int, seed: int) -> Chunk:
    """``measure`` for the plan of a registered study."""
    return measure(STUDIES[study].plan, family, first, count, seed)


def measure(plan: GuaranteePlan, family: int, first: int, count: int, seed: int) -> Chunk:
    """Run every configuration on ``count`` instances of a family, from number ``first`` on."""
    chunk = Chunk(family)
    for k in range(first, first + count):
        case = plan.families[family].case(k, seed)
        try:
            best = case.solved()
        except CheckFailedError as error:
            chunk.num_faults[-1] = chunk.num_faults.get(-1, 0) + 1
            chunk.faults.append(Fault("optimum", str(error), instance_of(case.problem, str(error))))
            continue
        for number, configuration in enumerate(plan.configurations):
            if not configuration.takes(case.problem):
                continue
            repeats = configuration.repeats * (plan.families[family].effort if configuration.repeats > 1 else 1)
            run, faults = measure_one(case.problem, best, configuration, [seed, number, k], repeats, audited=k % AUDIT_EVERY == 0)
            chunk.audited += k % AUDIT_EVERY == 0
            if run is not None:
                chunk.runs.setdefault(number, []).append((k, run.value, run.optimum, run.ratio, run.stated, run.bound))
            for kind, message in faults:
                chunk.num_faults[number] = chunk.num_faults.get(number, 0) + 1
                text = f"{configuration.label} on {case.problem.name}: {message}"
                chunk.faults.append(Fault(kind, text, instance_of(case.problem, text), configuration.label))
        chunk.faults = list(thinned(chunk.faults))
    return chunk


def measure_one(
    problem: Problem, best: Any, configuration: Configuration, seed: Sequence[int], repeats: int = 1, *, audited: bool = False
) -> tuple[Run | None, tuple[tuple[str, str], ...]]:
    """One configuration on one instance: its run (the mean of ``repeats``), None if it fails, and its faults."""
    rng = np.random.default_rng(list(seed))
    options, expected = configuration.chosen(problem, rng), configuration.expected(problem)
    seeds = rng.integers(0, 2**31, repeats).tolist()
    many = repeats > 1
    runs, faults = [], []
    for repeat, own in enumerate(seeds):
        try:
            outcome = run_heuristic(problem, configuration.heuristic, options, own)
        except Exception as error:
            return None, (("error", f"{type(error).__name__}: {error}"),)
        runs.append(judge(problem, best, outcome, expected, in_expectation=many))
        found = (*runs[-1].faults, *configuration.checks(problem, options, own, outcome))
        faults += [fault for fault in found if fault not in faults]
        if audited and repeat == 0:
            faults += audit(problem, configuration.heuristic, options, own, best, outcome)
    if not many:
        return runs[0], tuple(faults)
    mean = math.fsum(run.value for run in runs) / len(runs)
    bounds = [run.bound for run in runs if run.bound is not None]
    mean_run = replace(runs[0], value=mean, ratio=ratio_of(problem.sense, mean, best.value), bound=min(bounds, default=None))
    low = _mean_fault(mean_run, len(runs))
    return mean_run, (*faults, *((low,) if low else ()))


def _mean_fault(run: Run, repeats: int) -> tuple[str, str] | None:
    """The fault of a mean of ``repeats`` values in [0, optimum] that breaks its guarantee, by Hoeffding's bound."""
    if run.stated is None or run.optimum <= 0:
        return None
    share, margin = run.value / run.optimum, hoeffding_margin(repeats)
    if share + margin < 1.0 / run.stated:
        return (
            "ratio",
            f"mean of {repeats} runs {share:.6g} of the optimum, stated {1.0 / run.stated:.6g} in expectation, margin {margin:.3g}",
        )
    return None


def hoeffding_margin(count: int) -> float:
    """Shortfall of a mean of ``count`` independent numbers of [0, 1] that is passed with probability ``FALSE_ALARM`` at most."""
    return math.sqrt(math.log(1.0 / FALSE_ALARM) / (2.0 * count))


# -- from chunks to a report ------------------------------------------------------------------------------------------


def _report(
    name: str, summary: str, plan: GuaranteePlan, chunks: Sequence[Chunk], setting: StudySetting, asked: int, interrupted: bool
) -> Report:
    rows, observations = [], []
    faults = [fault for chunk in chunks for fault in chunk.faults]
    total = sum(sum(chunk.num_faults.values()) for chunk in chunks)
    for number, configuration in enumerate(plan.configurations):
        for place, family in enumerate(plan.families):
            own = [chunk for chunk in chunks if chunk.family == place]
            runs = [run for chunk in own for run in chunk.runs.get(number, ())]
            broken = sum(chunk.num_faults.get(number, 0) for chunk in own)
            if not runs and not broken:
                continue
            row = _row(configuration, family, runs, broken)
            low = _pooled_fault(configuration, family, runs)
            if low is not None:
                faults.append(low)
                total, row["violations"] = total + 1, broken + 1
            rows.append(row)
            keys = ("instance", "value", "optimum", "ratio", "stated", "bound")
            observations += [{"heuristic": configuration.label, "family": family.name, **dict(zip(keys, run, strict=True))} for run in runs]
    audited = sum(chunk.audited for chunk in chunks)
    notes = [f"the same again: waybound ratio {name} --instances {setting.instances} --seed {setting.seed}"]
    if audited:
        notes.append(f"{audited} runs went through solve, and their certificates through the checker")
    if any(configuration.repeats > 1 for configuration in plan.configurations):
        notes.append(
            "a guarantee in expectation: each case counts with its mean over the runs (cases x runs); a violation is a mean, of a case or "
            f"of a family, below the stated share by more than Hoeffding's margin (probability {FALSE_ALARM:g} if the guarantee is true)"
        )
    from .figures import ratio_figure

    return Report(
        name, summary, ratio_table(name, rows), tuple(rows), tuple(observations), thinned(faults), total,
        (ratio_figure(name, summary, rows, observations),) if rows else (), tuple(notes), len(chunks), asked, interrupted,
    )  # fmt: skip


def _row(configuration: Configuration, family: Family, runs: Sequence[Any], broken: int) -> dict[str, Any]:
    """Summary of the runs of one configuration on one family; ratios may be infinite, for a value of 0.

    ``used`` is the largest share of the stated loss: (ratio - 1) / (stated - 1), 1 where it is attained.
    """
    ratios = np.array([run[3] for run in runs] or [math.nan])
    stated = np.array([run[4] for run in runs if run[4] is not None])
    both = np.array([(run[3] - 1.0) / (run[4] - 1.0) for run in runs if run[4] is not None and run[4] > 1.0])
    bounds = [run[5] / run[1] for run in runs if run[5] is not None and run[1] > 0 and math.isfinite(run[5])]
    return {
        "heuristic": configuration.label,
        "family": family.name,
        "instances": len(runs),
        "repeats": configuration.repeats * (family.effort if configuration.repeats > 1 else 1),
        "min_ratio": float(ratios.min()),
        "mean_ratio": float(ratios.mean()),
        "max_ratio": float(ratios.max()),
        "least_share": float(1.0 / ratios.max()),
        "stated_min": float(stated.min()) if len(stated) else None,
        "stated_max": float(stated.max()) if len(stated) else None,
        "used": float(both.max()) if len(both) else None,
        "certified_mean": float(np.mean(bounds)) if bounds else None,
        "violations": broken,
    }


def _pooled_fault(configuration: Configuration, family: Family, runs: Sequence[Any]) -> Fault | None:
    """The fault of a guarantee in expectation whose mean share over all instances is below the mean of the stated shares."""
    if configuration.repeats == 1:
        return None
    pairs = [(run[1] / run[2], 1.0 / run[4]) for run in runs if run[4] is not None and run[2] > 0]
    if not pairs:
        return None
    got, owed = np.mean(pairs, axis=0)
    margin = hoeffding_margin(len(pairs) * configuration.repeats * family.effort)
    if got + margin >= owed:
        return None
    seen = f"{got:.6g} of the optimum over {len(pairs)} instances"
    text = f"{configuration.label} on {family.name}: {seen}, stated {owed:.6g}, margin {margin:.3g}"
    return Fault("ratio", text, None, configuration.label)


def ratio_table(name: str, rows: Sequence[dict[str, Any]]) -> Table:
    """Observed ratios OPT/ALG beside stated ones; a single stated one also as its share ALG/OPT, as in papers."""
    columns = (
        Column("heuristic"), Column("family"), Column("cases", right=True), Column("min", right=True), Column("mean", right=True),
        Column("max", right=True), Column("stated", right=True), Column("used", right=True), Column("ALG/OPT", right=True),
        Column("faults", right=True),
    )  # fmt: skip
    body = tuple(
        (
            row["heuristic"], row["family"], str(row["instances"]) + (f" x {row['repeats']}" if row["repeats"] > 1 else ""),
            _digits(row["min_ratio"]), _digits(row["mean_ratio"]), _digits(row["max_ratio"]), _range(row["stated_min"], row["stated_max"]),
            "-" if row["used"] is None else f"{100 * row['used']:.1f} %", _digits(row["least_share"]), str(row["violations"]),
        )
        for row in rows
    )  # fmt: skip
    return Table(f"{name}: ratios of the optimum to the value", columns, body)


def _digits(value: float | None) -> str:
    return "-" if value is None or math.isnan(value) else ("inf" if math.isinf(value) else f"{value:.4f}")


def _range(low: float | None, high: float | None) -> str:
    if low is None or high is None:
        return "none"
    return f"{_digits(low)} ({1.0 / low:.4f})" if high - low <= 5e-5 else f"{_digits(low)} to {_digits(high)}"
