"""Winner takes all: one robot is credited for each target, and the total quality is largest."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...instances.errors import InputError, UsageError
from ...instances.number_arrays import entries_of
from ...instances.sata.constraints import PartitionMatroid
from ...instances.sata.sensing_graph import SensingGraph
from ...instances.sata.set_functions import FacilityLocation
from ..evaluation import Evaluation, judge
from ..problem import PROBLEMS, refuse_settings
from .selections import Selection, actions_from_json, actions_to_json, graph_for
from .submodular_selection import SubmodularSelection

if TYPE_CHECKING:
    import pandas as pd


class WinnerTakesAllSATA(SubmodularSelection):
    """Each robot takes at most one action, each target credits at most one robot: maximise the credited weights.

    With the best credit for each target this is facility location over the actions, under the partition matroid of the robots:
    F(S) = sum over targets of the largest weight that a chosen action gives it.

    Parameters
    ----------
    graph : SensingGraph
        Robots, their actions, and which targets these see.

    Notes
    -----
    Source: Sung (2019), (3.3), (3.4) and appendix A.2; docs/formulations/winner-takes-all.md#problem.
    """

    def __init__(self, graph: SensingGraph) -> None:
        self.graph = graph
        super().__init__(
            FacilityLocation(graph.indptr, graph.indices, graph.weights, graph.num_targets),
            PartitionMatroid(graph.robot_of_action, np.ones(graph.num_robots, dtype=np.int32), "robot", graph.robot_name),
            name=graph.name, problem="winner-takes-all", notes=graph.notes,
        )  # fmt: skip

    def digest(self) -> str:
        return self.digest_decided(self.graph.digest())

    def linear_entries(self) -> int:
        return len(self.graph.indices)

    def facts(self) -> dict[str, Any]:
        """Facts of the sensing graph."""
        return {"graph": self.graph.facts()}

    def to_instance(self) -> SensingGraph:
        return replace(self.graph, problem=self.problem)

    def element_name(self, element: int) -> str:
        return self.graph.action_name(element)

    def _constraint_name(self) -> str:
        return "one-action"

    def winners(self, elements: tuple[int, ...]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """The best credit: the robot for each target (-1 where no chosen action sees it) and the weight it brings.

        Ties go to the action that comes first in ``elements``.
        """
        g, chosen = self.graph, np.array(elements, dtype=np.int64)
        entries, counts = entries_of(g.indptr, chosen)
        rank = np.repeat(np.arange(len(chosen)), counts)
        at, weight = g.indices[entries], g.weights[entries]
        order = np.lexsort((rank, -weight, at))
        seen, first = np.unique(at[order], return_index=True)
        robot, best = np.full(g.num_targets, -1, dtype=np.int64), np.zeros(g.num_targets)
        robot[seen], best[seen] = g.robot_of_action[chosen[rank[order[first]]]], weight[order[first]]
        return robot, best

    def evaluate(self, answer: Any) -> Evaluation:
        """Recompute the value with the answer's credit, or with the best one; test actions and credit."""
        judged = super().evaluate(answer)
        if answer.winners is None:
            if not judged.feasible:
                return judged
            seen = int((self.winners(answer.elements)[0] >= 0).sum())
            return Evaluation(judged.values, judged.checks, judged.violations, {**judged.quantities, "targets": float(seen)})
        g = self.graph
        winners = np.asarray(answer.winners, dtype=np.int64)
        if winners.shape != (g.num_targets,):
            raise UsageError(f"winners must have one entry a target ({g.num_targets}), not {len(winners)}", "wrong-shape")
        unknown = ((winners < -1) | (winners >= g.num_robots)).astype(np.float64)
        credit, faults = judge(
            "credit", unknown, lambda k: f"target {g.target_name(k)} credits robot number {winners[k]}, which does not exist"
        )  # fmt: skip
        weight = self.credited(answer)
        return Evaluation(
            (math.fsum(weight),), (*judged.checks, credit), (*judged.violations, *faults),
            {**judged.quantities, "targets": float((weight > 0).sum())},
        )  # fmt: skip

    def credited(self, answer: Selection) -> NDArray[np.float64]:
        """The weight that each target brings, by the answer's credit or by the best one."""
        g = self.graph
        if answer.winners is None:
            return self.winners(answer.elements)[1]
        chosen = np.array(sorted({e for e in answer.elements if 0 <= e < g.num_actions}), dtype=np.int64)
        entries, counts = entries_of(g.indptr, chosen)
        at = g.indices[entries]
        mine = np.asarray(answer.winners)[at] == np.repeat(g.robot_of_action[chosen], counts)
        return np.asarray(np.bincount(at[mine], g.weights[entries][mine], minlength=g.num_targets), dtype=np.float64)

    def answer_to_json(self, answer: Selection) -> dict[str, Any]:
        """Actions by robot, and for each seen target the robot that is credited with it."""
        g = self.graph
        robots = self.winners(answer.elements)[0] if answer.winners is None else np.asarray(answer.winners)
        credit = [{"target": g.target_name(t), "robot": g.robot_name(int(r))} for t, r in enumerate(robots) if r >= 0]
        return {"kind": "assignment", "actions": actions_to_json(g, answer), "targets": credit}

    def answer_from_json(self, data: Any) -> Selection:
        chosen = actions_from_json(self.graph, data)
        if "targets" not in data:
            return chosen
        g = self.graph
        robots = {g.robot_name(i): i for i in range(g.num_robots)}
        targets = {g.target_name(t): t for t in range(g.num_targets)}
        credit = [-1] * g.num_targets
        if not isinstance(data["targets"], list):
            raise InputError("the answer's targets are not a list")
        for k, entry in enumerate(data["targets"], start=1):
            if not isinstance(entry, Mapping) or str(entry.get("target")) not in targets or str(entry.get("robot")) not in robots:
                raise InputError(
                    f"entry {k} of the answer's targets names no known target and robot", "unknown-name", found=str(entry)[:80]
                )
            target = targets[str(entry["target"])]
            if credit[target] >= 0:
                raise InputError(f"target {g.target_name(target)} is credited twice", "duplicate")
            credit[target] = robots[str(entry["robot"])]
        return Selection(chosen.elements, tuple(credit))

    def answer_to_frame(self, answer: Selection) -> "pd.DataFrame":
        """One row per target: target, robot, action, weight; empty names where nobody sees it."""
        import pandas as pd

        g = self.graph
        robots = self.winners(answer.elements)[0] if answer.winners is None else np.asarray(answer.winners)
        action_of = {int(g.robot_of_action[a]): a for a in answer.elements}
        weights = self.credited(answer)
        rows = []
        for t, r in enumerate(robots.tolist()):
            action = action_of.get(r)
            rows.append((g.target_name(t), g.robot_name(r) if r >= 0 else "", "" if action is None else g.action_name(action), weights[t]))
        return pd.DataFrame(rows, columns=["target", "robot", "action", "weight"])

    def __repr__(self) -> str:
        return f"<WinnerTakesAllSATA {self.name}: {self.graph.num_robots} robots, {self.graph.num_targets} targets>"


@PROBLEMS.register("winner-takes-all")
def _build(instance: Any, problem: str, settings: dict[str, Any]) -> WinnerTakesAllSATA:
    graph = graph_for(instance, problem)
    refuse_settings(problem, settings)
    return WinnerTakesAllSATA(graph)
