"""Which runs count, and what their answers are compared with: one place for all tables, profiles and tests."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from .best_known import Value, value_for

if TYPE_CHECKING:
    import pandas as pd

CASE = ["instance", "file_hash", "reading"]
"""What makes a case: an instance, and how it is read. Runs of different cases are never compared."""

COUNTED = [
    *CASE,
    "method",
    "limits",
    "seed",
    "convention",
    "sense",
    "status",
    "objective",
    "verified_bound",
    "checked",
    "faults",
    "seconds",
]
"""Columns of results that counting needs."""


def counted(frame: pd.DataFrame, known: Mapping[str, list[Value]] | None = None) -> pd.DataFrame:
    """Results with what they are compared with.

    An answer counts if it passed every check and nothing about its run contradicts it.

    Parameters
    ----------
    frame : DataFrame
        Of ``results``, with the columns ``COUNTED`` at least.
    known : mapping, optional
        Best known values, of ``best_known``.

    Returns
    -------
    DataFrame
        The rows with further columns: ``case`` (a number), ``who`` (the method, with its limits where it has several), ``counts``,
        ``best`` (the best counted answer of the case), ``best_bound`` (the best verified bound of the case, whoever found it), ``known``
        (the best known value, from a table), ``gap_to_best``, ``gap_to_known``, ``gap_to_bound``; NaN where a side is missing. A negative
        gap to the best known value is a better answer.
    """
    f = frame.copy()
    f["case"] = f.groupby(CASE, sort=True, dropna=False).ngroup()
    several = f.groupby("method")["limits"].nunique() > 1
    f["who"] = f["method"].where(~f["method"].map(several), f["method"] + " " + f["limits"].map(_in_words))
    faultless = f["faults"].fillna(0) == 0
    f["counts"] = f["checked"] & faultless & f["objective"].notna()
    sign = np.where(f["sense"] == "max", -1.0, 1.0)
    of_case = f["case"]
    f["best"] = sign * (sign * f["objective"]).where(f["counts"]).groupby(of_case).transform("min")
    f["best_bound"] = sign * (sign * f["verified_bound"]).where(faultless).groupby(of_case).transform("max")
    asked = f[["file_hash", "convention", "sense"]].drop_duplicates()
    values = {tuple(key): value_for((known or {}).get(key[0], []), key[1], key[2]) for key in asked.itertuples(index=False, name=None)}
    keys = zip(f["file_hash"], f["convention"], f["sense"], strict=True)
    f["known"] = np.array([values[key] for key in keys], dtype=np.float64) if known else np.nan
    objective = f["objective"].where(f["counts"])
    for name, other in (("gap_to_best", "best"), ("gap_to_known", "known")):
        f[name] = sign * (objective - f[other]) / f[other].abs().clip(lower=_LEAST)
    f["gap_to_bound"] = (objective - f["best_bound"]).abs() / objective.abs().clip(lower=_LEAST)
    return f


_LEAST = 1e-9


def _in_words(limits: str) -> str:
    return ", ".join(f"{name.replace('_', ' ')} {value:g}" for name, value in json.loads(limits).items())
