"""The ways from ``Solution`` to pictures, pages and maps of streets, and from a problem to the table of its facts, which stand on a higher
floor: the face, which runs before all else, sets ``draw``, ``page``, ``streets`` and ``tell``."""

from collections.abc import Callable
from typing import Any

draw: Callable[..., Any]
"""``draw(solution, **options)`` returns the axes."""

page: Callable[..., str]
"""``page(solution, path)`` returns the page of an answer, and writes it where there is a path."""

streets: Callable[..., Any]
"""``streets(solution)`` returns the answer's map of folium."""

tell: Callable[[Any], Any]
"""``tell(problem)`` returns a table of two columns."""
