"""Which bin each robot fetches and to whom it brings a new one on the way, decided together: an axial three-index assignment."""

import math
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ...instances.auctions.joint_assignment import JointAssignmentInstance
from ...instances.errors import InputError, UsageError
from ...instances.instance import digest
from ...instances.number_arrays import Flags, Floats, Integers
from ..evaluation import Evaluation, judge
from ..problem import PROBLEMS, Problem, refuse_settings
from .matching import largest_matching

if TYPE_CHECKING:
    import pandas as pd

Errands = tuple[tuple[int, int], ...]
"""Bin and request of each robot, -1 for none."""


class JointAssignment(Problem):
    """As many bins fetched as can be, as many requests served, at the least sum of the times until bins are reached and full.

    A robot's errand is a bin, a request, both, or nothing. With both it goes to the request first. An answer is a tuple of one errand
    (bin, request) a robot, -1 for none.

    Parameters
    ----------
    instance : JointAssignmentInstance
        Times from robots to bins and requests and between these, and when each bin is full.

    Attributes
    ----------
    pickups, deliveries : int
        How many every answer has.

    Raises
    ------
    UsageError
        For another instance.

    Notes
    -----
    Source: Zhang (2015), section 3.4.2, both decisions as one; docs/formulations/joint-assignment.md#model.
    """

    family: ClassVar[str] = "joint-assignment"
    senses = ("min",)

    def __init__(self, instance: JointAssignmentInstance) -> None:
        if not isinstance(instance, JointAssignmentInstance):
            raise UsageError(f"a joint assignment is made of a JointAssignmentInstance, not of {type(instance).__name__}", "malformed")
        self.instance = instance
        self.name, self.problem, self.notes = instance.name, "joint-assignment", instance.notes
        self.num_robots, self.num_bins, self.num_requests = instance.num_robots, instance.num_bins, instance.num_requests

    @classmethod
    def from_arrays(cls, to_bin: Any, to_request: Any, between: Any, filled: Any = None, **further: Any) -> "JointAssignment":
        """A problem on arrays.

        Parameters
        ----------
        to_bin, to_request : array of shape (robots, bins) and (robots, requests)
            Times until a robot is there; infinite where it cannot go.
        between : array of shape (requests, bins)
            Times from requests to bins.
        filled : array of shape (bins,), optional
            When each bin is full; infinite for never, 0 by default.
        **further
            Names and notes.
        """
        return cls(JointAssignmentInstance(to_bin, to_request, between, filled, **further))

    @cached_property
    def fetching(self) -> Flags:
        """Which robot may fetch which bin; shape (robots, bins)."""
        assert self.instance.filled is not None
        return np.isfinite(self.instance.to_bin) & np.isfinite(self.instance.filled)

    @cached_property
    def bringing(self) -> Flags:
        """Which robot may serve which request; shape (robots, requests)."""
        return np.isfinite(self.instance.to_request)

    @cached_property
    def fetched(self) -> Integers:
        """Some way to fetch the most bins: one a robot, -1 for none."""
        return _largest(self.fetching)

    @cached_property
    def served(self) -> Integers:
        """Some way to serve the most requests: one a robot, -1 for none."""
        return _largest(self.bringing)

    @property
    def pickups(self) -> int:
        return int((self.fetched >= 0).sum())

    @property
    def deliveries(self) -> int:
        return int((self.served >= 0).sum())

    @cached_property
    def costs(self) -> Floats:
        """Time of every errand, shape (robots, bins + 1, requests + 1), the last index for none; infinite where it is not allowed."""
        data = self.instance
        costs = np.full((self.num_robots, self.num_bins + 1, self.num_requests + 1), math.inf)
        costs[:, -1, -1] = 0.0
        costs[:, -1, :-1] = data.to_request
        assert data.filled is not None
        costs[:, :-1, -1] = np.maximum(data.to_bin, data.filled)
        by = data.to_request[:, None, :] + data.between.T[None, :, :]
        costs[:, :-1, :-1] = np.where(self.fetching[:, :, None], np.maximum(by, data.filled[None, :, None]), math.inf)
        return costs

    def digest(self) -> str:
        return digest("joint-assignment", self.instance.digest())

    def features(self) -> frozenset[str]:
        return frozenset({"triples"})

    @property
    def size(self) -> int:
        return self.num_robots

    def linear_entries(self) -> int:
        return 5 * self.costs.size

    def facts(self) -> dict[str, Any]:
        aim = f"times of {self.pickups} bins fetched and {self.deliveries} requests served"
        return {"objective": aim, "joint_assignment": self.instance.facts()}

    def cost_of(self, robot: int, place: int, request: int) -> float:
        """Time of one errand, from the data; infinite where it is not allowed."""
        data = self.instance
        assert data.filled is not None
        reached = 0.0 if request < 0 else float(data.to_request[robot, request])
        if place < 0:
            return reached
        if not (math.isfinite(data.to_bin[robot, place]) and math.isfinite(data.filled[place])):
            return math.inf
        way = float(data.to_bin[robot, place]) if request < 0 else reached + float(data.between[request, place])
        return max(way, float(data.filled[place]))

    def evaluate(self, answer: Any) -> Evaluation:
        """Add up the times; test that errands are allowed, no bin or request has two robots, and there are as many as there can be."""
        n, m, q, data = self.num_robots, self.num_bins, self.num_requests, self.instance
        if not isinstance(answer, tuple) or len(answer) != n or not all(_errand(one, m, q) for one in answer):
            raise InputError(
                "an answer is a tuple of one errand (bin, request) a robot, as numbers from 0, -1 for none", expected=f"{n} errands",
                found=str(answer)[:80],
            )  # fmt: skip
        costs = np.array([self.cost_of(i, j, k) for i, (j, k) in enumerate(answer)])

        def forbidden(i: int) -> str:
            return f"robot {data.name_of('robot', i)} may not do its errand"

        parts = [judge("allowed", np.where(np.isinf(costs), 1.0, 0.0), forbidden)]
        for at, what, count, asked in ((0, "bin", m, self.pickups), (1, "request", q, self.deliveries)):
            taken = np.array([errand[at] for errand in answer if errand[at] >= 0], dtype=np.int64)
            names = [f"{what} {data.name_of(what, k)} is given to several robots" for k in range(count)]
            lacking = f"{len(taken)} of the {asked} {what}s that there can be"
            parts.append(judge(f"{what}s", np.bincount(taken, minlength=count) - 1.0, names.__getitem__))
            parts.append(judge(f"{what}s-served", np.array([float(asked - len(taken))]), [lacking].__getitem__))
        worth = np.where(np.isfinite(costs), costs, 0.0)
        quantities = {"largest": float(worth.max(initial=0.0))}
        violations = tuple(v for _, broken in parts for v in broken)
        return Evaluation((math.fsum(worth),), tuple(check for check, _ in parts), violations, quantities)

    def answer_at_hand(self) -> Errands:
        """Bins and requests chosen independently, whatever the times."""
        return tuple(zip(self.fetched.tolist(), self.served.tolist(), strict=True))

    def answer_to_json(self, answer: Errands) -> dict[str, Any]:
        data = self.instance
        errands = [
            {
                "robot": data.name_of("robot", i), "bin": data.name_of("bin", j) if j >= 0 else None,
                "request": data.name_of("request", k) if k >= 0 else None,
            }
            for i, (j, k) in enumerate(answer)
        ]  # fmt: skip
        return {"kind": "errands", "errands": errands}

    def answer_from_json(self, data: Any) -> Errands:
        errands = data.get("errands") if isinstance(data, Mapping) and data.get("kind") == "errands" else None
        if not isinstance(errands, list):
            raise InputError("not an answer to a joint assignment", expected='an object {"kind": "errands", "errands": [...]}')
        counts = {"robot": self.num_robots, "bin": self.num_bins, "request": self.num_requests}
        known = {what: {self.instance.name_of(what, k): k for k in range(count)} for what, count in counts.items()}
        answer = [(-1, -1)] * self.num_robots
        for errand in errands:
            if not isinstance(errand, Mapping) or set(errand) != set(counts):
                raise InputError("an errand names a robot, a bin and a request, or null for one of the two", found=str(errand)[:80])
            numbers: dict[str, int] = {}
            for what, name in errand.items():
                if name is None and what != "robot":
                    numbers[what] = -1
                elif isinstance(name, str) and name in known[what]:
                    numbers[what] = known[what][name]
                else:
                    raise InputError(f"the answer names an unknown {what} {str(name)[:80]!r}", "unknown-name")
            answer[numbers["robot"]] = numbers["bin"], numbers["request"]
        return tuple(answer)

    def answer_to_frame(self, answer: Errands) -> "pd.DataFrame":
        """One row per robot that does something: robot, bin, request, time."""
        import pandas as pd

        data = self.instance
        rows = [
            (data.name_of("robot", i), data.name_of("bin", j) if j >= 0 else None, data.name_of("request", k) if k >= 0 else None,
             self.cost_of(i, j, k))
            for i, (j, k) in enumerate(answer)
            if (j, k) != (-1, -1)
        ]  # fmt: skip
        return pd.DataFrame(rows, columns=["robot", "bin", "request", "time"])

    def to_instance(self) -> JointAssignmentInstance:
        return self.instance

    def __repr__(self) -> str:
        return f"<JointAssignment {self.name}: {self.num_robots} robots, {self.num_bins} bins, {self.num_requests} requests>"


def _errand(one: Any, bins: int, requests: int) -> bool:
    pair = isinstance(one, tuple) and len(one) == 2 and all(type(k) is int for k in one)
    return pair and -1 <= one[0] < bins and -1 <= one[1] < requests


def _largest(allowed: Flags) -> Integers:
    if not allowed.shape[1]:
        return np.full(len(allowed), -1)
    indptr = np.concatenate([[0], np.cumsum(allowed.sum(axis=1))])
    return largest_matching(indptr, np.nonzero(allowed)[1].astype(np.int32), allowed.shape[1])


@PROBLEMS.register("joint-assignment")
def make(instance: Any, name: str, settings: dict[str, Any]) -> JointAssignment:
    """The problem of an instance; no settings."""
    if not isinstance(instance, JointAssignmentInstance):
        raise UsageError(f"{instance.name} holds no robots with bins and requests, so it cannot be read as {name}", "foreign")
    refuse_settings(name, settings)
    return JointAssignment(instance)
