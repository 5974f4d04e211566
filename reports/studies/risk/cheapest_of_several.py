"""The chance that the cheapest of several paths costs less than x, after Skeele (2016), section 5.3 and Fig. 5.2."""

from typing import Any

import numpy as np

from ....formulations.risk.path_sets import PathSet, cheaper_probability
from ...plots.drawing import COLOURS, plain
from ..findings import LOST, Finding
from ..frames import frame_table
from ..study import Report, StudySetting, figure, study

FIRST = (20.0, 25.0)
"""Fig. 5.2: mean and variance of the one path of the first set; the second paths of the later ones are not given, and ours."""

SETS: dict[str, list[tuple[float, float]]] = {
    "one path": [FIRST],
    "two alike": [FIRST] * 2,
    "three alike": [FIRST] * 3,
    "and a lower mean": [FIRST, (15.0, 25.0)],
    "and a higher mean": [FIRST, (30.0, 25.0)],
    "and a lower variance": [FIRST, (20.0, 4.0)],
    "and a higher variance": [FIRST, (20.0, 100.0)],
}

COSTS = (10.0, 15.0, 20.0, 25.0)


def chance(paths: list[tuple[float, float]], x: float) -> float:
    """Probability that the cheapest path costs less than x: less than one path of that cost for certain."""
    return cheaper_probability(PathSet.of(paths), PathSet.of([(x, 0.0)]))


@study(
    "cheapest-of-several",
    "how further paths change the chance that the cheapest one costs less than x",
    1,
    source="Skeele (2016), section 5.3, Fig. 5.2",
    claim="more paths and lower means shift the curve left, with diminishing returns; a higher variance makes it rise earlier, but slower",
)
def cheapest_of_several(setting: StudySetting) -> Report:
    """See ``Study.run``; nothing is random."""
    rows: list[dict[str, Any]] = [{"set": name, **{f"x = {x:g}": chance(paths, x) for x in COSTS}} for name, paths in SETS.items()]
    f = {row["set"]: np.array([row[f"x = {x:g}"] for x in COSTS]) for row in rows}
    one, two, three = f["one path"], f["two alike"], f["three alike"]

    gains = np.diff([one[2], two[2], three[2]])

    def at(name: str, k: int) -> str:
        return f"{f[name][k]:.3f} against {one[k]:.3f} at {COSTS[k]:g}"

    never = all(bool((values >= one - 1e-9).all()) for values in f.values())
    wide, narrow, high, alike = f["and a higher variance"], f["and a lower variance"], f["and a higher mean"], f["two alike"]
    findings = [
        Finding("Fig. 5.2: second paths of the later sets", "drawn", "see the table", LOST, "their means and variances are not given"),
        Finding.of_fact("more copies", "shift to the left", at("two alike", 2), bool((two > one).all() and (three > two).all())),
        Finding.of_fact("with diminishing returns", "yes", f"{gains[0]:.3f}, then {gains[1]:.3f}", bool(gains[1] < gains[0])),
        Finding.of_fact("a path of lower mean", "a large shift", at("and a lower mean", 2), bool(f["and a lower mean"][2] > two[2])),
        Finding.of_fact("a path of higher mean", "almost no change", at("and a higher mean", 2), bool(high[2] - one[2] < 0.02)),
        Finding.of_fact("a path of lower variance", "much steeper", at("and a lower variance", 3), bool(narrow[3] > two[3])),
        Finding.of_fact("a path of higher variance", "rises earlier, approaches 1 more slowly than with a copy",
                        f"{wide[0]:.3f} against {alike[0]:.3f} at 10, {wide[3]:.3f} against {alike[3]:.3f} at 25",
                        bool(wide[0] > alike[0] and wide[3] < alike[3])),
        Finding.of_fact("a path more never makes the chance smaller", "not said", "on every set" if never else "no", never),
    ]  # fmt: skip
    return Report(
        "cheapest-of-several", cheapest_of_several.summary, frame_table("Chance that the cheapest path costs less than x", rows),
        tuple(rows),
        figures=(_figure(),), findings=tuple(findings), done=1, asked=1,
    )  # fmt: skip


@figure("cheapest-of-several", 7.5, 3.8)
def _figure(figure: Any) -> None:
    """The chances over x."""
    ax, x = figure.subplots(), np.linspace(0.0, 36.0, 73)
    for k, (name, paths) in enumerate(SETS.items()):
        ax.plot(x, [chance(paths, cost) for cost in x], color=COLOURS[k], linewidth=1.5, label=name)
    ax.set_xlabel("x", fontsize=9)
    ax.legend(frameon=False, fontsize=8)
    plain(ax, "chance that the cheapest path costs less than x")
