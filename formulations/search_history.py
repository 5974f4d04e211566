"""The history of a search: the best answer and bound known at each moment."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .tolerance import gap

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = ("seconds", "phase", "objective", "bound", "bound_kind", "gap", "found_by")


@dataclass(frozen=True)
class Event:
    """The best answer and bound known at a moment when one of them improved.

    Parameters
    ----------
    seconds : float
        Wall time since the call of ``solve``.
    phase : str
        ``solve``, ``bound``, or ``check`` for what was left in the end.
    objective : tuple of float, or None
        A value per level of the objective; as the search counts it until ``phase`` is ``check``.
    bound : tuple of (float or None), or None
        A value per level.
    bound_kind : str or None
        ``claimed`` (the search's own figure), ``evidence`` (found together with what proves it, not yet checked), or ``verified``.
    found_by : str
        What made the news: solver, heuristic, or source of the bound.
    """

    seconds: float
    phase: str
    objective: tuple[float, ...] | None
    bound: tuple[float | None, ...] | None
    bound_kind: str | None
    found_by: str

    @property
    def gap(self) -> float | None:
        """Gap of the first level; None where a side is missing."""
        if self.objective is None or self.bound is None or self.bound[0] is None:
            return None
        return gap(self.objective[0], self.bound[0])


def history_frame(events: Sequence[Event], levels: int = 1) -> "pd.DataFrame":
    """One row per event: ``COLUMNS``, and ``objective_2, bound_2, ...`` for further levels of priority; NaN where nothing was known."""
    import pandas as pd

    def of(values: Sequence[float | None] | None, level: int) -> float | None:
        return None if values is None or level >= len(values) else values[level]

    rows = [
        (
            *(e.seconds, e.phase, of(e.objective, 0), of(e.bound, 0), e.bound_kind, e.gap, e.found_by),
            *(of(side, level) for level in range(1, levels) for side in (e.objective, e.bound)),
        )
        for e in events
    ]
    further = [f"{side}_{level + 1}" for level in range(1, levels) for side in ("objective", "bound")]
    frame = pd.DataFrame(rows, columns=[*COLUMNS, *further])
    return frame.astype({name: float for name in frame.columns if name not in ("phase", "bound_kind", "found_by")})
