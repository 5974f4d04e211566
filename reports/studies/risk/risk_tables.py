"""The tables of Xiao (2019): risks of a worked example and of two flown paths, and how often these failed."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from ....formulations.risk.risky_path import RiskyPath
from ....instances.risk.elements import LocaleRisk
from ....instances.risk.risky_graph import RiskyGraph
from ...plots.drawing import COLOURS, plain
from ..findings import NOT, SIGN, UNDECIDED, Finding
from ..frames import frame_table
from ..study import Report, StudySetting, broken, figure, study

ELEMENTS = ("distance", "visibility", "length", "turn", "tether", "contacts")

RED = (
    (0.01, 0.02, 0, 0, 0.01, 0), *((0.01, 0.02, 0.04, 0, 0.01, 0),) * 3, *((0.01, 0.01, 0.04, 0, 0.02, 0),) * 2,
    (0.01, 0.01, 0.06, 0.05, 0.02, 0), (0.01, 0.01, 0.05, 0.05, 0.03, 0), (0.01, 0.01, 0.05, 0, 0.04, 0),
    (0.02, 0.02, 0.04, 0.05, 0.04, 0), (0.03, 0.04, 0.05, 0.05, 0.04, 0),
)  # fmt: skip
"""Table 7.1, a row per state."""

GREEN = (
    (0.01, 0.02, 0, 0, 0.01, 0), *((0.01, 0.02, 0.04, 0, 0.01, 0),) * 3, (0.03, 0.01, 0.06, 0.05, 0.02, 0), (0.04, 0.01, 0.06, 0, 0.02, 0),
    (0.02, 0.01, 0.06, 0, 0.03, 0), (0.01, 0, 0.05, 0.05, 0.03, 0),
)  # fmt: skip
"""Table 7.2."""

EXAMPLE = tuple(
    (distance, turn, contact)
    for distance, turn, contact in zip(
        (0.01, 0, 0, 0.02, 0.04, 0.02, 0.04, 0.02, 0, 0, 0.01, 0.04), (0, 0, 0, 0.02, 0, 0, 0.04, 0, 0, 0, 0.02, 0),
        (0,) * 6 + (0.03,) * 6, strict=True,
    )
)  # fmt: skip
"""Table 3.1: distance, turn and contacts of twelve states."""

FLIGHTS = {"red": (8, 10), "green": (6, 10)}
"""Section 7.4: failures, and flights."""

REWARDS = {"red": 1.0, "green": 0.9}


def path_of(rows: Sequence[Sequence[float]], names: Sequence[str]) -> RiskyPath:
    """A path whose states have the risks of a table."""
    n = len(rows)
    elements = tuple(LocaleRisk(np.array(column, dtype=float), name) for column, name in zip(zip(*rows, strict=True), names, strict=True))
    tail, head = np.array(list(pairwise(range(n)))).T
    return RiskyPath(RiskyGraph(n, tail, head, elements, 0, True, goals=(n - 1,)))


@study(
    "risk-tables",
    "risks of the worked example and of two flown paths, and how often these failed",
    1,
    source="Xiao (2019), Tables 3.1 and 7.1 to 7.4, sections 3.4, 7.3 and 7.4",
    claim="risks of 0.38, 0.714 and 0.575; the green path is worth more per risk; ten flights each match the risks closely",
)
def risk_tables(setting: StudySetting) -> Report:
    """See ``Study.run``; nothing is random."""
    tables = {
        "example": (EXAMPLE, ("distance", "turn", "contacts")), "red": (RED, ELEMENTS), "green": (GREEN, ELEMENTS),
    }  # fmt: skip
    rows: list[dict[str, Any]] = []
    for name, (table, names) in tables.items():
        problem = path_of(table, names)
        verdict = problem.evaluate(tuple(range(len(table))))
        row: dict[str, Any] = {"path": name, "states": len(table), "risk": float(verdict.values[0]), "sum of risks": float(np.sum(table))}
        if name in FLIGHTS:
            low, high = _interval(*FLIGHTS[name])
            row |= {"failed": "{} of {}".format(*FLIGHTS[name]), "interval": f"{low:.3f} to {high:.3f}"}
        rows.append(row)
    risk = {row["path"]: row["risk"] for row in rows}
    worth = {name: reward / risk[name] for name, reward in REWARDS.items()}
    seen = {name: math.fsum(sum(state[:2]) for state in table) for name, table in (("red", RED), ("green", GREEN))}
    findings = [
        Finding.of_number("Table 7.1, risk of the red path", "0.714", risk["red"]),
        Finding.of_number("Table 7.2, risk of the green path", "0.575", risk["green"]),
        Finding.of_number("utility of the green path, 0.9 / risk", "1.565", worth["green"]),
        Finding.of_fact("the better path per risk", "green", max(worth, key=worth.__getitem__), worth["green"] > worth["red"], exact=True),
        Finding.of_number("Table 3.1, risk of the example", "0.38", risk["example"], "printed survivals are rounded to two digits first"),
        Finding.of_number("utility of the red path, 1 / risk", "1.401", worth["red"], "the printed risk is rounded first"),
        Finding.of_fact("sum of locale risks (section 7.3)", "lower on the red path", f"{seen['red']:.2f} against {seen['green']:.2f}",
                        seen["red"] < seen["green"], "the thesis' own columns add up to more on the red path"),
    ]  # fmt: skip
    for name, (failed, flown) in FLIGHTS.items():
        low, high = _interval(failed, flown)
        held = low <= risk[name] <= high
        why = "consistent, but the interval holds much else" if held else "the interval does not hold the risk"
        said = f"{failed} of {flown}: {low:.3f} to {high:.3f}"
        findings.append(Finding(f"failures of the {name} path", f"match {risk[name]:.3f} closely", said, UNDECIDED if held else NOT, why))
    chance = _same(*FLIGHTS.values())
    findings.append(Finding("failures of both paths", "red riskier", f"p = {chance:.2f}", SIGN if chance < 0.05 else UNDECIDED,
                         "ten flights each cannot tell 0.714 from 0.575; some 185 would"))  # fmt: skip
    notes = (
        "flights are the thesis': what is computed of them are intervals of Clopper and Pearson at 95 %, and Fisher's exact test",
        "the additive risk of the literature has no such meaning: sums pass 1",
    )
    return Report(
        "risk-tables", risk_tables.summary, frame_table("Risks of paths, and their flights", rows), tuple(rows), figures=(_figure(rows),),
        notes=notes, findings=tuple(findings), **broken(findings[:4]), done=1, asked=1,
    )  # fmt: skip


def _interval(failed: int, flown: int) -> tuple[float, float]:
    """The interval of Clopper and Pearson, at 95 %."""
    from scipy import stats

    held = stats.binomtest(failed, flown).proportion_ci(0.95)
    return float(held.low), float(held.high)


def _same(red: tuple[int, int], green: tuple[int, int]) -> float:
    """Fisher's exact test, two-sided."""
    from scipy import stats

    return float(stats.fisher_exact([[red[0], red[1] - red[0]], [green[0], green[1] - green[0]]]).pvalue)


@figure("risk-tables", 7.0, 2.6)
def _figure(figure: Any, rows: Sequence[dict[str, Any]]) -> None:
    """Risk of each flown path, and its share of failures with an interval."""
    ax = figure.subplots()
    for k, (name, (failed, flown)) in enumerate(FLIGHTS.items()):
        low, high = _interval(failed, flown)
        share, risk = failed / flown, next(row["risk"] for row in rows if row["path"] == name)
        known = {} if k else {"label": "share of failures, 95 %"}
        ax.errorbar([share], [k], xerr=[[share - low], [high - share]], fmt="o", color=COLOURS[0], capsize=3, **known)
        ax.plot(risk, k, "D", color=COLOURS[3], **({} if k else {"label": "risk"}))
    ax.set_yticks(range(2), list(FLIGHTS))
    ax.set_ylim(-0.6, 1.6)
    ax.set_xlim(0.0, 1.0)
    ax.legend(frameon=False, fontsize=8, loc="upper left")
    plain(ax, "risk of not finishing, and flights that did not")
