"""Risk allocation declared with CVXPY: its canonical cone program becomes the data, so that CVXPY is needed once."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...instances.errors import InputError, UnsupportedError
from ...instances.risk.allocation import MOST_RISK, Affine, ChanceConstraints, Cone, CostTerm, Risk, RiskAllocationInstance
from ...instances.risk.allocation_arrays import numbered
from ...instances.risk.gaussian import Quantities
from .allocations import Floats

Places = dict[str, tuple[int, tuple[int, ...]]]
"""Column of the first entry of each variable, and its shape, by its name."""


def declared_instance(
    model: Any, quantities: Any, covariance: ArrayLike, limits: ArrayLike, *, total: float | None, each: ArrayLike | None, risk: str,
    name: str, names: Sequence[str] | None,
) -> tuple[RiskAllocationInstance, Places]:  # fmt: skip
    """The instance of ``RiskAllocation.from_cvxpy``, and where CVXPY's variables are among its decisions."""
    import cvxpy as cp

    data, own, mean = _canonical_program(model, quantities)
    stuffed, dims, q = data["param_prob"], data["dims"], mean.size
    matrix, side = np.asarray(data["A"].todense(), dtype=np.float64), np.asarray(data["b"], dtype=np.float64)
    n = matrix.shape[1]
    sense = "max" if isinstance(model.objective, cp.Maximize) else "min"
    sign = -1.0 if sense == "max" else 1.0
    linear = sign * np.asarray(data["c"], dtype=np.float64)
    offset = sign * float(np.asarray(stuffed.apply_parameters(quad_obj=data.get("P") is not None)[-3]).item())

    def affine(part: Floats, constant: Floats) -> Affine:
        return Affine(part, np.zeros((len(constant), q)), constant)

    linear_rows = dims.zero + dims.nonneg
    lower_sides = np.where(np.arange(linear_rows) < dims.zero, side[:linear_rows], -math.inf)
    cones, start = [], linear_rows
    for width in dims.soc:
        t, v = start, slice(start + 1, start + width)
        cones.append(Cone(affine(-matrix[v], side[v]), affine(-matrix[t : t + 1], side[t : t + 1])))
        start += width
    columns = stuffed.var_id_to_col
    at = columns[mean.id]
    selection = np.zeros((q, n))
    selection[np.arange(q), at + np.arange(q)] = 1.0
    constraint_names = tuple(str(k + 1) for k in range(q)) if names is None else tuple(map(str, names))
    if total is None and each is None:
        raise InputError("risk says no limit", "missing", expected="total or each")
    caps = min(MOST_RISK, total if total is not None else MOST_RISK) if each is None else each
    instance = RiskAllocationInstance(
        _bound(data.get("lower_bounds"), n, -math.inf), _bound(data.get("upper_bounds"), n, math.inf),
        _names([*own.values(), mean], columns, n), Quantities(selection, np.zeros(q), np.asarray(covariance, dtype=np.float64),
        numbered("y", q)), Affine(linear[None], np.zeros((1, q)), np.array([offset])),
        ChanceConstraints(Affine(np.zeros((q, n)), np.eye(q), np.zeros(q)), _each(limits, "limits", q),
                          constraint_names, np.arange(q)),
        Risk(risk, total, _each(caps, "each", q)),
        affine(matrix[:linear_rows], np.zeros(linear_rows)), lower_sides, side[:linear_rows], numbered("row", linear_rows),
        _squares(data.get("P"), q), tuple(cones), sense, name, "cvxpy",
    )  # fmt: skip
    places = {name: (columns[v.id], v.shape) for name, v in own.items()}
    return instance, places


def _canonical_program(model: Any, quantities: Any) -> tuple[dict[str, Any], dict[str, Any], Any]:
    """Clarabel's data of a model, its variables by name, and the variable that stands for the quantities."""
    import cvxpy as cp

    expression = cp.vec(cp.Expression.cast_to_const(quantities), order="F")
    if not expression.is_affine():
        raise InputError("the quantities of chance constraints must be affine in the variables", "unsupported", found=str(quantities)[:60])
    if not isinstance(model, cp.Problem) or not model.is_dcp():
        raise InputError("the model must be a convex cvxpy.Problem (DCP)", "unsupported", found=type(model).__name__)
    if model.is_mixed_integer():
        raise UnsupportedError("risk allocation by CVXPY", {"integer variables"})
    mean = cp.Variable(expression.size, name="quantities")
    own = {v.name(): cp.Variable(v.shape, name=v.name()) for v in model.variables()}  # which keep their places, whatever attributes v has
    if len(own) < len(model.variables()):
        raise InputError("two variables of the model have the same name", "duplicate", expected="different names")
    held = [own[v.name()] == v for v in model.variables()]
    whole = cp.Problem(model.objective, [*model.constraints, *held, mean == expression])
    data = whole.get_problem_data(cp.CLARABEL)[0]
    dims = data["dims"]
    if dims.exp or dims.psd or dims.p3d or getattr(dims, "pnd", None):
        raise UnsupportedError("risk allocation by CVXPY", {"exponential, power or semidefinite cones"})
    return data, own, mean


def _each(value: Any, what: str, q: int) -> Floats:
    """A number for all quantities, or one each."""
    values = np.asarray(value, dtype=np.float64)
    if values.shape not in ((), (q,)):
        raise InputError(f"{what} must be a number, or one a quantity", "wrong-shape", expected=str(q), found=str(values.shape))
    return np.broadcast_to(values, q).copy()


def _bound(bound: Any, n: int, none: float) -> Floats:
    return np.full(n, none) if bound is None else np.asarray(bound, dtype=np.float64)


def _names(variables: Sequence[Any], columns: dict[int, int], n: int) -> tuple[str, ...]:
    """The variables' own names; auxiliary variables are CVXPY's."""
    names = [f"auxiliary {k + 1}" for k in range(n)]
    for v in variables:
        for k in range(v.size):
            names[columns[v.id] + k] = v.name() if v.size == 1 else f"{v.name()}[{k + 1}]"
    return tuple(names)


def _squares(quadratic: Any, q: int) -> tuple[CostTerm, ...]:
    """``x P x / 2`` as the square of rows."""
    if quadratic is None or not quadratic.nnz:
        return ()
    dense = np.asarray(quadratic.todense(), dtype=np.float64)
    if not np.tril(dense, -1).any():
        dense = dense + np.triu(dense, 1).T
    values, vectors = np.linalg.eigh(dense)
    kept = values > 1e-12 * max(float(values[-1]), 0.0)
    rows = np.sqrt(values[kept])[:, None] * vectors[:, kept].T
    return (CostTerm("square", 0.5, Affine(rows, np.zeros((len(rows), q)), np.zeros(len(rows)))),)
