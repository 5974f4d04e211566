"""Objectives composed of terms, by weights or in order of priority; as text; and the usual one of each named problem."""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ...instances.errors import UsageError
from ...instances.printable import printable
from ...instances.routing.sites import Sites
from ...instances.suggestions import did_you_mean


class Composable(ABC):
    """Operators shared by terms, weighted sums and lists of priorities."""

    @abstractmethod
    def levels(self) -> tuple[Weighted, ...]:
        """The levels in order of priority."""

    def then(self, other: Composable) -> Objective:
        """``self`` first, and among its optima ``other``."""
        return Objective(self.levels() + other.levels())


class Level(Composable):
    """One level of an objective: terms and weighted sums of them, which can be added, subtracted and weighted."""

    def __mul__(self, weight: float) -> Weighted:
        return Weighted(tuple((float(weight) * w, term) for w, term in _only_level(self).terms))

    __rmul__ = __mul__

    def __add__(self, other: Level) -> Weighted:
        return Weighted(_only_level(self).terms + _only_level(other).terms)

    def __sub__(self, other: Level) -> Weighted:
        return self + _only_level(other) * -1.0


@dataclass(frozen=True)
class Term(Level):
    """One quantity of an answer. ``sense`` says whether less or more of it is better."""

    name: ClassVar[str]
    sense: ClassVar[str] = "min"

    def levels(self) -> tuple[Weighted, ...]:
        return (Weighted(((1.0, self),)),)


@dataclass(frozen=True)
class TotalCost(Term):
    """Sum over routes of fixed cost, unit cost times distance, unit duration cost times duration, and the cost of overtime."""

    name: ClassVar[str] = "total-cost"


@dataclass(frozen=True)
class Makespan(Term):
    """Longest duration of a route, from departure to return."""

    name: ClassVar[str] = "makespan"


@dataclass(frozen=True)
class LongestRoute(Term):
    """Longest distance of a route, the objective of the min-max multiple travelling salesman files."""

    name: ClassVar[str] = "longest-route"


@dataclass(frozen=True)
class Vehicles(Term):
    """Number of routes."""

    name: ClassVar[str] = "vehicles"


@dataclass(frozen=True)
class Reward(Term):
    """Sum of the rewards of the visited sites, and of the depots, which need no visit."""

    name: ClassVar[str] = "reward"
    sense: ClassVar[str] = "max"


@dataclass(frozen=True)
class TotalDuration(Term):
    """Sum of the durations of all routes, each from departure to return."""

    name: ClassVar[str] = "total-duration"


@dataclass(frozen=True)
class LatestReturn(Term):
    """Time at which the last vehicle returns, each as early as its limits let it; the earliest departure where nobody drives.

    Where all start at time 0 and nobody waits, it is the makespan; where vehicles are under way already, it is what ends the horizon.
    """

    name: ClassVar[str] = "latest-return"


@dataclass(frozen=True)
class Penalties(Term):
    """Sum of the penalties of the sites left out."""

    name: ClassVar[str] = "penalties"


TERMS: dict[str, type[Term]] = {
    t.name: t for t in (TotalCost, Makespan, LongestRoute, Vehicles, Reward, TotalDuration, LatestReturn, Penalties)
}


PEAKS = (Makespan.name, LongestRoute.name, LatestReturn.name)
"""Terms that are the largest value of all routes."""


@dataclass(frozen=True)
class Weighted(Level):
    """A weighted sum of terms: one level of an objective. Its sense is that of its first term.

    Raises UsageError if there is no term, or a weight is zero or not finite.
    """

    terms: tuple[tuple[float, Term], ...]

    def __post_init__(self) -> None:
        if not self.terms:
            raise UsageError("a level of an objective needs at least one term", "missing")
        for weight, term in self.terms:
            if weight == 0 or not math.isfinite(weight):
                raise UsageError(f"the weight of {term.name} must be finite and not zero, not {weight!r}", "out-of-range")

    def levels(self) -> tuple[Weighted, ...]:
        return (self,)

    @property
    def sense(self) -> str:
        weight, term = self.terms[0]
        flipped = {"min": "max", "max": "min"}[term.sense]
        return term.sense if weight > 0 else flipped

    def __str__(self) -> str:
        (first, *rest) = ((w, t.name if abs(w) == 1 else f"{_plain(abs(w))}*{t.name}") for w, t in self.terms)
        lead = first[1] if first[0] > 0 else f"-1*{first[1]}" if first[0] == -1 else f"-{first[1]}"
        return lead + "".join(f" {'+' if w > 0 else '-'} {text}" for w, text in rest)


def _read(text: str) -> Weighted:
    """Inverse of ``str`` of a level."""
    first, *rest = re.split(r"\s+([+-])\s+", text.strip())
    terms = []
    for sign, part in [("+", first), *zip(rest[::2], rest[1::2], strict=True)]:
        weight, times, name = part.rpartition("*")
        if name not in TERMS:
            raise UsageError(f"unknown objective term {name!r}; choose from {', '.join(TERMS)}{did_you_mean(name, TERMS)}", "unknown-name")
        try:
            terms.append((float(f"{sign}1") * (float(weight) if times else 1.0), TERMS[name]()))
        except ValueError:
            raise UsageError(f"the weight of {name} must be a number, not {weight!r}", "malformed") from None
    return Weighted(tuple(terms))


def _only_level(part: Composable) -> Weighted:
    levels = part.levels()
    if len(levels) != 1:
        raise UsageError(f"an objective in order of priority cannot be added: {part}")
    return levels[0]


def _plain(weight: float) -> str:
    """The shortest text that reads back as the same number."""
    short = f"{weight:g}"
    return short if float(short) == weight else repr(weight)


@dataclass(frozen=True)
class Objective(Composable):
    """Levels in order of priority; most objectives have one."""

    _levels: tuple[Weighted, ...] = field(default_factory=lambda: TotalCost().levels())

    def levels(self) -> tuple[Weighted, ...]:
        return self._levels

    @classmethod
    def of(cls, value: Composable | str) -> Objective:
        """Any composable, or a text such as ``vehicles then total-cost``, as an objective.

        Parameters
        ----------
        value : Composable or str
            A term, a weighted sum, an objective, or its text.
        """
        if isinstance(value, str):
            return objective_from(value)
        return value if isinstance(value, Objective) else cls(value.levels())

    @classmethod
    def named(cls, names: tuple[str, ...]) -> Objective:
        """An objective from one text per level, first priority first: the name of a term, or a weighted sum (``reward - 0.5*makespan``).

        Parameters
        ----------
        names : tuple of str
            One a level.
        """
        if not names:
            raise UsageError(f"an objective needs at least one term; choose from {', '.join(TERMS)}", "missing")
        return cls(tuple(_read(name) for name in names))

    def is_only(self, *terms: type[Term]) -> bool:
        """Whether the levels are exactly these terms with weight 1."""
        return [level.terms for level in self._levels] == [((1.0, t()),) for t in terms]

    def features(self) -> frozenset[str]:
        """``objective:<term>`` for each term, ``objective:priorities`` and ``objective:weights``."""
        names = {f"objective:{term.name}" for level in self._levels for _, term in level.terms}
        if len(self._levels) > 1:
            names.add("objective:priorities")
        if any(len(level.terms) > 1 or level.terms[0][0] != 1 for level in self._levels):
            names.add("objective:weights")
        return frozenset(names)

    @property
    def senses(self) -> tuple[str, ...]:
        return tuple(level.sense for level in self._levels)

    def __str__(self) -> str:
        return ", then ".join(str(level) for level in self._levels)


_PART = re.compile(
    r"\s*(?:(?P<weight>(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)|(?P<term>[a-z]+(?:[-_][a-z]+)*)|(?P<sign>[+-])|(?P<times>\*)|(?P<other>\S))",
    re.IGNORECASE,
)
_THEN = re.compile(r"\s*,?\s*\bthen\b\s*", re.IGNORECASE)


def objective_from(text: str) -> Objective:
    """The objective that a text says: levels with ``then`` between, each a sum of terms such as ``total-cost - 2*reward``.

    The sense of a level is that of its first term. Raises UsageError naming what is wrong, and the term that may have been meant.
    """
    return Objective(tuple(_level(part, text) for part in _THEN.split(text.strip())))


def _level(part: str, text: str) -> Weighted:
    if not part.strip():
        raise UsageError(
            f"objective {_quoted(text)}: a level is empty; write terms such as {', '.join(list(TERMS)[:3])}, with then between levels",
            "missing",
        )
    terms: list[tuple[float, str]] = []
    sign, weight, times, signed, leading = 1.0, None, False, True, True
    for kind, word in _parts(part):
        if kind == "sign" and (leading or not signed):
            sign, signed = -1.0 if word == "-" else 1.0, True
        elif kind == "weight" and weight is None and signed:
            weight = float(word)
        elif kind == "times" and weight is not None and not times:
            times = True
        elif kind == "term" and signed:
            terms.append((sign * (1.0 if weight is None else weight), _known(word, text)))
            sign, weight, times, signed = 1.0, None, False, False
        else:
            raise UsageError(
                f"objective {_quoted(text)}: {_quoted(word)} is not expected there; write sums such as total-cost - 2*reward", "malformed"
            )
        leading = False
    if signed or weight is not None:
        raise UsageError(f"objective {_quoted(text)}: {_quoted(part)} ends without a term", "malformed")
    names = [name for _, name in terms]
    for name in names:
        if names.count(name) > 1:
            raise UsageError(f"objective {_quoted(text)}: {name} stands twice in one level", "duplicate")
    for weight, name in terms:
        if weight == 0 or not math.isfinite(weight):
            raise UsageError(f"objective {_quoted(text)}: the weight of {name} must be finite and not zero", "out-of-range")
    return Weighted(tuple((weight, TERMS[name]()) for weight, name in terms))


def _parts(level: str) -> Iterator[tuple[str, str]]:
    for match in _PART.finditer(level):
        yield str(match.lastgroup), str(match.group(str(match.lastgroup)))


def _known(word: str, text: str) -> str:
    name = word.lower().replace("_", "-")
    if name in TERMS:
        return name
    for term in TERMS:
        rest = name.removeprefix(f"{term}-")
        if rest in TERMS:
            raise UsageError(f"objective {_quoted(text)}: write blanks around - and +: {term} - {rest}", "malformed")
    hint = did_you_mean(name, TERMS) or f"; choose from {', '.join(TERMS)}"
    raise UsageError(f"objective {_quoted(text)}: there is no term {_quoted(word)}{hint}", "unknown-name")


def _quoted(text: str) -> str:
    return repr(printable(text.strip(), 80))


DEFAULT_OBJECTIVE: dict[str, Objective] = {
    "vrptw": Objective.of(TotalCost()),
    "cvrp": Objective.of(TotalCost()),
    "tsp": Objective.of(TotalCost()),
    "mdvrp": Objective.of(TotalCost()),
    "min-cost-vrp": Objective.of(TotalCost()),
    "min-makespan-vrp": Objective.of(Makespan()),
    "orienteering": Objective.of(Reward()),
    "team-orienteering": Objective.of(Reward()),
    "makespan-orienteering": Reward().then(Makespan()),
    "recharging-vrp": Objective.of(Makespan()),
    "pdptw": Vehicles().then(TotalCost()),
}
"""Default objectives by problem, where all sites are visited; ``default_objective`` adapts them to sites that may be left out."""


def default_objective(problem: str, sites: Sites) -> Objective:
    """The objective of a named problem where none is asked for.

    Where sites may be left out, total cost comes with the penalties of the sites left out and less the rewards of those visited. So it is
    for pairs too, whose fewest vehicles would be none at all.
    """
    usual = DEFAULT_OBJECTIVE.get(problem, Objective())
    free = optional(sites)
    if not free.any() or not any(isinstance(term, TotalCost) for level in usual.levels() for _, term in level.terms):
        return usual
    level = Weighted(((1.0, TotalCost()),))
    level = level + Penalties() if sites.penalty[free].any() else level
    level = level - Reward() if sites.reward[free].any() else level
    return usual if len(level.terms) == 1 else Objective.of(level)


def optional(sites: Sites) -> NDArray[np.bool_]:
    """Sites that an answer may leave out: neither depots nor required, nor alternatives of which one is."""
    free = ~(sites.depot | sites.required)
    for group in sites.groups:
        if group.required:
            free[list(group.sites)] = sites.reward[list(group.sites)] > 0
    return free


def pointless(sites: Sites) -> int:
    """Number of optional sites if none of them has a reward or a penalty, so that visits gain nothing; else 0."""
    free = optional(sites)
    return 0 if sites.reward[free].any() or sites.penalty[free].any() else int(free.sum())
