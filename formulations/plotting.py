"""The way from ``Solution.plot`` to the pictures, which stand on a higher floor: the face, which runs before all else, sets ``draw``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

draw: Callable[..., Any]
"""``draw(solution, **options)`` returns the axes."""
