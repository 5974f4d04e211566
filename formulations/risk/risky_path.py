"""Paths at risk: the least risky way to a goal, and the most reward per risk."""

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ...instances.errors import InputError, UsageError
from ...instances.risk.element import RiskElement, TraverseElement
from ...instances.risk.risky_graph import OBJECTIVES, RiskyGraph
from ...instances.text import shown
from ..evaluation import Check, Checklist, Evaluation
from ..evidence import Evidence, Reason
from ..problem import PROBLEMS, Problem, refuse_settings
from ..references import indices_of
from .marked_paths import MOST_LABELS, CutShortError, free_reward
from .moves import Floats, MoveGraph, hazard_of

if TYPE_CHECKING:
    import pandas as pd

Path = tuple[int, ...]

CHECKS = ("start", "end", "moves", "simple", "passable", "ratio")


class RiskyPath(Problem):
    """A path without repetition from a start, at the least risk of not being finished, or with the most reward per risk.

    The risk of a path is ``1 - prod (1 - r)`` over its states and the risk elements, each conditional on what came before. An answer is a
    tuple of state numbers.

    Parameters
    ----------
    graph : RiskyGraph
        States, moves, goals and risk elements.
    objective : str, optional
        ``risk``: least risk at a goal. ``hazard``: the same order, as ``-ln(1 - risk)``, which adds up along a path. ``reward-per-risk``:
        most reward collected per risk, at a goal or, without goals, anywhere. That of the graph by default.

    Raises
    ------
    InputError
        If the least risk of no goal is asked for, or there is nothing to reward, or a reward without any risk, so that no ratio is the
        largest.

    Notes
    -----
    Source: Xiao (2019), (3.7) and section 4.1; docs/formulations/risky-path.md.
    """

    family: ClassVar[str] = "risky-path"

    def __init__(self, graph: RiskyGraph, objective: str | None = None) -> None:
        if objective is not None and objective not in OBJECTIVES:
            raise UsageError(f"objective must be one of {', '.join(OBJECTIVES)}, not {objective!r}", "unknown-name")
        self.graph = graph if objective is None or objective == graph.objective else replace(graph, objective=objective)
        self.name, self.problem, self.notes, self.objective = graph.name, "risky-path", graph.notes, self.graph.objective
        assert self.graph.rewards is not None
        self.rewards: Floats = self.graph.rewards
        if self.objective != "reward-per-risk" and not graph.goals:
            raise InputError(f"the least {self.objective} needs a goal: without one it is that of the start alone", "missing")
        if self.objective == "reward-per-risk":
            self._check_ratio()

    def _check_ratio(self) -> None:
        if not self.rewards.any():
            raise InputError("reward per risk needs a state with a reward: without one it is 0, or 0/0, wherever a path leads", "missing")
        try:
            free = free_reward(self)
        except CutShortError:
            raise InputError(
                f"whether a reward can be had without risk was not decided with {MOST_LABELS} labels, and its ratio would have no maximum",
                "too-large",
                expected="a risk, however small, at the start",
            ) from None
        if free is not None:
            way = " ".join(map(self.graph.state_name, free[-5:]))
            raise InputError(
                f"reward per risk has no maximum: a reward is reached without risk, by {'... ' if len(free) > 5 else ''}{way}",
                "contradiction",
            )

    @property
    def senses(self) -> tuple[str, ...]:
        return ("max" if self.objective == "reward-per-risk" else "min",)

    @property
    def size(self) -> int:
        return self.graph.num_states

    @cached_property
    def moves(self) -> MoveGraph:
        """Pairs of moves that may follow each other, with the least hazard of each."""
        return MoveGraph(self.graph)

    def digest(self) -> str:
        return self.graph.digest()

    def features(self) -> frozenset[str]:
        """``objective:...``, one of ``goals`` and ``any-end``, and the categories of risk as ``locale-risk``, ``action-risk``,
        ``traverse-risk``."""
        marks = {f"{element.category}-risk" for element in self.graph.elements}
        return frozenset({f"objective:{self.objective}", "goals" if self.graph.goals else "any-end", *marks})

    def facts(self) -> dict[str, Any]:
        """Sizes, start and goals, the risk elements by category, and rewards."""
        g = self.graph
        return {
            "objective": self.objective, "states": g.num_states, "moves": len(g.tail), "start": g.state_name(g.start),
            "goals": [g.state_name(goal) for goal in g.goals], "risks": "conditional" if g.conditional else "not conditional",
            **{f"{name}_risks": [e.label for e in g.elements if e.category == name] for name in ("locale", "action", "traverse")},
            "rewarding_states": int(np.count_nonzero(self.rewards)), "total_reward": float(self.rewards.sum()), "discount": g.discount,
        }  # fmt: skip

    def risks(self, path: Sequence[int]) -> dict[str, list[float]]:
        """Risk of each element at each state of a path, by the element's label; empty lists of an empty path."""
        after = list(path)
        state, before = [-1, *after[:-1]], [-1, -1, *after[:-2]]
        return {e.label: self._along(e, before[: len(after)], state[: len(after)], after) for e in self.graph.elements}

    def _along(self, element: RiskElement, before: list[int], state: list[int], after: list[int]) -> list[float]:
        if not isinstance(element, TraverseElement) or not after:
            risks: list[float] = self.graph.least_risks(element, before, state, after).tolist()
            return risks
        memory, risk = element.begin(self.graph, after[0])
        risks = [risk]
        for here, there in itertools.pairwise(after):
            memory, risk = element.step(self.graph, memory, here, there)
            risks.append(risk)
        return risks

    def evaluate(self, answer: Any) -> Evaluation:
        """Recompute risk, reward and every rule of the path ``answer``."""
        path, g = self._path(answer), self.graph
        name, checklist = g.state_name, Checklist()
        checklist.test("start", path[0] != g.start, f"the path begins at {name(path[0])}, not at {name(g.start)}")
        if g.goals:
            checklist.test("end", path[-1] not in g.goals, f"the path ends at {name(path[-1])}, which is no goal")
        for here, there in itertools.pairwise(path):
            checklist.test("moves", there not in g.neighbours(here), f"no move leads from {name(here)} to {name(there)}")
        for k, state in enumerate(path):
            checklist.test("simple", state in path[:k], f"the path comes to {name(state)} again")
        walkable = all(violation.check != "moves" for violation in checklist.violations)
        risks = self.risks(path) if walkable else {}
        hazards = {label: hazard_of(values) for label, values in risks.items()}
        hazard = math.fsum(hazards.values()) if walkable else math.inf
        checklist.test("passable", walkable and hazard == math.inf, "nobody gets through alive: a risk on the path is 1")
        risk, reward = -math.expm1(-hazard), self._reward(path)
        if self.objective == "reward-per-risk":
            worth = "0/0" if reward == 0.0 else f"{reward:.9g}/0"
            checklist.test("ratio", risk == 0.0, f"the path has no risk, so that its reward per risk, {worth}, is not a number")
        each = [r for values in risks.values() for r in values]
        ratio = reward / risk if risk > 0.0 else 0.0
        quantities = {"risk": risk, "sum of risks": math.fsum(each), "moves": float(len(path) - 1)}
        if self.rewards.any():
            quantities |= {"reward": reward, "reward per risk": ratio}
        if g.positions is not None:
            quantities["length"] = math.fsum(math.dist(g.positions[a], g.positions[b]) for a, b in itertools.pairwise(path))
        quantities |= {f"risk of {label}": -math.expm1(-value) for label, value in hazards.items()}
        value = {"risk": risk, "hazard": hazard, "reward-per-risk": ratio}[self.objective]
        return Evaluation((value,), self._checks(checklist), tuple(checklist.violations), quantities)

    def _checks(self, checklist: Checklist) -> tuple[Check, ...]:
        left_out = {"end"} if not self.graph.goals else set()
        if self.objective != "reward-per-risk":
            left_out.add("ratio")
        return checklist.checks([name for name in CHECKS if name not in left_out])

    def _reward(self, path: Sequence[int]) -> float:
        """Reward collected on the way, the discount applied at each move; that of the start counts where nothing follows."""
        total = 0.0
        for state in path[1:]:
            total = self.graph.discount * total + float(self.rewards[state])
        return total if len(path) > 1 else float(self.rewards[path[0]])

    def _path(self, answer: Any) -> Path:
        if not isinstance(answer, tuple) or not answer or not all(isinstance(s, int | np.integer) for s in answer):
            raise InputError("an answer is a tuple of one or more states", found=shown(str(answer)))
        for state in answer:
            if not 0 <= state < self.graph.num_states:
                raise InputError(
                    "the path names a state that does not exist",
                    "unknown-name",
                    expected=f"0 to {self.graph.num_states - 1}",
                    found=str(state),
                )
        return tuple(int(s) for s in answer)

    def answer_at_hand(self) -> Path | None:
        """A walk of least hazard to a goal, or without goals to a reward, if one comes to no state twice."""
        ends = self.graph.goals or np.nonzero(self.rewards)[0].tolist()
        walks = (self.moves.walk(end) for end in ends)
        return next((walk for walk in walks if walk is not None and len(set(walk)) == len(walk)), None)

    def infeasibility_reasons(self, stopped: Callable[[], bool] = lambda: False) -> Iterator[Reason]:
        """The reason that no goal can be reached, with potentials that prove it."""
        g = self.graph
        if not g.goals or np.isfinite(self.moves.to_states()[list(g.goals)]).any():
            return
        evidence = self.moves.evidence(math.inf)
        names = ", ".join(g.state_name(goal) for goal in g.goals[:5])
        cut = np.isinf(self.moves.with_any_risk().to_states()[list(g.goals)]).all()
        lost = "the start has a risk of 1 itself" if self.moves.start_hazard == math.inf else "a risk of 1 is on every way"
        why = "no moves lead there" if cut else lost
        yield Reason("goal", names, f"{names} cannot be reached from {g.state_name(g.start)}: {why}", evidence)

    def why_none(self, kind: str, data: Mapping[str, Any]) -> str:
        reasons = (reason.message for reason in self.infeasibility_reasons())
        return next(reasons, "no goal can be reached from the start at a risk below 1")

    def answer_to_json(self, answer: Any) -> dict[str, Any]:
        return {"kind": "path", "vertices": [self.graph.state_name(state) for state in answer]}

    def answer_from_json(self, data: Any) -> Path:
        names = data.get("vertices") if isinstance(data, Mapping) and data.get("kind") == "path" else None
        if not isinstance(names, list) or not names or not all(isinstance(name, str) for name in names):
            raise InputError("not a path", expected='{"kind": "path", "vertices": [names of states]}')
        index = {self.graph.state_name(k): k for k in range(self.graph.num_states)}
        for name in names:
            if name not in index:
                raise InputError(f"the path names an unknown state {shown(name)}", "unknown-name")
        return tuple(index[name] for name in names)

    def answer_of(self, given: Any) -> Path:
        """A tuple or list of states, by number or name."""
        if isinstance(given, str | bytes) or not isinstance(given, Sequence | np.ndarray):
            raise UsageError(f"an answer to {self.problem} is a sequence of states", "malformed")
        if all(isinstance(s, int | np.integer) and not isinstance(s, bool) for s in given):
            return tuple(int(s) for s in given)
        return tuple(indices_of(given, {self.graph.state_name(k): k for k in range(self.graph.num_states)}, "state"))

    def answer_to_frame(self, answer: Any) -> "pd.DataFrame":
        """One row per state: its name, place, reward, the risk of each element, and the risk of the path until then."""
        import pandas as pd

        path = self._path(answer)
        columns: dict[str, Any] = {"state": [self.graph.state_name(s) for s in path]}
        if self.graph.positions is not None:
            columns |= dict(zip("xyz", self.graph.positions[list(path)].T, strict=False))
        if self.rewards.any():
            columns["reward"] = self.rewards[list(path)]
        risks = self.risks(path)
        columns |= risks
        with np.errstate(divide="ignore"):
            hazard = -np.log1p(-np.array(list(risks.values())).reshape(-1, len(path))).sum(axis=0)
        columns["risk"] = 1.0 - np.exp(-np.cumsum(hazard))
        return pd.DataFrame(columns)

    def to_instance(self) -> RiskyGraph:
        return self.graph

    def __repr__(self) -> str:
        return f"<RiskyPath {self.name}: {self.objective}, {self.graph!r}>"


def unreachable(problem: RiskyPath) -> Evidence | None:
    """Evidence that no goal can be reached; None where one may be."""
    return next((reason.evidence for reason in problem.infeasibility_reasons()), None)


@PROBLEMS.register("risky-path")
def _build(instance: Any, problem: str, settings: dict[str, Any]) -> RiskyPath:
    if not isinstance(instance, RiskyGraph):
        raise UsageError(f"{instance.name} has no states at risk, so it cannot be read as {problem}", "foreign")
    refuse_settings(problem, settings, ("objective", "discount", "start", "goals"))
    changed: dict[str, Any] = {}
    names = [instance.state_name(k) for k in range(instance.num_states)]
    for key in ("start", "goals"):
        if key in settings:
            asked = [part.strip() for part in str(settings[key]).split(",") if part.strip()]
            chosen = tuple(indices_of(asked, {name: k for k, name in enumerate(names)}, "state"))
            if key == "start" and len(chosen) != 1:
                raise UsageError("start must be one state", "wrong-shape")
            changed[key] = chosen[0] if key == "start" else chosen
    if "discount" in settings:
        try:
            changed["discount"] = float(settings["discount"])
        except ValueError:
            raise UsageError(f"discount must be a number, not {settings['discount']!r}", "malformed") from None
    objective = settings.get("objective")
    return RiskyPath(replace(instance, **changed) if changed else instance, objective)
