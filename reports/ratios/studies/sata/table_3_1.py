"""Table 3.1 of Sung (2019), all 18 entries, beside the values without its coarse steps."""

from __future__ import annotations

from typing import Any

from ....tables.table import Column, Table
from ...judging import run_heuristic
from ...study import STUDIES, Fault, Report, Study, StudySetting
from ...violations import instance_of
from .families.max_min import REFERENCES, robots

HEIGHTS = (2, 10, 30)

PRINTED = {
    2: (0.5, 0.5, 0.6667, 0.3333, 0.3333, 0.6667),
    10: (0.5, 0.5, 0.7591, 0.2409, 0.2409, 0.7591),
    30: (0.5, 0.5, 0.7855, 0.2145, 0.2145, 0.7855),
}
"""As printed: shares of the actions p1 to p6 on the graph of figure 3.3."""

EXACT = {
    2: (0.5, 0.5, 0.6667, 0.3333, 0.3333, 0.6667),
    10: (0.5106, 0.4894, 0.7905, 0.2095, 0.2498, 0.7502),
    30: (0.5042, 0.4958, 0.8172, 0.1828, 0.1980, 0.8020),
}
"""With exact levels in place of steps of 0.1, from exact rationals; docs/formulations/bottleneck.md#errata."""

DIGITS = 5e-5
"""Half a unit of the last printed digit."""

STEPS = {"search": "step", "step": 0.1, "ball": False}
FINE = {"search": "secant", "eps": 1e-6, "ball": False}

TITLE = "Table 3.1 of Sung (2019): shares on the graph of figure 3.3"

NOTES = (
    "printed: the thesis; steps: levels lowered in steps of 0.1, as the thesis' table needs; exact, fine: known values with exact levels, "
    "and the search to 1e-6",
    "the values show that more layers are not better by themselves: 7/6 at h = 2, 1.2409 at h = 10, 1.2145 at h = 30 with steps of 0.1",
)


def run(setting: StudySetting) -> Report:
    """Both searches at the three heights; every entry must agree with its published value."""
    problem = robots(REFERENCES["A"][0], "figure-3.3")
    rows, body, faults = [], [], []
    for h in HEIGHTS:
        shares = {
            name: [float(x) for x in run_heuristic(problem, "local", {"h": h, **options}, setting.seed).answer]
            for name, options in (("steps", STEPS), ("fine", FINE))
        }
        for action in range(6):
            row: dict[str, Any] = {
                "h": h, "action": f"p{action + 1}", "printed": PRINTED[h][action], "steps": shares["steps"][action],
                "exact": EXACT[h][action], "fine": shares["fine"][action],
            }  # fmt: skip
            rows.append(row)
            body.append((str(h), f"p{action + 1}", *(f"{row[key]:.4f}" for key in ("printed", "steps", "exact", "fine"))))
            for known, own in (("printed", "steps"), ("exact", "fine")):
                if abs(row[own] - row[known]) > DIGITS:
                    text = f"h = {h}, p{action + 1}: {row[own]:.6f}, {known} {row[known]:.4f}"
                    faults.append(Fault("values", text, instance_of(problem, text), own))
    columns = (Column("h", right=True), Column("action"), *(Column(key, right=True) for key in ("printed", "steps", "exact", "fine")))
    setting.told(1, 1, "")
    return Report("table-3-1", TITLE, Table(TITLE, columns, tuple(body)), tuple(rows), (), tuple(faults), len(faults), (), NOTES, 1, 1)


STUDIES.add("table-3-1", Study("table-3-1", TITLE, 1, run))
