"""How often an engine hands out incumbents."""

import time
from collections.abc import Iterator
from contextlib import contextmanager

LEAST = 0.05
"""Seconds between two incumbents, so that a flood of early ones costs nothing."""

PAUSE = 20.0
"""How many times as long as handing one out takes the next one waits: of 5,000 customers, judging one takes a seventh of a second."""


class Pace:
    """Says when the next incumbent may be handed out, so that a twentieth of the search goes into it at most."""

    def __init__(self) -> None:
        self._next = 0.0

    @property
    def due(self) -> bool:
        return time.perf_counter() >= self._next

    @contextmanager
    def handing_out(self) -> Iterator[None]:
        """The block in which an incumbent is handed out."""
        began = time.perf_counter()
        yield
        ended = time.perf_counter()
        self._next = ended + max(LEAST, PAUSE * (ended - began))
