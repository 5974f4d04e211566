"""Primal integrals of a campaign's runs, from the course of each search."""

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING

from .frames import documents
from .measures import primal_integral

if TYPE_CHECKING:
    import pandas as pd

_KEY = ["instance", "file_hash", "setting_hash", "seed"]


def primal_integrals(runs: "pd.DataFrame", path: Path) -> "pd.Series[float]":
    """The primal integral of each run up to its time limit, in seconds, against the best answer that is known for its case.

    ``runs`` are of ``counted``, with the column ``setting_hash``. A run whose answer does not count has the whole time limit; NaN where no
    answer of the case does.
    """
    import pandas as pd

    histories = runs[_KEY].reset_index().merge(documents(path, "history"), on=_KEY, how="left").set_index("index")["history"]
    integrals = {}
    for at, limits, best, known, sense, counts in runs[["limits", "best", "known", "sense", "counts"]].itertuples(name=None):
        until = float(json.loads(limits)["time_limit"])
        reference = best if math.isnan(known) else (max if sense == "max" else min)(best, known)
        history = histories.get(at)
        if not counts or not isinstance(history, str):
            integrals[at] = until if not math.isnan(reference) else math.nan
            continue
        events = [(seconds, objective[0]) for seconds, _, objective, *_ in json.loads(history) if objective and objective[0] is not None]
        integrals[at] = primal_integral([s for s, _ in events], [v for _, v in events], reference, until)
    return pd.Series(integrals, dtype=float)
