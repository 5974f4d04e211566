"""The way from ``Solution.plot`` to the pictures, and from a problem to the table of its facts, which stand on a higher floor: the face,
which runs before all else, sets ``draw`` and ``tell``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

draw: Callable[..., Any]
"""``draw(solution, **options)`` returns the axes."""

tell: Callable[[Any], Any]
"""``tell(problem)`` returns a table of two columns."""
