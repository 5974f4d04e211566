"""Facts of problems of risk as rows of a table, and the risks of an allocation."""

from typing import Any

from ....formulations.rendering import number, percent
from ....formulations.risk.risk_allocation import RiskAllocation
from .. import TABLES, Tables
from ..answers import SHOWN_ROWS
from ..table import Column, Row, Table


def _graph(g: dict[str, Any]) -> list[Row]:
    shared = f", {g['shared_costs']} of them at the cost of another" if g["shared_costs"] else ""
    (fewest, most), (low, high), (least, largest) = g["out_degree"], g["means"], g["variances"]
    return [
        ("vertices", f"{g['vertices']}, each left by {fewest} to {most} edges"),
        ("edges", f"{g['edges']}{shared}: means {low:.6g} to {high:.6g}, variances {least:.6g} to {largest:.6g}"),
        ("from, to", f"{g['start']}, {g['goal']}"),
        ("positions", "of all vertices" if g["positions"] else "none"),
    ]


TABLES.add("uncertain-path", Tables({"graph": _graph}))


def _budgets(budgets: dict[str, float]) -> list[Row]:
    """Budgets in one line where they are few, else their number."""
    if len(budgets) > 4:
        return [("budgets", f"{len(budgets)}, the first {next(iter(budgets))} of {number(next(iter(budgets.values())))}")]
    return [("budgets", ", ".join(f"{name} {number(risk)}" for name, risk in budgets.items()) or "none")]


def answer(problem: RiskAllocation, allocation: Any) -> list[Table]:
    """Probability that any constraint fails, beside what was allowed; and the risk of each, the largest first.

    Where risk is joint no constraint is allowed one of its own.
    """
    if allocation is None:
        return []
    frame = problem.answer_to_frame(allocation).sort_values("risk", ascending=False, kind="stable")
    shown, rest = frame.head(SHOWN_ROWS), frame[SHOWN_ROWS:]
    rows = [(str(name), _risk(allowed), _risk(risk)) for name, allowed, risk in shown.to_numpy().tolist()]
    if len(rest):
        rows.append((f"and {len(rest)} more", _risk(rest.allowed.sum()), _risk(rest.risk.sum())))
    columns = [Column("constraint"), Column("allowed", right=True), Column("risk", right=True)]
    step = 2 if problem.risk.kind == "joint" else 1
    each = Table("Risks", tuple(columns[::step]), tuple(tuple(row)[::step] for row in rows))
    return [each, Table("Together", (Column(""), Column("", wide=True)), tuple(_together(problem, problem.answer_of(allocation).decision)))]


def _together(problem: RiskAllocation, decision: Any) -> list[Row]:
    """The chain from the budget to the true probabilities."""
    rows = [] if problem.risk.total is None else [("allowed", f"{_risk(problem.risk.total)} in total, {problem.risk.kind}")]
    rows.append(("sum of the risks", _risk(problem.risks(decision).sum())))
    for name, probability in problem.joint_risk(decision).items():
        sure = "proved" if probability.confidence == 1.0 else f"with confidence {percent(probability.confidence)}"
        span = "exact" if probability.exact else f"{_risk(probability.low)} to {_risk(probability.high)}, {sure}"
        rows.append(("any fails" if name == "total" else f"any of {name} fails", f"{_risk(probability.value)} ({span})"))
    if problem.risk.total is not None:
        joint = next(iter(problem.joint_risk(decision).values()))
        rows.append(("conservatism", f"{1.0 - joint.value / problem.risk.total:.1%} of the total is not used"))
    return rows


def _risk(value: float) -> str:
    return f"{float(value):.4g}"


TABLES.add("risk-allocation", Tables({"budgets": _budgets}, answer))
