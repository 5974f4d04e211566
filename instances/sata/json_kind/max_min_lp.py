"""Packing and covering rows in waybound's JSON; the keys are documented in ``docs/formats.md``."""

from __future__ import annotations

from typing import Any

import numpy as np

from ... import number_arrays as arrays
from ...document import array, fields, integer, json_number, kind_of, reals, string, strings, wholes
from ...errors import InputError
from ...kinds import KINDS, Kind
from ..max_min_lp import MaxMinInstance, SparseMatrix

KEYS = ("name", "problem", "problems", "sense", "variables", "packing", "covering", "notes")
MATRIX_KEYS = ("rows", "row", "variable", "value")


def encode(instance: MaxMinInstance) -> dict[str, Any]:
    """The keys of packing and covering rows; those that hold nothing but defaults are left out."""
    data: dict[str, Any] = {"name": instance.name, "problem": instance.problem, "sense": instance.sense}
    data["variables"] = instance.num_variables if instance.variable_names is None else list(instance.variable_names)
    for key in ("packing", "covering"):
        matrix: SparseMatrix = getattr(instance, key)
        row = np.repeat(np.arange(matrix.rows), np.diff(matrix.indptr))
        data[key] = {"rows": matrix.rows, "row": row.tolist(), "variable": matrix.indices.tolist()}
        if (matrix.data != 1.0).any():
            data[key]["value"] = [json_number(v) for v in matrix.data.tolist()]
    if instance.notes:
        data["notes"] = list(instance.notes)
    return data


def decode(data: dict[str, Any]) -> MaxMinInstance:
    """The instance; see ``Kind.decode``."""
    fields(data, "the document", KEYS, ("name", "problem", "sense", "variables", "packing", "covering"))
    problem = string(data["problem"], "problem")
    problems = strings(data.get("problems", [problem]), "problems")
    if problem != "max-min-lp" or problems != ("max-min-lp",):
        raise InputError("packing and covering rows allow one problem", expected="max-min-lp", found=", ".join((problem, *problems)))
    if isinstance(data["variables"], list):
        names: tuple[str, ...] | None = strings(data["variables"], "variables")
        count = len(data["variables"])
    elif isinstance(data["variables"], int):
        names, count = None, integer(data["variables"], "variables", 1)
    else:
        raise InputError("variables must be a list of names or a whole number", found=kind_of(data["variables"]))
    return MaxMinInstance(
        _decode_matrix(data["packing"], "packing", count), _decode_matrix(data["covering"], "covering", count),
        string(data["sense"], "sense"), names, name=string(data["name"], "name"), format="json",
        notes=strings(data.get("notes", []), "notes"),
    )  # fmt: skip


def _decode_matrix(data: Any, path: str, columns: int) -> SparseMatrix:
    """A matrix from columns of entries, in any order."""
    fields(data, path, MATRIX_KEYS, ("rows", "row", "variable"))
    rows = integer(data["rows"], f"{path}.rows", 1)
    row = wholes(data["row"], f"{path}.row")
    column = wholes(data["variable"], f"{path}.variable", len(row))
    value = reals(data["value"], f"{path}.value", len(row)) if "value" in data else np.ones(len(array(data["row"], f"{path}.row")))
    arrays.refuse_unused(f"rows of {path}", rows, len(row), "entries")
    arrays.refuse_outside(f"{path}.row[{{}}]", row, rows, "row")
    arrays.refuse_outside(f"{path}.variable[{{}}]", column, columns, "variable")
    wrong = ~(value > 0)
    if wrong.any():
        k = int(np.argmax(wrong))
        raise InputError(f"{path}.value[{k}] must be positive", found=str(value[k]))
    order = np.lexsort([column, row])
    row, column, value = row[order], column[order], value[order]
    twice = np.nonzero((np.diff(row) == 0) & (np.diff(column) == 0))[0]
    if len(twice):
        raise InputError(f"{path} has two entries in row {row[twice[0]] + 1} for variable {column[twice[0]]}")
    indptr = np.concatenate([[0], np.cumsum(np.bincount(row, minlength=rows))])
    return SparseMatrix(indptr, column, value, columns)  # type: ignore[arg-type]


KINDS.add("max-min", Kind("max-min", encode, decode))
