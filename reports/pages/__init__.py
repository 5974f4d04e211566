"""Pages: reports as one HTML file each, without a network. ``page.Page`` is made of the blocks of ``blocks``; nobody else writes HTML.

A family whose answers are shown by more than their pictures and their table registers its blocks in ``PAGES``.
"""

from typing import TYPE_CHECKING, Any, Protocol

from ... import _guard as _guard
from ...formulations.solution import Solution
from ...instances.registry import Registry

if TYPE_CHECKING:
    from .rendering import Block


class AnswerBlocks(Protocol):
    """Blocks of the page of an answer, below its figures; ``solution`` holds problem and answer."""

    def __call__(self, problem: Any, answer: Any, solution: Solution) -> "list[Block]": ...


PAGES: Registry[AnswerBlocks] = Registry("page", "waybound.reports.pages.*", group="waybound.pages")
"""Blocks by family of problems."""
