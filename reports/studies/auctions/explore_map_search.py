"""Exploring, mapping and searching after Zhang (2015), chapter 5: its trends, what relays gain, and what planning in the loop loses."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ....instances.auctions.beliefs import TARGET
from ....instances.auctions.worlds.explore_map_search import WEIGHTS
from ....solving.request import Request
from ....solving.solve import solve
from ...missions.auctions.explore_map_search import ExploreMapSearch, most_gain
from ...plots.drawing import COLOURS, plain
from ..findings import LOST, Finding
from ..frames import HALF, apart, completed, decision_times, film_of, frame_table, framed, intervals, mean_interval, times_apart
from ..processes import called, spread
from ..study import Clip, Fault, Report, StudySetting, figure, study, thinned

if TYPE_CHECKING:
    import pandas as pd

GAINS = ("exploring", "mapping", "searching")

KEPT = ("utility", *GAINS, "entered", "types_known", "targets_known", "brier", "brier_marginal")

EMPHASES = {"explore": (0.9, 0.05, 0.05), "map": (0.05, 0.9, 0.05), "search": (0.05, 0.05, 0.9)}
"""Weights of exploring, mapping and searching of Fig. 5.3, with 2 robots."""

POLICIES = ("relays", "alone")

SWEEPS: dict[str, tuple[Any, ...]] = {
    "weights": tuple(EMPHASES), "policy": (3,), "robots": (2, 3, 4, 5), "silence": (0, 1, 2, 3, 4), "gain": ("entropy",),
    "update": ("marginal",),
}  # fmt: skip
"""Levels of Figs. 5.3 to 5.6, and the source's gain and update. The team of the second and fourth, 3 here, is lost."""

SMALL: dict[str, Any] = {"rooms": 8, "robots": 2, "silence": 0, "range": 1, **dict(zip(WEIGHTS, (0.8, 0.1, 0.1), strict=True))}

BUDGETS = {True: 8, False: 5}
"""In small buildings, in the full and the short form."""

EXACT = "exact, 4 steps ahead"

LOOPS: dict[str, dict[str, Any]] = {
    "exact, all steps at once": {"solver": "highs", "horizon": 1000, "replan": 1000},
    EXACT: {"solver": "highs", "horizon": 4, "replan": 2},
    "exact, 2 steps ahead": {"solver": "highs", "horizon": 2, "replan": 2},
    "heard-greedy, 4 steps ahead": {"heuristic": "heard-greedy", "horizon": 4, "replan": 2},
    "relays": {"policy": "relays"},
    "alone": {"policy": "alone"},
}
"""Deciders in small buildings."""

EVERY = 10
"""Steps between the utilities that are kept of a run."""

NOTES = (
    "the source's map, ranges, limits of silence and plotted numbers are lost; intervals are of confidence 95 % over drawn buildings",
    "exploring, mapping and searching are sums of gains before they are weighted; with gain entropy, of entropies",
    "brier: mean squared error of a target's probability, by what the base was told, with joint beliefs and with marginals in turn",
    "the bound takes each reading for as much as its sensor can tell under any belief, and lets robots go home after their budget",
)

LOOPED = "Small buildings: percent below the bound, and points lost against exact plans"

STUCK = "robots look one step ahead: where they may go alone they ask for no relays, and they turn back when their silence ends"


def swept(seed: int, sweep: str, level: Any, policy: str) -> list[dict[str, Any]]:
    """One run of 100 steps."""
    weights = EMPHASES.get(level, (0.8, 0.1, 0.1) if sweep == "policy" else (0.3, 0.3, 0.4))
    settings: dict[str, Any] = {"robots": 2 if sweep == "weights" else 3, **dict(zip(WEIGHTS, weights, strict=True))}
    if sweep not in ("weights", "policy"):
        settings[sweep] = level
    mission = ExploreMapSearch()
    log = completed(mission, policy=policy, seed=seed, **settings)
    last = log.iloc[-1]
    kept = {key: float(last[key]) for key in KEPT[:-2]}
    at = {f"at{step}": float(log["utility"].iloc[step - 1]) for step in range(EVERY, len(log) + 1, EVERY)}
    limits = {"silent": float(log["silent"].max()), "silence": mission.played.building.silence, "steps": len(log), "budget": 100}
    return [{"sweep": sweep, "level": level, "policy": policy, "seed": seed, **kept, **at, **limits, **brier(mission)}]


def brier(mission: ExploreMapSearch) -> dict[str, float]:
    """Mean squared error of the probability of a target by all readings, with joint beliefs and with marginals updated in turn."""
    w, scores = mission.played, {}
    for update, name in (("joint", "brier"), ("marginal", "brier_marginal")):
        mission.values["update"] = update
        believed = mission.known(w.observe(), -1)[0].sum(axis=1)[:, TARGET]
        scores[name] = float(((believed - w.targets) ** 2).mean())
    return scores


def looped(seed: int, budget: int) -> list[dict[str, Any]]:
    """All of ``LOOPS`` in one small building."""
    rows: list[dict[str, Any]] = []
    relaxed = most_gain(ExploreMapSearch().world(seed, budget=budget, **SMALL))
    bound = solve(relaxed, Request(solver="highs", time_limit=60.0)).bound
    assert isinstance(bound, float)
    for method, how in LOOPS.items():
        log = completed("explore-map-search", seed=seed, budget=budget, **SMALL, **how)
        utility = float(log["utility"].iloc[-1])
        rows.append(
            {"method": method, "seed": seed, "utility": utility, "bound": bound, "below": 100.0 * (1.0 - utility / bound),
             "silent": float(log["silent"].max()), "silence": SMALL["silence"], "steps": len(log), "budget": budget,
             "contradictions": len(log.attrs["faults"]), **decision_times(log)}
        )  # fmt: skip
    return rows


@study(
    "explore-map-search",
    "teams that explore, map and search rooms: weights, relays, team size, silence, and planning in the loop against a bound",
    100,
    short=2,
    source="Zhang (2015), chapter 5, Figs. 5.3 to 5.6",
    claim="each weight gains its own utility; relays gain no less than robots alone; utility grows with the team and with the silence",
)
def explore_map_search(setting: StudySetting) -> Report:
    each = [
        (sweep, level, policy)
        for sweep, levels in SWEEPS.items()
        for level in levels[:: 1 if setting.full or sweep == "weights" else 2]
        for policy in (POLICIES if sweep in ("policy", "robots", "silence") else POLICIES[:1])
    ]
    looped_too = setting.seeds if setting.full else setting.seeds[:1]
    tasks = [
        one
        for seed in setting.seeds
        for one in ([(looped, seed, BUDGETS[setting.full])] if seed in looped_too else []) + [(swept, seed, *rest) for rest in each]
    ]
    done = spread(called, tasks, setting.jobs, setting.told, lambda t: f"seed {t[1]}: {t[0].__name__} {' '.join(map(str, t[2:]))}")
    played, times = times_apart(done.rows)
    sweeps, loops = (framed(played, key) for key in ("sweep", "method"))
    rows, faults = means(sweeps, ["sweep", "level", "policy"], KEPT), broken(played)
    lost = means(loops, ["method"], ("utility", "below"))
    for row in lost:
        row["lost"], row[f"lost{HALF}"] = apart(loops, "below", row["method"], EXACT)
    film = film_of(ExploreMapSearch(), setting.seed, policy="relays", steps=40, robots=4, silence=0)
    return Report(
        "explore-map-search", explore_map_search.summary, frame_table("After 100 steps: means", rows), tuple(rows), tuple(played),
        thinned(faults), len(faults), figures=(sweeps_figure(sweeps),) if len(sweeps) else (), notes=NOTES,
        findings=tuple(findings(sweeps)), further=(frame_table(LOOPED, lost), times),
        clips=(Clip(lambda: film, "four robots that must always be heard: some relay what others read"),), **done.progress(),
    )  # fmt: skip


def means(runs: pd.DataFrame, by: list[str], keys: Sequence[str]) -> list[dict[str, Any]]:
    """Means of ``keys`` with their intervals, a row for each value of the columns ``by``."""
    return [
        {**dict(zip(by, map(str, names), strict=True)), "runs": len(own), **intervals(own, keys)}
        for names, own in (runs.groupby(by, sort=False) if len(runs) else ())
    ]


def broken(rows: Iterable[Mapping[str, Any]]) -> list[Fault]:
    """Runs in which somebody is silent for too long, that end early, or that gain more than the bound."""
    faults = []
    for row in rows:
        where = f"seed {row['seed']}, {row.get('method') or '{sweep} {level} {policy}'.format(**row)}"
        if row["silent"] > row["silence"]:
            faults.append(Fault("answer", f"{where}: silent for {row['silent']:g} steps, {row['silence']} allowed", None, "contact"))
        if row["steps"] != row["budget"]:
            faults.append(Fault("answer", f"{where}: {row['steps']} steps", None, "budget"))
        if row.get("contradictions") or row["utility"] > row.get("bound", np.inf) * (1 + 1e-6):
            faults.append(Fault("bound", f"{where}: utility {row['utility']:.9g}, bound {row.get('bound')}", None, "bound"))
    return faults


def findings(sweeps: pd.DataFrame) -> list[Finding]:
    """The source's trends, each by pairs of the same seeds."""
    found = [Finding("Figs. 5.3 to 5.6: utilities", "plotted", "see the table", LOST, "the plots' numbers, the map and ranges are lost")]
    if not len(sweeps):
        return found

    def table(sweep: str, policy: str, key: str) -> pd.DataFrame:
        own = sweeps[(sweeps["sweep"] == sweep) & (sweeps["policy"] == policy)]
        return own.pivot_table(index="seed", columns="level", values=key)

    points = []
    for own, key in zip(EMPHASES, GAINS, strict=True):
        gains = table("weights", "relays", key)
        points += [(f"{key} against {other}", *mean_interval(gains[own] - gains[other])) for other in EMPHASES if other != own]
    found.append(Finding.of_points("Fig. 5.3: weight 0.9 on one gain", "more of it than with another weight", points, "six pairs"))
    explored = table("weights", "relays", "exploring")
    share, half = mean_interval(explored["search"] / explored["explore"] - 0.5)
    found.append(
        Finding.of_lead("Fig. 5.3: exploring with search 0.9, share of that with explore 0.9, less a half", "still high", share, half)
    )
    relayed, alone = ([table("policy", policy, f"at{step}")[3] for step in range(EVERY, 101, EVERY)] for policy in POLICIES)
    leads = [(f"step {EVERY * (k + 1)}", *mean_interval(a - b)) for k, (a, b) in enumerate(zip(relayed, alone, strict=True))]
    found.append(Finding.of_points("Fig. 5.4: relays against alone", "no less throughout", leads, f"by {leads[-1][1]:.2g} in the end"))
    for printed, key, why in (("Fig. 5.5", "robots", ""), ("Fig. 5.6", "silence", STUCK)):
        utility = table(key, "relays", "utility")
        steps = list(zip(utility.columns, utility.columns[1:], strict=False))
        grown = [(f"{a} to {b}", *mean_interval(utility[b] - utility[a])) for a, b in steps]
        ours = f"{utility.iloc[:, 0].mean():.3g} to {utility.iloc[:, -1].mean():.3g}"
        found.append(Finding.of_points(f"{printed}: utility with {key}", "grows", grown, ours, why))
    return found


@figure("explore-map-search", 13.0, 3.6)
def sweeps_figure(figure: Any, sweeps: pd.DataFrame) -> None:
    """Gains by weights, and utility over steps, teams and silence."""
    axes: Sequence[Any] = figure.subplots(1, 4)
    weights = sweeps[sweeps["sweep"] == "weights"].groupby("level", sort=False)[list(GAINS)].mean()
    for k, key in enumerate(GAINS):
        axes[0].bar(np.arange(len(weights)) + 0.27 * (k - 1), weights[key], 0.25, color=COLOURS[k], label=key)
    axes[0].set_xticks(range(len(weights)), [f"{name} 0.9" for name in weights.index], fontsize=8)
    axes[0].set_ylim(0.0, 1.3 * float(weights.to_numpy().max()))
    axes[0].legend(frameon=False, fontsize=8, ncols=3, loc="upper center", columnspacing=1.0, handlelength=1.0)
    for colour, policy in zip(COLOURS, POLICIES, strict=False):
        own = sweeps[sweeps["policy"] == policy]
        steps = range(EVERY, 101, EVERY)
        told = own[own["sweep"] == "policy"]
        curves = [(axes[1], list(steps), [told[f"at{step}"] for step in steps])]
        for ax, key in zip(axes[2:], ("robots", "silence"), strict=True):
            curves.append((ax, list(SWEEPS[key]), [own[(own["sweep"] == key) & (own["level"] == v)]["utility"] for v in SWEEPS[key]]))
        for ax, across, values in curves:
            middle, half = np.array([mean_interval(v) for v in values]).T
            ax.plot(across, middle, color=colour, marker="o", markersize=3, label=policy)
            ax.set_xticks(across[:: 1 if len(across) < EVERY else 2])
            ax.fill_between(across, middle - half, middle + half, color=colour, alpha=0.2, linewidth=0)
    for ax, label in zip(axes, ("", "step", "robots", "silence"), strict=True):
        ax.set_xlabel(label, fontsize=9)
        plain(ax, "utility" if label else "gain")
    axes[1].legend(frameon=False, fontsize=8)
