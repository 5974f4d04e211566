"""Robots to bins, one each: the assignment problem, its sum or its bottleneck."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Iterator, Mapping
from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...instances.auctions.assignment import AssignmentInstance
from ...instances.errors import InputError, UsageError
from ...instances.generators.settings import Setting
from ...instances.instance import digest, with_settings
from ...instances.number_arrays import Floats, Spread, spread, unchanging
from ...instances.text import number, plain
from ..evaluation import Evaluation, judge
from ..evidence import CHECKERS, Evidence, Reason
from ..problem import PROBLEMS, Problem, refuse_settings
from .matching import largest_matching, surplus_rows

if TYPE_CHECKING:
    import pandas as pd

Assignment = tuple[int, ...]
"""Bin of each robot, -1 for none."""

OBJECTIVE = Setting("sum", "what is minimised: the sum of the costs, or the largest (bottleneck)", choices=("sum", "bottleneck"))
MATCH = Setting(
    "most", "how many pairs are asked for: as many as possible, or every robot, or every bin", choices=("most", "robots", "bins")
)
WAITING = Setting(
    "max", "what waiting for a bin makes of its cost: max(travel, filled), or the sum, which counts filling during travel twice",
    choices=("max", "sum"),
)  # fmt: skip
SETTINGS = {"objective": OBJECTIVE, "match": MATCH, "waiting": WAITING}

COSTS_AGREE = 1e-6
"""Share of the largest cost by which a cost in a table may differ from the data: tables are rounded."""

SHOWN = 5
"""Names listed in a message."""


class BinAssignment(Problem):
    """Send robots to bins, no two to one bin, as many as possible, at the least sum of costs or the least largest cost.

    An answer is optimal if it has as many pairs as any (or as are asked for), and no other of as many pairs costs less: the number comes
    first, whatever it costs. A bin that nobody fills can be no robot's. An answer is a tuple of one bin per robot, -1 for none.

    Parameters
    ----------
    instance : AssignmentInstance
        Robots, bins and the costs of allowed pairs.
    objective : str
        ``sum`` or ``bottleneck``.
    match : str
        ``most``: as many pairs as possible; ``robots``, ``bins``: one for each, so that there may be no answer.
    waiting : str
        Cost of a pair where bins are not full yet: ``max`` of travel and the time until the bin is full, or their ``sum``.

    Attributes
    ----------
    indptr, bins, cost : arrays
        Allowed pairs as a CSR matrix, with waiting.
    pairs : int
        How many every answer has.

    Raises
    ------
    UsageError
        For a setting that does not exist.

    Notes
    -----
    Source: Zhang (2015), section 3.4.2, with the program and readings of docs/formulations/bin-assignment.md#model.
    """

    family: ClassVar[str] = "bin-assignment"
    senses = ("min",)
    answer_suffixes: ClassVar[tuple[str, ...]] = (".csv",)

    def __init__(self, instance: AssignmentInstance, *, objective: str = "sum", match: str = "most", waiting: str = "max") -> None:
        if not isinstance(instance, AssignmentInstance):
            raise UsageError(
                f"a bin assignment is made of an AssignmentInstance, not of {type(instance).__name__}; see its from_matrix", "malformed"
            )
        self.instance = instance
        self.objective, self.match, self.waiting = (
            setting.value(name, chosen) for (name, setting), chosen in zip(SETTINGS.items(), (objective, match, waiting), strict=True)
        )
        self.name, self.notes = instance.name, instance.notes
        self.problem = {"sum": "bin-assignment", "bottleneck": "bottleneck-assignment"}[self.objective]
        self.num_robots, self.num_bins = instance.num_robots, instance.num_bins
        self.indptr, self.cost, self._kept = self._waited()

    @classmethod
    def from_matrix(cls, costs: Any, *, objective: str = "sum", match: str = "most", **further: Any) -> BinAssignment:
        """A problem on ``costs``: see ``AssignmentInstance.from_matrix``; the rest as of ``BinAssignment``."""
        return cls(AssignmentInstance.from_matrix(costs, **further), objective=objective, match=match)

    @classmethod
    def from_frame(cls, costs: pd.DataFrame, *, objective: str = "sum", match: str = "most", **further: Any) -> BinAssignment:
        """A problem on ``costs``: see ``AssignmentInstance.from_frame``; the rest as of ``BinAssignment``."""
        return cls(AssignmentInstance.from_frame(costs, **further), objective=objective, match=match)

    def _waited(self) -> tuple[NDArray[np.int32], Floats, NDArray[np.bool_] | None]:
        """First pair of each robot, costs with waiting, and a mask of the data's pairs that remain, None for all."""
        data = self.instance
        if data.filled is None:
            return data.indptr, data.cost, None
        until = data.filled[data.bins]
        cost = np.maximum(data.cost, until) if self.waiting == "max" else data.cost + until
        kept = np.isfinite(until)
        if kept.all():
            return data.indptr, cost, None
        return np.concatenate([[0], np.cumsum(kept)])[data.indptr].astype(np.int32), cost[kept], kept

    @cached_property
    def bins(self) -> NDArray[np.int32]:
        """Bin of each pair."""
        return self.instance.bins if self._kept is None else self.instance.bins[self._kept]

    @cached_property
    def spread(self) -> Spread:
        """The least and the largest cost, and whether all are whole numbers."""
        return self.instance.spread if self.cost is self.instance.cost else spread(self.cost)

    @property
    def complete(self) -> bool:
        """True if every robot may be sent to every bin."""
        return len(self.cost) == self.num_robots * self.num_bins

    @cached_property
    def robots(self) -> NDArray[np.int64]:
        """Robot of each pair."""
        return np.repeat(np.arange(self.num_robots), np.diff(self.indptr))

    def matrix(self) -> Floats:
        """Costs of shape (robots, bins), infinite where a pair is forbidden; a view where none is."""
        if self.complete:
            return self.cost.reshape(self.num_robots, self.num_bins)
        costs = np.full((self.num_robots, self.num_bins), math.inf)
        costs[self.robots, self.bins] = self.cost
        return costs

    @cached_property
    def largest(self) -> NDArray[np.int64]:
        """Some matching of the most pairs: bin of each robot, -1 for none."""
        if self.complete:
            return np.where(np.arange(self.num_robots) < self.num_bins, np.arange(self.num_robots), -1)
        return largest_matching(self.indptr, self.bins, self.num_bins)

    @property
    def pairs(self) -> int:
        return {"most": int((self.largest >= 0).sum()), "robots": self.num_robots, "bins": self.num_bins}[self.match]

    def digest(self) -> str:
        shape = self.num_robots, self.num_bins
        return digest("bin-assignment", self.objective, self.match, *shape, self.indptr, self.bins, self.cost)

    def digest_later(self) -> Callable[[], str] | str:
        """See ``Problem.digest_later``: of costs that nobody can write to."""
        made = self.instance.__dict__.get("bins")
        later = unchanging(self.cost) and unchanging(self.indptr) and (made is None or unchanging(made))
        return copy(self).digest if later else self.digest()

    def features(self) -> frozenset[str]:
        return frozenset({f"objective:{self.objective}"})

    @property
    def size(self) -> int:
        return self.num_robots

    def linear_entries(self) -> int:
        return 3 * len(self.cost)

    def facts(self) -> dict[str, Any]:
        aim = {"sum": "sum of the costs", "bottleneck": "largest cost"}[self.objective]
        return {"objective": f"{aim} of {self.pairs} pairs", "pairs_asked_for": self.pairs, "assignment": self.instance.facts()}

    def costs_of(self, answer: Assignment) -> Floats:
        """The cost of each robot's pair: infinite where it is forbidden, 0 where the robot has none."""
        taken = np.array(answer, dtype=np.int64)
        if self.complete:
            return np.where(taken >= 0, self.matrix()[np.arange(self.num_robots), np.maximum(taken, 0)], 0.0)
        keys = self.robots * np.int64(self.num_bins) + self.bins
        wanted = np.arange(self.num_robots) * np.int64(self.num_bins) + taken
        at = np.minimum(np.searchsorted(keys, wanted), max(len(keys) - 1, 0))
        allowed = (keys[at] == wanted) if len(keys) else np.zeros(self.num_robots, dtype=bool)
        return np.where(taken < 0, 0.0, np.where(allowed, self.cost[at] if len(keys) else 0.0, math.inf))

    def evaluate(self, answer: Any) -> Evaluation:
        """Recompute the costs; test that all pairs are allowed, no bin has two robots, and there are as many pairs as asked for."""
        n, m, data = self.num_robots, self.num_bins, self.instance
        if not isinstance(answer, tuple) or len(answer) != n or not all(type(j) is int and -1 <= j < m for j in answer):
            raise InputError(
                "an answer is a tuple of one bin a robot, as numbers from 0, -1 for none", expected=f"{n} numbers", found=str(answer)[:80]
            )
        taken, costs = np.array(answer, dtype=np.int64), self.costs_of(answer)
        used = np.nonzero(taken >= 0)[0]

        def crowd(k: int) -> str:
            who = [data.robot_name(i) for i in np.nonzero(taken == k)[0].tolist()]
            shown = ", ".join(who[:SHOWN]) + (", ..." if len(who) > SHOWN else "")
            return f"bin {data.bin_name(k)} is given to {len(who)} robots: {shown}"

        def forbidden(k: int) -> str:
            return f"robot {data.robot_name(int(used[k]))} may not be sent to bin {data.bin_name(answer[used[k]])}"

        idle = [data.robot_name(i) for i in np.nonzero(taken < 0)[0].tolist()]
        lacking = (
            f"{len(used)} of the {self.pairs} pairs asked for; without a bin: {', '.join(idle[:SHOWN])}{', ...' * (len(idle) > SHOWN)}"
        )
        parts = (
            judge("allowed", np.where(np.isinf(costs[used]), 1.0, 0.0), forbidden),
            judge("bins", np.bincount(taken[used], minlength=m) - 1.0, crowd),
            judge("pairs", np.array([float(self.pairs - len(used))]), lambda _: lacking),
        )
        worth = np.where(np.isfinite(costs), costs, 0.0)[used]
        value = math.fsum(worth) if self.objective == "sum" else float(worth.max()) if len(worth) else 0.0
        size = math.fsum(np.abs(worth)) if self.objective == "sum" else abs(value)
        quantities = {"pairs": float(len(used)), "sum": math.fsum(worth), "largest": float(worth.max()) if len(worth) else 0.0}
        violations = tuple(v for _, broken in parts for v in broken)
        return Evaluation((value,), tuple(check for check, _ in parts), violations, quantities, (size,))

    def answer_at_hand(self) -> Assignment:
        """Some pairs, as many as possible."""
        return tuple(self.largest.tolist())

    def infeasibility_reasons(self, stopped: Callable[[], bool] = lambda: False) -> Iterator[Reason]:
        """Robots that together have fewer bins than they are, or bins with too few robots, by König's theorem."""
        if self.pairs <= int((self.largest >= 0).sum()):
            return
        evidence = self.uncovered(self.indptr, self.bins, self.largest, "robots and bins that meet all allowed pairs")
        if CHECKERS[evidence.kind](self, evidence.data) != math.inf:
            return
        message = self.why_none(evidence.kind, evidence.data)
        yield Reason(self.match[:-1], message.split(":")[0], message, evidence)

    def uncovered(self, indptr: Any, bins: Any, matched: NDArray[np.int64], source: str) -> Evidence:
        """Evidence of robots and bins that cover all of some pairs, of which ``matched`` is a largest matching."""
        rows, columns = surplus_rows(indptr, bins, self.num_bins, matched)
        data = {"robots": np.nonzero(~rows)[0].tolist(), "bins": np.nonzero(columns)[0].tolist()}
        return Evidence("pair-cover", source, float(CHECKERS["pair-cover"](self, data)), data)

    def why_none(self, kind: str, data: Mapping[str, Any]) -> str:
        """The robots or bins with too few partners, by name."""
        robots = np.ones(self.num_robots, dtype=bool)
        bins = np.zeros(self.num_bins, dtype=bool)
        robots[data["robots"]], bins[data["bins"]] = False, True
        name = self.instance.robot_name, self.instance.bin_name
        who, partners = (robots, bins) if self.match != "bins" else (~bins, ~robots)
        of, other = (name[0], name[1]) if self.match != "bins" else (name[1], name[0])
        few, many = ("robots", "bins") if self.match != "bins" else ("bins", "robots")
        names = [of(k) for k in np.nonzero(who)[0].tolist()]
        only = [other(k) for k in np.nonzero(partners)[0].tolist()]
        shown = f"{few} {', '.join(names[:SHOWN])}{', ...' * (len(names) > SHOWN)}"
        return f"{shown}: {len(names)} of them, for whom there are {len(only)} {many} in all{': ' * bool(only)}{', '.join(only[:SHOWN])}"

    def answer_to_json(self, answer: Assignment) -> dict[str, Any]:
        return {"kind": "bin-assignment", "bin_of_robot": dict(self._named(answer))}

    def _named(self, answer: Assignment) -> list[tuple[str, str]]:
        return [(self.instance.robot_name(i), self.instance.bin_name(j)) for i, j in enumerate(answer) if j >= 0]

    def answer_from_json(self, data: Any) -> Assignment:
        pairs = data.get("bin_of_robot") if isinstance(data, Mapping) and data.get("kind") == "bin-assignment" else None
        if not isinstance(pairs, Mapping):
            raise InputError(
                "not an answer to a bin-assignment problem", expected='{"kind": "bin-assignment", "bin_of_robot": {ROBOT: BIN}}'
            )
        return self._numbered([(robot, name, None) for robot, name in pairs.items()])

    def _numbered(self, pairs: list[tuple[Any, Any, int | None]]) -> Assignment:
        robots = {self.instance.robot_name(i): i for i in range(self.num_robots)}
        bins = {self.instance.bin_name(j): j for j in range(self.num_bins)}
        bin_of_robot = [-1] * self.num_robots
        for robot, name, line in pairs:
            for what, asked, known in (("robot", robot, robots), ("bin", name, bins)):
                if not isinstance(asked, str) or asked not in known:
                    raise InputError(f"the answer names an unknown {what} {str(asked)[:80]!r}", "unknown-name", line=line)
            if bin_of_robot[robots[robot]] >= 0:
                raise InputError(f"the answer names robot {robot[:80]!r} twice", "duplicate", line=line)
            bin_of_robot[robots[robot]] = bins[name]
        return tuple(bin_of_robot)

    def answer_of(self, given: Any) -> Assignment:
        """A tuple or array of one bin per robot as numbers from 0, -1 for none, or a mapping of robots' names to bins'."""
        if isinstance(given, Mapping):
            return self._numbered([(str(robot), str(name), None) for robot, name in given.items()])
        if isinstance(given, np.ndarray) and given.ndim == 1 and given.dtype.kind in "iu":
            return tuple(given.tolist())
        if not isinstance(given, tuple):
            raise UsageError(
                "an assignment is a tuple of one bin a robot, -1 for none, or a mapping of robots' names to bins' names", "malformed"
            )
        return given

    def check_start(self, answer: Any) -> None:
        if not isinstance(answer, tuple) or len(answer) != self.num_robots or not all(type(j) is int and j < self.num_bins for j in answer):
            raise UsageError(f"the start is no assignment of {self.num_robots} robots to {self.num_bins} bins", "foreign")

    def answer_to_text(self, answer: Assignment, suffix: str, objective: float | None = None) -> str:
        """Rows of robot and bin."""
        out = io.StringIO()
        csv.writer(out, lineterminator="\n").writerows([("robot", "bin"), *self._named(answer)])
        return out.getvalue()

    def answer_from_text(self, text: str) -> tuple[Assignment, None]:
        """Inverse of ``answer_to_text``."""
        rows = [
            (k, [cell.strip() for cell in row]) for k, row in enumerate(csv.reader(text.split("\n")), start=1) if any(map(str.strip, row))
        ]
        if not rows:
            raise InputError("is no assignment", line=1, expected="the titles robot,bin", found=text.split("\n")[0][:40])
        return self._of_table(rows[0][1], rows[1:], rows[0][0]), None

    def answer_from_frame(self, frame: pd.DataFrame) -> Assignment:
        """Inverse of ``answer_to_frame``, whatever the order of its columns; a column ``cost`` has to agree with the data."""
        table = frame.drop(columns="position", errors="ignore").astype(object)
        rows = [["" if cell is None or cell != cell else str(cell).strip() for cell in row] for row in table.to_numpy().tolist()]
        return self._of_table([str(title).strip() for title in table.columns], list(enumerate(rows, start=2)), 1)

    def _of_table(self, titles: list[str], rows: list[tuple[int, list[str]]], at: int) -> Assignment:
        """The answer from rows of robot, bin and perhaps cost, each with its line; ``at`` is the line of the titles."""
        titles = [title.lower() for title in titles]
        if len(set(titles)) < len(titles) or not {"robot", "bin"} <= set(titles) <= {"robot", "bin", "cost"}:
            raise InputError("is no assignment", line=at, expected="the titles robot,bin", found=",".join(titles)[:40])
        pairs: list[tuple[Any, Any, int | None]] = []
        for line, row in rows:
            if len(row) != len(titles):
                raise InputError("row has a wrong length", "wrong-shape", line=line, expected=",".join(titles), found=f"{len(row)} values")
            pairs.append((row[titles.index("robot")], row[titles.index("bin")], line))
        answer = self._numbered(pairs)
        if "cost" in titles:
            largest = float(np.abs(self.cost).max(initial=0.0))
            costs, place = self.costs_of(answer), {self.instance.robot_name(i): i for i in range(self.num_robots)}
            for (robot, _, _), (line, row) in zip(pairs, rows, strict=True):
                if not row[titles.index("cost")]:
                    continue
                listed, own = number(row[titles.index("cost")], line, "cost"), float(costs[place[robot]])
                if math.isfinite(own) and not abs(listed - own) <= COSTS_AGREE * largest:
                    raise InputError(
                        f"the cost of robot {robot!r} is another one", "contradiction", line=line, expected=plain(own), found=plain(listed)
                    )
        return answer

    def answer_to_frame(self, answer: Assignment) -> pd.DataFrame:
        """One row per pair: robot, bin, cost."""
        import pandas as pd

        pairs, costs = self._named(answer), self.costs_of(answer)[np.array(answer) >= 0]
        return pd.DataFrame({"robot": [robot for robot, _ in pairs], "bin": [name for _, name in pairs], "cost": costs})

    def to_instance(self) -> AssignmentInstance:
        settings = {name: getattr(self, name) for name in SETTINGS}
        return with_settings(replace(self.instance, problem=self.problem), settings)  # type: ignore[no-any-return]

    def __repr__(self) -> str:
        return f"<BinAssignment {self.name}: {self.num_robots} robots, {self.num_bins} bins, {len(self.cost)} pairs, {self.objective}>"


def make(instance: Any, name: str, settings: dict[str, Any]) -> BinAssignment:
    """The problem of an instance, ``bottleneck-assignment`` with that objective; settings ``objective``, ``match``, ``waiting``."""
    if not isinstance(instance, AssignmentInstance):
        raise UsageError(f"{instance.name} holds no costs of robots and bins, so it cannot be read as {name}", "foreign")
    refuse_settings(name, settings, tuple(SETTINGS))
    asked = {key: settings[key] for key in SETTINGS if key in settings}
    if name == "bottleneck-assignment" and asked.setdefault("objective", "bottleneck") != "bottleneck":
        raise UsageError(f"the objective of {name} is bottleneck; for sums ask for --problem bin-assignment")
    return BinAssignment(instance, **asked)


for _name in ("bin-assignment", "bottleneck-assignment"):
    PROBLEMS.add(_name, make)
