"""The ways from ``Solution.plot`` to the pictures, from ``Solution.to_html`` to the pages, and from a problem to the table of its facts.
All these stand on a higher floor: the face, which runs before all else, sets ``draw``, ``page`` and ``tell``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

draw: Callable[..., Any]
"""``draw(solution, **options)`` returns the axes."""

page: Callable[..., str]
"""``page(solution, path)`` returns the page of an answer, and writes it where there is a path."""

tell: Callable[[Any], Any]
"""``tell(problem)`` returns a table of two columns."""
