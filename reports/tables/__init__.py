"""Tables for people, as plain rows. A family registers its own rows in ``TABLES``; other facts are shown as they are."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from ... import _guard as _guard
from ...instances.registry import Registry
from .table import Row, Table


@dataclass(frozen=True)
class Tables:
    """Rows of facts and tables of answers of one family.

    ``facts`` maps a name in ``problem.facts()`` to a function that makes rows of its value. ``answer`` makes tables of a problem and its
    answer, or None; by default one of the first rows of the answer's frame.
    """

    facts: Mapping[str, Callable[[Any], list[Row]]] = field(default_factory=dict)
    answer: Callable[[Any, Any], list[Table]] | None = None


TABLES: Registry[Tables] = Registry("family of tables", "waybound.reports.tables.*", group="waybound.tables")
"""Tables by family of problems."""
