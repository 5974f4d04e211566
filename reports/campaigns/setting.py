"""The settings of a run: the problem that is made of an instance, the method, and its limits."""

import hashlib
import json
from dataclasses import MISSING, dataclass, field, fields
from functools import cached_property
from typing import Any

LIMITS = ("time_limit", "bound_time", "iterations", "no_improvement", "gap", "threads", "memory_limit")
"""Limits that a campaign sets, under their names in ``solve``."""

TIME_LIMIT = 60.0


@dataclass(frozen=True, kw_only=True)
class Setting:
    """All that makes a run but its instance and its seed; runs of equal settings are the same run.

    Parameters
    ----------
    problem, convention, format : str, optional
        How the instance is read; what its format stands for by default.
    changes : dict
        Changes of the data, as with ``--set``.
    form : str, optional
        How the problem is written down, for solvers that take programs.
    lp_solver : str, optional
    time_limit, bound_time, iterations, no_improvement, gap, threads
        As in ``solve``.
    memory_limit : float, MB, optional
        On top of what a run holds before it reads its instance.
    files : dict
        Hash of each file that ``changes`` names.
    """

    method: str
    heuristic: bool = False
    problem: str | None = None
    convention: str | None = None
    format: str | None = None
    changes: dict[str, Any] = field(default_factory=dict)
    form: str | None = None
    relax: bool = False
    options: dict[str, Any] = field(default_factory=dict)
    lp_solver: str | None = None
    time_limit: float = TIME_LIMIT
    bound_time: float | None = None
    iterations: int | None = None
    no_improvement: int | None = None
    gap: float = 0.0
    threads: int = 1
    memory_limit: float | None = None
    files: dict[str, str] = field(default_factory=dict)

    def to_json(self) -> dict[str, Any]:
        """Settings that differ from the defaults, and the limits that every run has, as plain data."""
        values = {one.name: getattr(self, one.name) for one in fields(self)}
        return {name: value for name, value in values.items() if name in _ALWAYS or value != _DEFAULTS.get(name, {})}

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> "Setting":
        """The setting that ``to_json`` made ``data`` of."""
        return cls(**data)

    @cached_property
    def text(self) -> str:
        """The setting as one line of JSON, the same for equal ones: 1 and 1.0 are one time limit."""
        return canonical(self.to_json())

    @cached_property
    def hash(self) -> str:
        """A short name for it that depends on nothing else."""
        return short_hash(self.text)

    @property
    def label(self) -> str:
        """The method with what sets it apart from itself: its form and its own options."""
        parts = [self.form or "", "relaxed" if self.relax else "", *(f"{name}={value}" for name, value in sorted(self.options.items()))]
        parts += [] if self.lp_solver is None else [f"lp_solver={self.lp_solver}"]
        return " ".join([self.method, *(part for part in parts if part)])

    @cached_property
    def reading(self) -> str:
        """How the instance is read, as JSON: runs are compared that read it alike."""
        return canonical({name: getattr(self, name) for name in ("problem", "convention", "format", "changes", "files")})

    @property
    def limits(self) -> str:
        """The limits, as JSON."""
        return canonical({name: value for name in LIMITS if (value := getattr(self, name)) is not None})

    @property
    def bound_budget(self) -> float:
        """Seconds for bounding."""
        from ...solving.request import Request

        return Request(time_limit=self.time_limit, bound_time=self.bound_time).bound_budget

    def keywords(self) -> dict[str, Any]:
        """Keywords for ``solve``, without the seed and the limit on memory, which the run's own process keeps."""
        return {
            "heuristic" if self.heuristic else "solver": self.method, "form": self.form, "relax": self.relax, "options": self.options,
            "lp_solver": self.lp_solver, **{name: getattr(self, name) for name in LIMITS if name != "memory_limit"},
        }  # fmt: skip


def canonical(data: Any) -> str:
    """``data`` as one line of JSON with sorted keys, in which whole numbers have no fraction."""
    return json.dumps(_whole(data), sort_keys=True, ensure_ascii=False, separators=(",", ":"))


def short_hash(text: str) -> str:
    """The first 16 digits of the SHA-256 of ``text``."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _whole(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _whole(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_whole(value) for value in data]
    return int(data) if isinstance(data, float) and data.is_integer() else data


_ALWAYS = ("method", "heuristic", "time_limit", "gap", "threads")
_DEFAULTS = {one.name: one.default for one in fields(Setting) if one.default is not MISSING}
