"""Tables that people read, as plain rows. What a family tells in its own way it registers in ``TABLES``; all else is told as it is."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ... import _guard as _guard
from ...instances.registry import Registry

if TYPE_CHECKING:
    from .table import Row, Table


@dataclass(frozen=True)
class Tables:
    """How problems of a family, and their answers, are told.

    Parameters
    ----------
    facts : mapping
        From a name in ``problem.facts()`` to what makes rows of its value.
    answer : callable, optional
        From a problem and its answer, or None where there is none, to tables; by default one of the first rows of the answer's frame.
    """

    facts: Mapping[str, Callable[[Any], list[Row]]] = field(default_factory=dict)
    answer: Callable[[Any, Any], list[Table]] | None = None


TABLES: Registry[Tables] = Registry("family of tables", "waybound.reports.tables.*", group="waybound.tables")
"""By family of problems."""
