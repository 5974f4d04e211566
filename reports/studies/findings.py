"""Findings: a published number or claim beside ours, and the verdict."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ..tables.table import Column

REPRODUCED, SIGN, NOT, UNDECIDED, LOST = "reproduced", "sign reproduced", "not reproduced", "undecided", "cannot be compared"
"""Verdicts of a finding: the published number; its direction alone; neither; an interval that holds both signs; nothing to compare with."""

LISTED = 120
"""Letters of a list of points; a longer one is counted."""


@dataclass(frozen=True)
class Finding:
    """A published number or claim beside ours.

    Parameters
    ----------
    what : str
        Quantity, with its table, figure or section where the study has several.
    published, ours : str
        As printed, and as measured, with its interval where it is a mean over seeds.
    verdict : str
        One of the five above.
    why : str
        The reason, wherever it is not reproduced.
    """

    what: str
    published: str
    ours: str
    verdict: str
    why: str = ""

    @classmethod
    def of_number(cls, what: str, published: str, ours: float, why: str = "") -> Finding:
        """A printed number: reproduced to half a unit of its last digit, or not; ``why`` is shown if not."""
        number, digits = published.removesuffix(" %"), len(published.removesuffix(" %").partition(".")[2])
        value = 100.0 * ours if published.endswith("%") else ours
        same = abs(value - float(number)) <= 0.5 * 10.0**-digits * (1.0 + 1e-9)
        shown = f"{value:.{digits + 2}f}" + (" %" if published.endswith("%") else "")
        return cls(what, published, shown, REPRODUCED if same else NOT, "" if same else why)

    @classmethod
    def of_lead(cls, what: str, claim: str, lead: float, half: float, unit: str = "", why: str = "") -> Finding:
        """A claimed direction: ``lead`` should be positive, and is known up to ``half``; ``why`` is shown if it is negative."""
        verdict = SIGN if lead > half else NOT if lead < -half else UNDECIDED
        return cls(what, claim, f"{lead_text(lead, half)}{unit and ' ' + unit}", verdict, _reason(verdict, why, half))

    @classmethod
    def of_near(cls, what: str, claim: str, difference: float, half: float, most: float, why: str = "") -> Finding:
        """Claimed to be alike: a relative ``difference``, known up to ``half``, that should be at most ``most`` either way."""
        verdict = SIGN if abs(difference) + half <= most else NOT if abs(difference) - half > most else UNDECIDED
        return cls(what, claim, f"{lead_text(100.0 * difference, 100.0 * half)} %", verdict, _reason(verdict, why, half))

    @classmethod
    def of_points(cls, what: str, claim: str, points: Sequence[tuple[str, float, float]], ours: str, why: str = "") -> Finding:
        """A direction claimed at several ``points``, each (label, lead, half): reproduced if everywhere, not if against it anywhere."""
        against = [label for label, lead, half in points if lead < -half]
        unclear = [label for label, lead, half in points if not abs(lead) > half]
        verdict = NOT if against else UNDECIDED if unclear else SIGN
        counts = f"{len(points) - len(against) - len(unclear)} of {len(points)} points; {ours}"
        listed = ", ".join(against or unclear)
        listed = listed if len(listed) <= LISTED else f"{len(against or unclear)} of {len(points)} points"
        where = f"{'not' if against else 'open'} at {listed}"
        return cls(what, claim, counts, verdict, "" if verdict == SIGN else f"{where}: {why}" if why and against else where)

    @classmethod
    def of_fact(cls, what: str, claim: str, ours: str, holds: bool, why: str = "", exact: bool = False) -> Finding:
        """A claim that is true or false of what was computed, of a direction or ``exact``; ``why`` is shown if false."""
        return cls(what, claim, ours, NOT if not holds else REPRODUCED if exact else SIGN, "" if holds else why)


def lead_text(mean: float, half: float) -> str:
    """A mean with its interval: two digits of the latter, and of the mean where that is smaller, to thousandths."""
    if not half > 0.0 or math.isinf(half):
        return f"{mean + 0.0:.4g}"
    smallest = max(min(half, abs(mean)), 1e-2)
    digits = max(0, 1 - math.floor(math.log10(half)), 1 - math.floor(math.log10(smallest)))
    return f"{mean:.{digits}f} ± {half:.{digits}f}"


def _reason(verdict: str, why: str, half: float) -> str:
    undecided = "too few runs for an interval" if math.isnan(half) else "the interval holds both"
    return {SIGN: "", UNDECIDED: undecided}.get(verdict, why)


FINDINGS = tuple(Column(name, wide=name != "verdict") for name in ("what", "published", "ours", "verdict", "why"))
"""Columns of a table of findings."""
