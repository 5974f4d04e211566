"""Which runs count, and what their answers are compared with: one place for all tables, profiles and tests."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .best_known import Value, value_for
from .paired_tests import relative

if TYPE_CHECKING:
    import pandas as pd

CASE = ["instance", "file_hash", "reading"]
"""Columns that make a case: an instance, and how it is read. Runs of different cases are never compared."""

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


def counted(frame: pd.DataFrame, known: Mapping[tuple[str, str], list[Value]] | None = None) -> pd.DataFrame:
    """Add to each result the best answer, bound and known value of its case, and the gaps to them.

    An answer counts if it passed every check and nothing about its run contradicts it.

    Parameters
    ----------
    frame : DataFrame
        Of ``results``, with the columns ``COUNTED`` at least.
    known : mapping, optional
        Best known values, of ``Campaign.best_known_values``.

    Returns
    -------
    DataFrame
        The rows with further columns: ``case`` (a number), ``who`` (the method, with its limits where it has several), ``counts``,
        ``best`` (the best counted answer of the case), ``best_bound`` (the best verified bound of the case, whoever found it), ``known``
        (the best known value, from a table), ``gap_to_best``, ``gap_to_known``, ``gap_to_bound``; NaN where a side is missing. A negative
        gap to the best known value is a better answer.
    """
    f = frame.copy()
    f["case"] = f[CASE].astype("category").groupby(CASE, observed=True, sort=True).ngroup()
    f["who"] = _named_apart(f)
    faultless = f["faults"].fillna(0) == 0
    f["counts"] = f["checked"] & faultless & f["objective"].notna()
    sign = np.where(f["sense"] == "max", -1.0, 1.0)
    of_case = f["case"]
    f["best"] = sign * (sign * f["objective"]).where(f["counts"]).groupby(of_case).transform("min")
    f["best_bound"] = sign * (sign * f["verified_bound"]).where(faultless).groupby(of_case).transform("max")
    f["known"] = _known(f, known) if known else np.nan
    objective = f["objective"].where(f["counts"])
    for name, other in (("gap_to_best", "best"), ("gap_to_known", "known")):
        f[name] = sign * relative(objective, f[other])
    f["gap_to_bound"] = np.abs(relative(f["best_bound"], objective))
    return f


def _named_apart(f: pd.DataFrame) -> pd.Series[str]:
    """Methods, each with the limits that differ where it has several."""
    import pandas as pd

    ways = f[["method", "limits"]].drop_duplicates()
    several = ways["method"].duplicated(keep=False)
    if not several.any():
        return f["method"]
    words = {}
    for method, own in ways[several].groupby("method")["limits"]:
        read = [json.loads(limits) for limits in own]
        names = [name for name in sorted({name for one in read for name in one}) if len({one.get(name) for one in read}) > 1]
        for limits, one in zip(own, read, strict=True):
            parts = (f"{name.replace('_', ' ')} {one[name]:g}" if name in one else f"no {name.replace('_', ' ')}" for name in names)
            words[method, limits] = f"{method}, {', '.join(parts)}"
    keys = zip(f["method"], f["limits"], strict=True)
    return pd.Series([words.get(key, key[0]) for key in keys], index=f.index)


def _known(f: pd.DataFrame, known: Mapping[tuple[str, str], list[Value]]) -> NDArray[np.float64]:
    """The best known value of each row."""
    keys = list(zip(f["file_hash"], f["reading"], f["convention"], f["sense"], strict=True))
    values = {key: value_for(known.get(key[:2], []), key[2], key[3]) for key in set(keys)}
    return np.array([values[key] for key in keys], dtype=np.float64)
