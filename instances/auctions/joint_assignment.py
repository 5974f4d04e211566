"""Robots that bring something to a request on the way to the bin that they fetch."""

import math
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from ..declared import CountOf, Declared, Names
from ..errors import InputError
from ..number_arrays import Floats
from ..parts import Axis, Numbers

MOST_TRIPLES = 50_000_000


@dataclass(frozen=True, eq=False, repr=False)
class JointAssignmentInstance(Declared):
    """Times of travel between robots, requests and bins, and when bins are full.

    Raises InputError if an array has the wrong shape or holds what it must not.

    Source: Zhang (2015), section 3.4.2, both decisions as one; docs/formulations/joint-assignment.md#model.

    Parameters
    ----------
    to_bin : array of shape (robots, bins)
        From each robot to each bin, by no request; infinite where it may not fetch it.
    to_request : array of shape (robots, requests)
        From each robot to each request; infinite where it has nothing to bring.
    between : array of shape (requests, bins)
        From each request to each bin.
    filled : array of shape (bins,), optional
        When each bin is full, counted from now; infinite where nobody fills it. By default all are.
    robot_names, bin_names, request_names : tuple of str, optional
        None stands for "1", "2", ...
    name, format, problem, problems, notes
        See ``Instance``.
    """

    kind = "joint-assignment"
    problem_names = ("joint-assignment",)
    content = "joint assignments"
    axes = (Axis("robot"), Axis("bin"), Axis("request", least=0))
    to_bin: Annotated[Floats, Numbers("robot", "bin", absent=math.inf)]
    to_request: Annotated[Floats, Numbers("robot", "request", absent=math.inf)]
    between: Annotated[Floats, Numbers("request", "bin")]
    filled: Annotated[Floats | None, Numbers("bin", absent=math.inf, default=0.0, each="time of being filled")] = None
    robot_names: Names = None
    bin_names: Names = None
    request_names: Names = None
    num_robots = CountOf("robot")
    num_bins = CountOf("bin")
    num_requests = CountOf("request")

    def refuse_counts(self) -> None:
        super().refuse_counts()
        if len(self.counts) == 3 and (n := self.num_robots) * ((m := self.num_bins) + 1) * ((q := self.num_requests) + 1) > MOST_TRIPLES:
            raise InputError(f"{n} robots, {m} bins and {q} requests make more than {MOST_TRIPLES:,} triples", "too-large")

    def facts(self) -> dict[str, Any]:
        """Sizes, as plain JSON values."""
        bringing = int(np.isfinite(self.to_request).any(axis=1).sum())
        return {**self.sizes(), "bringing": bringing, "not_yet_full": int((np.asarray(self.filled) > 0).sum())}
