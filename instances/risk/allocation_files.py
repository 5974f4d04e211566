"""Risk allocation in waybound's JSON; the keys are documented in ``docs/formats.md``."""

import math
from typing import Any

import numpy as np

from .. import number_arrays as arrays
from ..document import array, fields, integer, json_number, json_numbers, kind_of, matrix, real, reals, square, string, strings, wholes
from ..errors import InputError
from ..number_arrays import Floats
from .allocation import MOST_RISK, Affine, Budget, ChanceConstraints, Cone, CostTerm, Risk, RiskAllocationInstance
from .gaussian import Dynamics, Quantities

KEYS = (
    "name", "problem", "problems", "sense", "decisions", "lower", "upper", "quantities", "dynamics", "cost", "constraints", "cones",
    "chance", "risk", "notes",
)  # fmt: skip
ROW_KEYS = ("decisions", "quantities", "constant")
MOST_ENTRIES = 50_000_000


# -- reading -------------------------------------------------------------------------------------------------------------


def decode(data: dict[str, Any]) -> RiskAllocationInstance:
    """The instance; see ``Kind.decode``."""
    fields(data, "the document", KEYS, ("name", "problem", "cost", "chance", "risk"))
    problem = string(data["problem"], "problem")
    if problem != "risk-allocation" or data.get("problems", [problem]) != [problem]:
        raise InputError("data of risk allocation allow one problem", "unknown-name", expected="risk-allocation", found=problem)
    if ("quantities" in data) == ("dynamics" in data):
        raise InputError("there must be either quantities or dynamics", "contradiction" if "dynamics" in data else "missing")
    if "dynamics" in data:
        dynamics = _dynamics(data["dynamics"])
        quantities, names = dynamics.quantities(), dynamics.decision_names()
        if "decisions" in data and strings(data["decisions"], "decisions") != names:
            raise InputError(
                "the decisions of dynamics are their inputs, step after step", "contradiction", expected=", ".join(names[:4]) + ", ..."
            )
    else:
        if "decisions" not in data:
            raise InputError("the document lacks the key 'decisions'", "missing")
        names = _names(data["decisions"], "decisions", "x")
        quantities = _quantities(data["quantities"], len(names))
    n, q = len(names), len(quantities.names)
    lower, upper = _side(data.get("lower"), "lower", n, -math.inf), _side(data.get("upper"), "upper", n, math.inf)
    cost = fields(data["cost"], "cost", (*ROW_KEYS, "terms"))
    linear = _row(cost, "cost", n, q)
    terms = tuple(_term(term, f"cost.terms[{k}]", n, q) for k, term in enumerate(array(cost.get("terms", []), "cost.terms")))
    limits = fields(data.get("constraints", {}), "constraints", (*ROW_KEYS, "lower", "upper", "names"))
    rows = _affine(limits, "constraints", n, q)
    row_names = strings(limits["names"], "constraints.names") if "names" in limits else tuple(str(k + 1) for k in range(rows.rows))
    cones = tuple(_cone(cone, f"cones[{k}]", n, q) for k, cone in enumerate(array(data.get("cones", []), "cones")))
    chance = _chance(data["chance"], n, q)
    return RiskAllocationInstance(
        lower, upper, names, quantities, linear, chance, _risk(data["risk"], chance.names), rows,
        _side(limits.get("lower"), "constraints.lower", rows.rows, -math.inf),
        _side(limits.get("upper"), "constraints.upper", rows.rows, math.inf), row_names, terms, cones,
        string(data.get("sense", "min"), "sense"), string(data["name"], "name"), "json", notes=strings(data.get("notes", []), "notes"),
    )  # fmt: skip


def _names(data: Any, path: str, letter: str) -> tuple[str, ...]:
    """A list of names, or how many there are."""
    if isinstance(data, list):
        return strings(data, path)
    if not isinstance(data, int) or isinstance(data, bool):
        raise InputError(f"{path} must be a list of names or a whole number", found=kind_of(data))
    count = integer(data, path, 1)
    arrays.refuse_unused(path, count, 0, "names")
    return tuple(f"{letter}{k + 1}" for k in range(count))


def _side(data: Any, path: str, size: int, default: float) -> Floats:
    """A number for all, or one each; null where there is no limit."""
    if data is None or isinstance(data, int | float):
        return np.full(size, real(data, path, null=default))
    return reals(data, path, size, null=default)


def _matrix(data: Any, path: str, columns: int, rows: int | None = None) -> Floats:
    """A list of rows, or the rows and columns of the entries that are not 0."""
    if isinstance(data, list):
        return matrix(data, path, rows, columns)
    fields(data, path, ("rows", "row", "column", "value"), ("rows", "row", "column", "value"))
    count = integer(data["rows"], f"{path}.rows", 0)
    if rows is not None and count != rows:
        raise InputError(f"{path}.rows is another number than that of its neighbours", "wrong-shape", expected=str(rows), found=str(count))
    if count * columns > MOST_ENTRIES:
        raise InputError(f"{path} is too large", "too-large", expected=f"at most {MOST_ENTRIES} entries", found=f"{count} x {columns}")
    row = wholes(data["row"], f"{path}.row")
    column, value = wholes(data["column"], f"{path}.column", len(row)), reals(data["value"], f"{path}.value", len(row))
    arrays.refuse_outside(f"{path}.row[{{}}]", row, count, "row")
    arrays.refuse_outside(f"{path}.column[{{}}]", column, columns, "column")
    dense = np.zeros((count, columns))
    np.add.at(dense, (row, column), value)
    return dense


def _affine(data: Any, path: str, n: int, q: int) -> Affine:
    """Rows over decisions and quantities, of which those given say how many there are."""
    parts = {key: data.get(key) for key in ROW_KEYS}
    matrices = {
        key: _matrix(parts[key], f"{path}.{key}", size)
        for key, size in (("decisions", n), ("quantities", q)) if parts[key] is not None
    }  # fmt: skip
    row_counts = [len(m) for m in matrices.values()] + (
        [len(array(parts["constant"], f"{path}.constant"))] if parts["constant"] is not None else []
    )
    count = row_counts[0] if row_counts else 0
    if set(row_counts) - {count}:
        raise InputError(
            f"{path} has another number of rows over decisions than over quantities", "wrong-shape", found=", ".join(map(str, row_counts))
        )
    constant = np.zeros(count) if parts["constant"] is None else reals(parts["constant"], f"{path}.constant", count)
    return Affine(matrices.get("decisions", np.zeros((count, n))), matrices.get("quantities", np.zeros((count, q))), constant)


def _row(data: Any, path: str, n: int, q: int) -> Affine:
    """One row: lists of coefficients, and a number."""
    d = reals(data["decisions"], f"{path}.decisions", n) if "decisions" in data else np.zeros(n)
    y = reals(data["quantities"], f"{path}.quantities", q) if "quantities" in data else np.zeros(q)
    return Affine(d[None], y[None], np.array([real(data.get("constant", 0.0), f"{path}.constant")]))


def _term(data: Any, path: str, n: int, q: int) -> CostTerm:
    fields(data, path, (*ROW_KEYS, "kind", "weight"), ("kind",))
    return CostTerm(string(data["kind"], f"{path}.kind"), real(data.get("weight", 1.0), f"{path}.weight"), _affine(data, path, n, q))


def _cone(data: Any, path: str, n: int, q: int) -> Cone:
    fields(data, path, (*ROW_KEYS, "limit"), ("limit",))
    limit = data["limit"]
    if not isinstance(limit, dict):
        return Cone(_affine(data, path, n, q), Affine(np.zeros((1, n)), np.zeros((1, q)), np.array([real(limit, f"{path}.limit")])))
    return Cone(_affine(data, path, n, q), _row(fields(limit, f"{path}.limit", ROW_KEYS), f"{path}.limit", n, q))


def _chance(data: Any, n: int, q: int) -> ChanceConstraints:
    fields(data, "chance", (*ROW_KEYS, "limits", "names", "constraint"), ("limits",))
    rows = _affine(data, "chance", n, q)
    limits = reals(data["limits"], "chance.limits", rows.rows)
    names = strings(data["names"], "chance.names") if "names" in data else None
    if "constraint" in data:
        constraint = wholes(data["constraint"], "chance.constraint", rows.rows)
        count = int(constraint.max(initial=-1)) + 1
        arrays.refuse_unused("chance constraints", count, rows.rows, "rows")
    else:
        constraint, count = np.arange(rows.rows), rows.rows
    return ChanceConstraints(rows, limits, tuple(str(k + 1) for k in range(count)) if names is None else names, constraint)


def _risk(data: Any, names: tuple[str, ...]) -> Risk:
    fields(data, "risk", ("kind", "total", "each", "budgets"))
    total = None if data.get("total") is None else real(data["total"], "risk.total")
    each = data.get("each", MOST_RISK if total is None else min(total, 1.0 - 1e-9))
    each = np.full(len(names), real(each, "risk.each")) if not isinstance(each, list) else reals(each, "risk.each", len(names))
    index = {name: k for k, name in enumerate(names)}
    budgets = []
    for k, entry in enumerate(array(data.get("budgets", []), "risk.budgets")):
        path = f"risk.budgets[{k}]"
        fields(entry, path, ("name", "constraints", "risk"), ("constraints", "risk"))
        members = strings(entry["constraints"], f"{path}.constraints")
        unknown = next((m for m in members if m not in index), None)
        if unknown is not None:
            raise InputError(f"{path}.constraints names an unknown chance constraint", "unknown-name", found=repr(unknown)[:40])
        name = string(entry.get("name", str(k + 1)), f"{path}.name")
        budgets.append(Budget(name, np.array([index[m] for m in members], dtype=np.int64), real(entry["risk"], f"{path}.risk")))
    if total is None and not budgets and "each" not in data:
        raise InputError("risk says no limit", "missing", expected="total, each or budgets")
    return Risk(string(data.get("kind", "allocated"), "risk.kind"), total, each, tuple(budgets))


def _quantities(data: Any, n: int) -> Quantities:
    keys = ("names", "map", "offset", "covariance")
    fields(data, "quantities", keys, ("map", "covariance"))
    mean_map = _matrix(data["map"], "quantities.map", n)
    q = len(mean_map)
    names = strings(data["names"], "quantities.names") if "names" in data else tuple(f"y{k + 1}" for k in range(q))
    offset = reals(data["offset"], "quantities.offset", q) if "offset" in data else np.zeros(q)
    return Quantities(mean_map, offset, _covariance(data["covariance"], "quantities.covariance", q), names)


def _covariance(data: Any, path: str, size: int) -> Floats:
    """A square matrix, or a list of variances."""
    items = array(data, path, size)
    if items and isinstance(items[0], list):
        return square(data, path, size)
    return np.diag(reals(data, path, size))


def _dynamics(data: Any) -> Dynamics:
    keys = ("state", "input", "noise", "start", "start_covariance", "steps", "states", "inputs")
    fields(data, "dynamics", keys, ("state", "input", "noise", "start", "steps"))
    n = len(array(data["state"], "dynamics.state"))
    inputs = len(array(array(data["input"], "dynamics.input", n)[0], "dynamics.input[0]")) if n else 0
    if not n or not inputs:
        raise InputError("dynamics must have at least one state and one input", "missing")
    return Dynamics(
        square(data["state"], "dynamics.state", n), _matrix(data["input"], "dynamics.input", inputs, n),
        _covariance(data["noise"], "dynamics.noise", n), reals(data["start"], "dynamics.start", n),
        _covariance(data.get("start_covariance", [0.0] * n), "dynamics.start_covariance", n),
        integer(data["steps"], "dynamics.steps", 1),
        strings(data["states"], "dynamics.states") if "states" in data else tuple(f"s{k + 1}" for k in range(n)),
        strings(data["inputs"], "dynamics.inputs") if "inputs" in data else tuple(f"u{k + 1}" for k in range(inputs)),
    )  # fmt: skip


# -- writing -------------------------------------------------------------------------------------------------------------


def encode(instance: RiskAllocationInstance) -> dict[str, Any]:
    """The keys of the data; those that hold nothing but defaults are left out."""
    i, quantities = instance, instance.quantities
    data: dict[str, Any] = {"name": i.name, "problem": i.problem, "sense": i.sense}
    if quantities.dynamics is not None:
        data["dynamics"] = _encoded_dynamics(quantities.dynamics)
    else:
        data["decisions"] = list(i.decision_names)
    data["lower"], data["upper"] = _encoded_side(i.lower), _encoded_side(i.upper)
    if quantities.dynamics is None:
        data["quantities"] = {
            "names": list(quantities.names), "map": _encoded_matrix(quantities.map), "offset": json_numbers(quantities.offset),
            "covariance": _encoded_covariance(quantities.covariance),
        }  # fmt: skip
    data["cost"] = _encoded_row(i.cost)
    if i.terms:
        data["cost"]["terms"] = [{"kind": t.kind, "weight": json_number(t.weight), **_encoded_affine(t.rows)} for t in i.terms]
    if i.constraints.rows:
        limits = {"lower": _encoded_side(i.constraint_lower), "upper": _encoded_side(i.constraint_upper)}
        data["constraints"] = {**_encoded_affine(i.constraints), **limits, "names": list(i.constraint_names)}
    if i.cones:
        data["cones"] = [{**_encoded_affine(c.rows), "limit": _encoded_row(c.limit)} for c in i.cones]
    data["chance"] = {**_encoded_affine(i.chance.rows), "limits": json_numbers(i.chance.limits), "names": list(i.chance.names)}
    if len(i.chance.names) != i.chance.rows.rows or (i.chance.constraint != np.arange(i.chance.rows.rows)).any():
        data["chance"]["constraint"] = i.chance.constraint.tolist()
    names = i.chance.names
    data["risk"] = {"kind": i.risk.kind, "each": _encoded_side(i.risk.each)}
    if i.risk.total is not None:
        data["risk"]["total"] = i.risk.total
    if i.risk.budgets:
        data["risk"]["budgets"] = [
            {"name": b.name, "constraints": [names[k] for k in b.constraints.tolist()], "risk": b.risk} for b in i.risk.budgets
        ]
    if i.notes:
        data["notes"] = list(i.notes)
    return data


def _encoded_side(values: Floats) -> Any:
    return json_number(float(values[0])) if len(values) and (values == values[0]).all() else json_numbers(values)


def _encoded_matrix(matrix: Floats) -> Any:
    """Rows of a small matrix, or the places and values of the nonzero entries."""
    if matrix.size <= 64:
        return json_numbers(matrix)
    row, column = np.nonzero(matrix)
    return {"rows": len(matrix), "row": row.tolist(), "column": column.tolist(), "value": json_numbers(matrix[row, column])}


def _encoded_affine(rows: Affine) -> dict[str, Any]:
    parts = {"decisions": rows.decisions, "quantities": rows.quantities}
    data = {key: _encoded_matrix(part) for key, part in parts.items() if part.any()}
    if rows.constant.any() or not data:
        data["constant"] = json_numbers(rows.constant)
    return data


def _encoded_row(row: Affine) -> dict[str, Any]:
    parts = {"decisions": row.decisions[0], "quantities": row.quantities[0]}
    data: dict[str, Any] = {key: json_numbers(part) for key, part in parts.items() if part.any()}
    return {**data, "constant": json_number(float(row.constant[0]))} if row.constant[0] else data


def _encoded_covariance(matrix: Floats) -> Any:
    variances = np.diag(matrix)
    return json_numbers(variances if not (matrix - np.diag(variances)).any() else matrix)


def _encoded_dynamics(d: Dynamics) -> dict[str, Any]:
    data = {
        "state": json_numbers(d.state), "input": json_numbers(d.input), "noise": _encoded_covariance(d.noise),
        "start": json_numbers(d.start), "steps": d.steps, "states": list(d.state_names), "inputs": list(d.input_names),
    }  # fmt: skip
    return {**data, "start_covariance": _encoded_covariance(d.start_covariance)} if d.start_covariance.any() else data
