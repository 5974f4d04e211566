"""The bottleneck problem: choose actions so that the worst-covered target is covered as well as possible."""

import functools
import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ...instances.errors import InputError, UsageError
from ...instances.instance import digest
from ...instances.number_arrays import Floats
from ...instances.printable import printable
from ...instances.sata.constraints import PartitionMatroid
from ...instances.sata.sensing_graph import SensingGraph
from ..evaluation import Evaluation, judge
from ..problem import PROBLEMS, refuse_settings
from ..references import is_number, vector_of
from ..tolerance import VECTOR
from .decided_elements import FEATURE, DecidedElements
from .selections import Selection, action_index, actions_from_json, actions_to_json, graph_for, indicator, judge_elements, selection_of

if TYPE_CHECKING:
    import pandas as pd


class BottleneckSATA(DecidedElements):
    """Maximise the least, over targets, of the summed weights of the chosen actions that see it; at most one action per robot.

    Parameters
    ----------
    graph : SensingGraph
        Robots, their actions, and which targets these see.
    fractional : bool
        Each robot may divide itself among its actions: the max-min LP, a problem of its own (``bottleneck-lp``), whose optimum
        bounds that of whole actions. Its answers are vectors of shares, one an action.

    Raises
    ------
    InputError
        If there is no target.

    Notes
    -----
    Source: Sung (2019), (3.1), (3.2) and (3.5); docs/formulations/bottleneck.md#problem. A target that nobody sees makes the value 0.
    """

    family: ClassVar[str] = "max-min"
    senses = ("max",)

    def __init__(self, graph: SensingGraph, *, fractional: bool = False) -> None:
        if graph.num_targets == 0:
            raise InputError(f"{graph.name} has no target, so there is no worst-covered one", "missing")
        self.graph, self.fractional = graph, bool(fractional)
        self.name, self.notes = graph.name, graph.notes
        self.problem = "bottleneck-lp" if fractional else "bottleneck"

    @property
    def num_elements(self) -> int:
        """Number of actions, which are the elements that are chosen."""
        return self.graph.num_actions

    @functools.cached_property
    def constraint(self) -> PartitionMatroid:
        """The constraint that a robot takes at most one action."""
        g = self.graph
        return PartitionMatroid(g.robot_of_action, np.ones(g.num_robots, dtype=np.int32), "robot", g.robot_name)

    def digest(self) -> str:
        return self.digest_decided(digest(self.graph.digest(), self.problem))

    def features(self) -> frozenset[str]:
        """``sensing`` always, ``whole-actions`` unless fractional."""
        kind = {"sensing"} if self.fractional else {"sensing", "whole-actions"}
        return frozenset(kind | ({FEATURE} if self.decided else set()))

    def element_name(self, element: int) -> str:
        return self.graph.action_name(element)

    def check_statement(self, statement: Any) -> None:
        """Accept ``{"chosen": action}``, counted from 0, for whole actions only."""
        if self.fractional:
            raise InputError("nothing can be stated of shares of actions", "unsupported", found=printable(str(statement), 80))
        super().check_statement(statement)

    def linear_entries(self) -> int:
        return len(self.graph.indices)

    def facts(self) -> dict[str, Any]:
        """Facts of the sensing graph."""
        return {"graph": self.graph.facts()}

    def shares_of(self, answer: Any) -> Floats:
        """An answer as a vector of shares, 1 for each action of a selection; shape (actions,)."""
        return np.asarray(answer, dtype=np.float64) if self.fractional else indicator(answer, self.graph.num_actions)

    def coverage(self, shares: Floats) -> Floats:
        """Summed weight that each target gets, from shares of shape (actions,)."""
        g = self.graph
        return np.asarray(np.bincount(g.indices, g.weights * shares[g.action_of_edge], minlength=g.num_targets), dtype=np.float64)

    def evaluate(self, answer: Any) -> Evaluation:
        """Recompute the coverage of every target; test that no robot does more than one thing.

        Shares that pass are priced without what is negative or beyond 1, so that nothing is gained by what the test of them lets pass.
        """
        return self._evaluate_shares(answer) if self.fractional else self._evaluate_selection(answer)

    def answer_at_hand(self) -> Any:
        """Each robot's first action."""
        first = np.unique(self.graph.robot_of_action, return_index=True)[1]
        if not self.fractional:
            return Selection.of(first.tolist())
        shares = np.zeros(self.graph.num_actions)
        shares[first] = 1.0
        return shares

    def _evaluate_shares(self, answer: Any) -> Evaluation:
        g, x = self.graph, self._shares(answer)
        with np.errstate(invalid="ignore"):
            load = np.bincount(g.robot_of_action, x, minlength=g.num_robots)
        judged = (
            judge(
                "shares", np.where(np.isfinite(x), -x, math.inf),
                lambda k: f"the share of action {g.action_name(k)} is {x[k]:.9g}, not 0 or more", VECTOR,
            ),
            judge("one-action", load - 1.0, lambda k: f"the shares of robot {g.robot_name(k)} sum to {load[k]:.9g}, more than 1", VECTOR),
        )  # fmt: skip
        violations = tuple(v for _, faults in judged for v in faults)
        if not violations:
            x = np.maximum(x, 0.0)
            x = x / np.maximum(np.bincount(g.robot_of_action, x, minlength=g.num_robots), 1.0)[g.robot_of_action]
        value = float(self.coverage(x).min()) if np.isfinite(x).all() else math.nan
        return Evaluation((value,), tuple(check for check, _ in judged), violations, {}, precision=VECTOR)

    def _evaluate_selection(self, answer: Any) -> Evaluation:
        g = self.graph
        if not isinstance(answer, Selection):
            raise UsageError(
                f"an answer to {self.problem} is a Selection, not {type(answer).__name__}: Selection.of([0, 3]) makes one", "malformed"
            )
        chosen, (actions, faults) = judge_elements(answer, g.num_actions, "actions", "action", g.action_name)
        robots, counts = np.unique(g.robot_of_action[chosen], return_counts=True)
        single, doubled = judge(
            "one-action", counts - 1.0, lambda k: f"robot {g.robot_name(int(robots[k]))} takes {counts[k]} actions"
        )  # fmt: skip
        shares = np.zeros(g.num_actions)
        shares[chosen] = 1.0
        covered = self.coverage(shares)
        quantities = {"covered_targets": float((covered > 0).sum())}
        evaluation = Evaluation((float(covered.min()),), (actions, single), (*faults, *doubled), quantities)
        return self.with_decided(evaluation, chosen)

    def _shares(self, answer: Any) -> Floats:
        x = vector_of(answer)
        if x.shape != (self.graph.num_actions,):
            raise UsageError(
                f"an answer to {self.problem} is a vector of shares, one for each of the {self.graph.num_actions} actions", "wrong-shape"
            )
        return x

    def answer_to_json(self, answer: Any) -> dict[str, Any]:
        g = self.graph
        if not self.fractional:
            return {"kind": "assignment", "actions": actions_to_json(g, answer)}
        shares = np.asarray(answer, dtype=np.float64)
        entries = [
            {"robot": g.robot_name(int(g.robot_of_action[a])), "action": g.action_name(a), "share": float(shares[a])}
            for a in np.nonzero(shares)[0].tolist()
        ]
        return {"kind": "shares", "actions": entries}

    def answer_from_json(self, data: Any) -> Any:
        g = self.graph
        if not self.fractional:
            return actions_from_json(g, data)
        if not isinstance(data, Mapping) or data.get("kind") != "shares" or not isinstance(data.get("actions"), list):
            raise InputError("not a division of robots among actions", expected='an object {"kind": "shares", "actions": [...]}')
        index, shares = action_index(g), np.zeros(g.num_actions)
        for number, entry in enumerate(data["actions"], start=1):
            if not isinstance(entry, Mapping) or str(entry.get("action")) not in index:
                raise InputError(f"entry {number} of the actions names no known action", "unknown-name", found=str(entry)[:80])
            share = entry.get("share")
            if not is_number(share):
                raise InputError(f"the share of action {entry['action']} is not a number", found=str(share)[:80])
            shares[index[str(entry["action"])]] += share
        return shares

    def answer_of(self, given: Any) -> Any:
        """A ``Selection``, or a list of action indices or names; of the fractional problem a vector of shape (actions,)."""
        return self._shares(given) if self.fractional else selection_of(given, lambda: action_index(self.graph), "action")

    def answer_to_frame(self, answer: Any) -> "pd.DataFrame":
        """One row per action that is used: robot, action, share, targets it sees."""
        import pandas as pd

        g = self.graph
        shares = self.shares_of(answer)
        used = np.nonzero(shares)[0].tolist()
        return pd.DataFrame(
            {
                "robot": [g.robot_name(int(g.robot_of_action[a])) for a in used],
                "action": [g.action_name(a) for a in used],
                "share": shares[used],
                "targets": [int(g.indptr[a + 1] - g.indptr[a]) for a in used],
            }
        )

    def to_instance(self) -> SensingGraph:
        return replace(self.graph, problem=self.problem)

    def __repr__(self) -> str:
        kind = "BottleneckSATA" + (" (fractional)" if self.fractional else "")
        return f"<{kind} {self.name}: {self.graph.num_robots} robots, {self.graph.num_targets} targets>"


@PROBLEMS.register("bottleneck")
@PROBLEMS.register("bottleneck-lp")
def _build(instance: Any, problem: str, settings: dict[str, Any]) -> BottleneckSATA:
    graph = graph_for(instance, problem)
    refuse_settings(problem, settings, ("fractional",))
    fractional = settings.get("fractional", problem == "bottleneck-lp")
    truth = {"true": True, "false": False}.get(str(fractional).lower())
    if truth is None or (problem == "bottleneck-lp" and not truth):
        raise UsageError(
            f"fractional must be true or false, and bottleneck-lp is fractional; found {fractional!r}",
            "malformed" if truth is None else "contradiction",
        )
    return BottleneckSATA(graph, fractional=truth)
