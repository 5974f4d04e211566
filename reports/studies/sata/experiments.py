"""Experiments on random sensing graphs: several methods on the same graphs, along one parameter after the other.

Optimum, rounding, greedy, local algorithm and random choice, after Sung (2019), figures 3.6 to 3.8.
"""

import math
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ....formulations.problem import Problem
from ....formulations.sata.bottleneck_sata import BottleneckSATA
from ....formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from ....instances.errors import CheckFailedError, UsageError
from ....instances.generating import generate
from ....instances.sata.sensing_graph import SensingGraph
from ...ratios.figures import sweep_figure
from ...ratios.judged_runs import TOLERANCE, judge, run_heuristic
from ...ratios.optimum import Optimum
from ...tables.table import Column, Table
from ..findings import LOST, Finding
from ..frames import mean_interval
from ..processes import spread
from ..study import STUDIES, Fault, Report, Study, StudySetting, thinned

CHUNK = 5
"""Trials of one task."""

ATTEMPTS = 1000
"""Seeds that are tried for one graph: the generator refuses those whose edges do not suffice to connect it."""

WITH_RANGES, WITH_DEVIATIONS = 4, 7
"""Up to so many methods fit side by side with their ranges, and with their deviations."""

Measured = tuple[dict[str, float], list[tuple[str, str]]]
Measure = Callable[[SensingGraph, int], Measured]


@dataclass(frozen=True)
class Sweep:
    """One parameter, ``robots``, ``targets`` or ``phi``, that takes ``values`` while the others stay ``fixed``."""

    key: str
    values: tuple[float, ...]
    fixed: Mapping[str, float]

    @property
    def axis(self) -> str:
        """Label of the horizontal axis."""
        return {"robots": "robots", "targets": "targets", "phi": "density phi of the sensing graph (%)"}[self.key]

    @property
    def title(self) -> str:
        """The parameters that stay, in words."""
        return ", ".join(f"phi = {value:g} %" if key == "phi" else f"{value:g} {key}" for key, value in self.fixed.items())

    def point(self, k: int) -> dict[str, float]:
        """All parameters at the k-th value."""
        return {"actions": 2, **self.fixed, self.key: self.values[k]}


@dataclass(frozen=True)
class ExperimentPlan:
    """The methods of an experiment, and the sweeps in which they are measured.

    ``measure(graph, seed)`` returns a value, the ``quantity``, for each of the ``methods``, and faults as (kind, message). Of two methods
    in ``orders`` the value of the first is never above that of the second; of two in ``shares`` mean and least of first over second are
    shown. In ``leads`` the source says (claim) that the first of two methods is better, in ``alike`` that two differ by a share at most.
    ``groups`` are panels of their own in the figure, as (title, methods); by default all methods stand in one.
    """

    sweeps: tuple[Sweep, ...]
    methods: tuple[str, ...]
    measure: Measure
    orders: tuple[tuple[str, str], ...]
    quantity: str
    shares: tuple[tuple[str, str], ...] = ()
    groups: tuple[tuple[str, tuple[str, ...]], ...] = ()
    notes: tuple[str, ...] = field(default=())
    leads: tuple[tuple[str, str, str], ...] = ()
    alike: tuple[tuple[str, str, float], ...] = ()


def experiment(name: str, summary: str, trials: int, source: str, claim: str, plan: ExperimentPlan) -> Study:
    """Make a study of an experiment and register it."""
    study = Study(
        name, summary, trials, lambda setting: run_experiment(name, summary, plan, setting), guarantees=False, plan=plan, short=2,
        source=source, claim=claim,
    )  # fmt: skip
    return STUDIES.add(name, study)


def run_experiment(name: str, summary: str, plan: ExperimentPlan, setting: StudySetting) -> Report:
    """Play all points of a plan, and report them."""
    tasks = [
        (name, sweep, point, first, min(CHUNK, setting.instances - first), setting.seed)
        for sweep, one in enumerate(plan.sweeps)
        for point in range(len(one.values))
        for first in range(0, setting.instances, CHUNK)
    ]
    tasks.sort(key=lambda task: task[3])  # all points alike, so that an interrupt leaves something of each

    def what(task: Any) -> str:
        return f"{plan.sweeps[task[1]].key} = {plan.sweeps[task[1]].values[task[2]]:g}"

    done = spread(trials_of, tasks, setting.jobs, setting.told, what)
    results = [result for result in done.results if result is not None]
    return _report(name, summary, plan, [row for rows, _ in results for row in rows], [f for _, fs in results for f in fs],
                   len(results), len(tasks), done.interrupted)  # fmt: skip


def trials_of(study: str, sweep: int, point: int, first: int, count: int, seed: int) -> tuple[list[dict[str, Any]], list[Fault]]:
    """Some trials of one point of a registered experiment: the values of every method, and the faults."""
    plan: ExperimentPlan = STUDIES[study].plan
    rows, faults = [], []
    for trial in range(first, first + count):
        # The sweep is no part of the seed: where two sweeps meet, they have the same graphs.
        parameters = plan.sweeps[sweep].point(point)
        graph, own = sensing_graph(parameters, seed, trial)
        values, messages = plan.measure(graph, own)
        messages = [*messages, *_order_faults(plan, values)]
        faults += [Fault(kind, f"{study} on {graph.name}: {message}", graph.with_notes(message)) for kind, message in messages]
        rows.append({"sweep": sweep, "point": point, "trial": trial, "graph_seed": own, **values})
    return rows, faults


def sensing_graph(parameters: Mapping[str, float], seed: int, trial: int) -> tuple[SensingGraph, int]:
    """The graph of one trial, and the seed that the generator took for it: the first that it does not refuse; raises UsageError if it
    refuses all."""
    shape = {key: value if key == "phi" else int(value) for key, value in sorted(parameters.items())}
    rng = np.random.default_rng([seed, zlib.crc32(repr(sorted(shape.items())).encode()), trial])
    for _ in range(ATTEMPTS):
        own = int(rng.integers(0, 2**31))
        try:
            graph = generate("sata", own, **shape)
        except UsageError as error:
            refusal = error
            continue
        assert isinstance(graph, SensingGraph)
        return graph, own
    raise refusal


def solved(problem: Problem) -> Optimum:
    """The optimum by HiGHS through ``solve``, which checks answer and bound; raises CheckFailedError where it is not proved in time."""
    from ....solving.request import Request
    from ....solving.solve import solve

    solution = solve(problem, Request(solver="highs", bound_time=0.0))
    if solution.faults:
        raise CheckFailedError(f"highs on {problem.name}: {'; '.join(solution.faults)}")
    if solution.status != "optimal" or not isinstance(solution.objective, float):
        raise CheckFailedError(f"highs did not find the optimum of {problem.name}: status {solution.status}, limit {solution.limit}")
    return Optimum(solution.objective, solution.answer, "highs")


def _order_faults(plan: ExperimentPlan, values: Mapping[str, float]) -> list[tuple[str, str]]:
    return [
        ("order", f"{low} has {values[low]!r}, more than {high} with {values[high]!r}")
        for low, high in plan.orders
        if values[low] > values[high] + TOLERANCE * max(1.0, abs(values[high]))
    ]


# -- from trials to a report ------------------------------------------------------------------------------------------


def _report(
    name: str, summary: str, plan: ExperimentPlan, trials: Sequence[dict[str, Any]], faults: Sequence[Fault], done: int, asked: int,
    interrupted: bool,
) -> Report:  # fmt: skip
    rows, table, panels = [], [], []
    shown = "range" if len(plan.methods) <= WITH_RANGES else "deviation" if len(plan.methods) <= WITH_DEVIATIONS else "mean"
    for place, sweep in enumerate(plan.sweeps):
        drawn = []
        for point, x in enumerate(sweep.values):
            own = [row for row in trials if row["sweep"] == place and row["point"] == point]
            if not own:
                continue
            cells = [f"{sweep.key} = {x:g}", str(len(own))]
            for method in plan.methods:
                values = np.array([row[method] for row in own])
                spread_of = float(values.std(ddof=1)) if len(values) > 1 else 0.0
                row = {"sweep": sweep.key, "x": x, "method": method, "trials": len(own), "min": float(values.min()),
                       "mean": float(values.mean()), "std": spread_of, "max": float(values.max())}  # fmt: skip
                rows.append({**row, **sweep.point(point)})
                drawn.append(row)
                cells.append(_cell(row, shown))
            for low, high in plan.shares:
                share = np.array([row[low] / row[high] for row in own if row[high] > 0])
                cells.append(f"{share.mean():.3f} ({share.min():.3f})" if len(share) else "-")
            table.append(tuple(cells))
        groups = plan.groups or (("", plan.methods),)
        panels += [(sweep.axis, ", ".join(t for t in (sweep.title, title) if t), methods, drawn) for title, methods in groups if drawn]
    heads = [Column("point", right=True), Column("trials", right=True), *(Column(method, right=True) for method in plan.methods)]
    heads += [Column(f"{low}/{high}", right=True) for low, high in plan.shares]
    words = {"range": "mean (least..most)", "deviation": "mean (deviation)", "mean": "mean"}[shown]
    title = f"{name}: {plan.quantity}, {words}" + ("; quotients, mean (least)" if plan.shares else "")
    observations = [
        {"sweep": plan.sweeps[row["sweep"]].key, **plan.sweeps[row["sweep"]].point(row["point"]), "trial": row["trial"],
         "graph_seed": row["graph_seed"], **{method: row[method] for method in plan.methods}}
        for row in trials
    ]  # fmt: skip
    figure = sweep_figure(name, f"{name}: {summary}", panels, plan.quantity) if rows else None
    return Report(
        name, summary, Table(title, tuple(heads), tuple(table)), tuple(rows), tuple(observations),
        thinned(faults), len(faults), () if figure is None else (figure,), plan.notes, done, asked, interrupted,
        findings=tuple(_findings(plan, trials)),
    )  # fmt: skip


def _findings(plan: ExperimentPlan, trials: Sequence[dict[str, Any]]) -> list[Finding]:
    """The source's claims for each value of each parameter, trial by trial."""
    findings = [Finding("values of the figure", "plotted", "see the table", LOST, "the plots' numbers and most swept values are lost")]
    for place, sweep in enumerate(plan.sweeps):
        at = {
            f"{sweep.key} {x:g}": own for point, x in enumerate(sweep.values)
            if (own := [row for row in trials if row["sweep"] == place and row["point"] == point])
        }  # fmt: skip
        for better, worse, claim in plan.leads:
            leads = [(label, *mean_interval([row[better] - row[worse] for row in own])) for label, own in at.items()]
            said = f"mean leads {min(lead for _, lead, _ in leads):.3g} to {max(lead for _, lead, _ in leads):.3g}"
            findings.append(Finding.of_points(f"{better} above {worse}, over {sweep.key}", claim, leads, said, "see the table"))
        for one, other, most in plan.alike:
            apart = {label: mean_interval([row[one] - row[other] for row in own]) for label, own in at.items()}
            base = {label: float(np.mean([row[other] for row in own])) or 1.0 for label, own in at.items()}
            points = [(label, most - abs(gap) / base[label], half / base[label]) for label, (gap, half) in apart.items()]
            said = f"at most {max(abs(gap) / base[label] for label, (gap, _) in apart.items()):.1%} apart in the mean"
            findings.append(Finding.of_points(f"{one} within {most:.0%} of {other}, over {sweep.key}", "alike", points, said))
    return findings


def _cell(row: Mapping[str, Any], shown: str) -> str:
    further = {"range": f" ({row['min']:.3g}..{row['max']:.3g})", "deviation": f" ({row['std']:.2f})", "mean": ""}[shown]
    return f"{row['mean']:.3f}{further}"


# -- the experiments -----------------------------------------------------------------------------------------------------

ANY_RATIO = (1.0, math.inf)
"""The additive search states the eps that its step amounts to."""

LOCAL = {"search": "step", "step": 0.1, "ball": False}
"""As in the thesis: levels lowered in steps of 0.1."""

HEIGHTS = (1, 2, 5, 8)
SHARES = tuple(f"h={h}" for h in HEIGHTS)
ROUNDED = tuple(f"h={h} whole" for h in HEIGHTS)


def winner_takes_all(graph: SensingGraph, seed: int) -> Measured:
    """Covered targets of each method on one graph."""
    problem = WinnerTakesAllSATA(graph)
    best = solved(problem)
    greedy = judge(problem, best, run_heuristic(problem, "sequential-greedy", {}, seed), expected=2.0)
    random = judge(problem, best, run_heuristic(problem, "random", {}, seed))
    values = {"exact": best.value, "greedy": greedy.value, "random": random.value}
    return values, [*greedy.faults, *random.faults]


def bottleneck(graph: SensingGraph, seed: int) -> Measured:
    """Coverage of the worst-covered target by each method on one graph."""
    whole, shares = BottleneckSATA(graph), BottleneckSATA(graph, fractional=True)
    best, relaxed = solved(whole), solved(shares)
    rounded = judge(whole, best, run_heuristic(whole, "lp-rounding", {}, seed))
    local = judge(shares, relaxed, run_heuristic(shares, "local", {"h": 2, **LOCAL}, seed), expected=ANY_RATIO)
    local_whole = judge(whole, best, run_heuristic(whole, "local", {"h": 2, **LOCAL}, seed))
    random = judge(whole, best, run_heuristic(whole, "random", {}, seed))
    values = {
        "LP": relaxed.value, "ILP": best.value, "LP rounded": rounded.value, "local": local.value, "local rounded": local_whole.value,
        "random": random.value,
    }  # fmt: skip
    return values, [fault for run in (rounded, local, local_whole, random) for fault in run.faults]


def layers(graph: SensingGraph, seed: int) -> Measured:
    """Coverage of the worst-covered target by the local algorithm of each height, before and after rounding."""
    whole, shares = BottleneckSATA(graph), BottleneckSATA(graph, fractional=True)
    best, relaxed = solved(whole), solved(shares)
    values, faults = {"LP": relaxed.value, "ILP": best.value}, []
    for h in HEIGHTS:
        fractional = judge(shares, relaxed, run_heuristic(shares, "local", {"h": h, **LOCAL}, seed), expected=ANY_RATIO)
        rounded = judge(whole, best, run_heuristic(whole, "local", {"h": h, **LOCAL}, seed))
        values[f"h={h}"], values[f"h={h} whole"] = fractional.value, rounded.value
        faults += [*fractional.faults, *rounded.faults]
    return values, faults


experiment(
    "winner-takes-all",
    "optimum, greedy and random choice on random sensing graphs",
    100,
    "Sung (2019), section 3.5.1, Fig. 3.6",
    "greedy is close to the optimum and always above random choice, whose gap closes with the density",
    ExperimentPlan(
        sweeps=(
            Sweep("robots", (4, 8, 12, 16, 20), {"targets": 50, "phi": 15.0}),
            Sweep("targets", (25, 50, 75, 100, 150), {"robots": 8, "phi": 15.0}),
            Sweep("phi", (15.0, 20.0, 25.0, 30.0, 40.0, 50.0), {"robots": 8, "targets": 50}),
        ),
        methods=("exact", "greedy", "random"),
        measure=winner_takes_all,
        orders=(("greedy", "exact"), ("random", "exact")),
        quantity="covered targets",
        shares=(("greedy", "exact"), ("random", "exact")),
        leads=(("greedy", "random", "always above"),),
        alike=(("greedy", "exact", 0.05),),
        notes=(
            "after figure 3.6 of Sung (2019), whose swept values and numbers are not in its text; binary weights, two actions a robot",
            "exact: HiGHS; greedy: robot after robot in order, stated 1/2; random: one draw a trial",
        ),
    ),
)
experiment(
    "bottleneck",
    "whole actions, shares, rounding, local algorithm and random choice",
    100,
    "Sung (2019), section 3.5.1, Fig. 3.7",
    "the optimum and the rounded linear program beat the local algorithm in all cases",
    ExperimentPlan(
        sweeps=(
            Sweep("robots", (4, 8, 12, 16, 20), {"targets": 50, "phi": 15.0}),
            Sweep("phi", (15.0, 20.0, 25.0, 30.0, 40.0), {"robots": 12, "targets": 50}),
            Sweep("targets", (25, 50, 75, 100), {"robots": 12, "phi": 15.0}),
        ),
        methods=("LP", "ILP", "LP rounded", "local", "local rounded", "random"),
        measure=bottleneck,
        orders=(("ILP", "LP"), ("LP rounded", "ILP"), ("local", "LP"), ("local rounded", "ILP"), ("random", "ILP")),
        quantity="coverage of the worst target",
        leads=(("ILP", "local rounded", "better"), ("LP rounded", "local rounded", "better"), ("LP rounded", "local", "better")),
        notes=(
            "after figure 3.7 of Sung (2019), whose numbers are not in its text; binary weights, two actions a robot",
            "ILP, LP: HiGHS; LP rounded: each robot takes its largest share, the last of equal ones; local: h = 2, step 0.1, "
            "shares; local rounded: the same, rounded likewise",
            "nothing is guaranteed after rounding; 0 means that some target is not covered",
        ),
    ),
)
experiment(
    "layers",
    "effect of the number of layers h on the local algorithm",
    100,
    "Sung (2019), section 3.5.1, Fig. 3.8",
    "no evident difference between 5 and 8 layers, with or without rounding",
    ExperimentPlan(
        sweeps=(Sweep("robots", (4, 8, 12, 16, 20), {"targets": 50, "phi": 15.0}),),
        methods=("LP", *SHARES, "ILP", *ROUNDED),
        measure=layers,
        orders=(("ILP", "LP"), *((h, "LP") for h in SHARES), *((h, "ILP") for h in ROUNDED)),
        quantity="coverage of the worst target",
        groups=(("shares", ("LP", *SHARES)), ("rounded", ("ILP", *ROUNDED))),
        alike=(("h=8", "h=5", 0.05), ("h=8 whole", "h=5 whole", 0.2)),
        notes=(
            "after figure 3.8 of Sung (2019), whose numbers are not in its text; 50 targets, phi = 15 %, two actions a robot, step 0.1",
            "the guarantee improves with h, values need not: they are not monotone in h, and nothing is guaranteed after rounding",
        ),
    ),
)
