"""How many random examples a property test draws: all of them by ``make test-all``, a part in the fast suite."""

import os

ALL = os.environ.get("WAYBOUND_DRAWS") == "all"
"""Whether every example is drawn."""

PART = 0.2


def draws(full: int) -> int:
    """Of ``full`` examples those that are drawn here."""
    return full if ALL else max(1, round(PART * full))
