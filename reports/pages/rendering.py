"""State that the blocks of a page share while it is written."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterable
from importlib.resources import files
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup


class Block(Protocol):
    """A part of a page."""

    def html(self, made: Rendering) -> Markup:
        """The part as HTML, with everything in it escaped."""


class Rendering:
    """Renders blocks: templates, names that are unique on the page, and the scripts and colours that the blocks need.

    ``scripts`` are files in ``assets``, in the order in which they were asked for; ``colours`` of the figures, as ``rrggbb``, have a
    counterpart on dark ground.
    """

    def __init__(self) -> None:
        self.scripts: dict[str, None] = {}
        self.colours: set[str] = set()
        self._numbers = itertools.count(1)

    def name(self, kind: str) -> str:
        """A name that nothing else on the page has."""
        return f"{kind}{next(self._numbers)}"

    def template(self, file: str, **values: Any) -> Markup:
        """A template of this package, filled in."""
        from markupsafe import Markup

        return Markup(_environment().get_template(file).render(**values))

    def blocks(self, blocks: Iterable[Block]) -> Markup:
        """All these blocks, one after the other."""
        from markupsafe import Markup

        return Markup("\n").join(block.html(self) for block in blocks)


@functools.cache
def _environment() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    return Environment(
        loader=PackageLoader(__package__, "templates"), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )


@functools.cache
def asset(file: str) -> str:
    """The text of a style sheet or script of this package."""
    return (files(__package__) / "assets" / file).read_text(encoding="utf-8")
