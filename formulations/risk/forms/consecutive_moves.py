"""Form ``consecutive-moves``: one unit of flow on the graph whose vertices are moves, for paths of least hazard."""

import itertools
import math
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ...evidence import Evidence
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import Program, Variables
from ...programs.rows import rows
from ...programs.size import ProgramSize
from ..moves import Floats
from ..risky_path import Path, RiskyPath


def build(problem: RiskyPath) -> Compiled:
    """Move b follows move a (y_ab), leaves the start (s_b), ends at a goal (t_a)::

        min  h_0 + sum h_b s_b + sum h_ab y_ab,   all binary
        start      sum_b s_b = 1
        flow[a]    s_a + sum_b y_ba - sum_b y_ab - t_a = 0
        visit[v]   sum of s_b + sum of y_ab over moves b into v <= 1

    Without the last rows a shortest walk, whose linear program has whole vertices. Loops apart from the path cost nothing less than 0, and
    decoding leaves them out. Prices of ``visit`` are a Lagrangian bound above that of walks.
    """
    graph, moves = problem.graph, problem.moves
    m, names = len(graph.tail), [graph.state_name(s) for s in range(graph.num_states)]
    ends = np.nonzero(np.isin(graph.head, list(graph.goals)) & (graph.head != graph.start))[0]
    move_names = [f"{names[a]} {names[b]}" for a, b in zip(graph.tail.tolist(), graph.head.tolist(), strict=True)]
    blocks = [
        Variables(name, keys, (move_names,) * len(keys), np.zeros(len(cost)), np.ones(len(cost)), cost, integer=True)
        for name, keys, cost in (
            ("begin", (moves.begin,), moves.begin_hazard),
            ("follow", (moves.first, moves.second), moves.hazard),
            ("end", (ends,), np.zeros(len(ends))),
        )
    ]
    begin, follow, end = np.split(np.arange(sum(b.size for b in blocks)), np.cumsum([b.size for b in blocks])[:-1])
    start = rows("start", 1, [(np.zeros(len(begin), int), begin, 1.0)], 1.0, 1.0)
    flow = rows(
        "flow", m, [(moves.begin, begin, 1.0), (moves.second, follow, 1.0), (moves.first, follow, -1.0), (ends, end, -1.0)],
        0.0, 0.0, (np.arange(m),), (move_names,),
    )  # fmt: skip
    head = graph.head.astype(np.int64)
    visit = rows(
        "visit", graph.num_states, [(head[moves.begin], begin, 1.0), (head[moves.second], follow, 1.0)], upper=1.0,
        keys=(np.arange(graph.num_states),), labels=(names,),
    )  # fmt: skip

    def decode(vector: Floats) -> Path:
        used = vector > 0.5
        after = dict(zip(moves.first[used[follow]].tolist(), moves.second[used[follow]].tolist(), strict=True))
        at, path = next(iter(moves.begin[used[begin]].tolist()), None), [graph.start]
        while at is not None and len(path) <= m:
            path.append(int(head[at]))
            at = after.get(at)
        return tuple(path)

    def encode(answer: Any) -> Floats:
        numbers = {ends: k for k, ends in enumerate(zip(graph.tail.tolist(), graph.head.tolist(), strict=True))}
        try:
            taken = [numbers[pair] for pair in itertools.pairwise(answer)]
        except KeyError as fault:
            raise InputError(f"no move leads along {fault}", "unknown-name") from None
        pairs = set(itertools.pairwise(taken))
        x = np.zeros(len(begin) + len(follow) + len(end))
        x[begin] = moves.begin == taken[0] if taken else 0.0
        x[follow] = [pair in pairs for pair in zip(moves.first.tolist(), moves.second.tolist(), strict=True)]
        x[end] = ends == taken[-1] if taken else 0.0
        return x

    def dual_evidence(row_duals: Floats) -> Evidence:
        duals = np.asarray(row_duals, dtype=np.float64)
        prices = np.maximum(-duals[1 + m :], 0.0)
        potentials = moves.priced(prices)
        value = float(potentials[ends].min(initial=math.inf)) - math.fsum(prices)
        listed = [None if math.isinf(p) else p for p in potentials.tolist()]
        return Evidence("move-potentials", "LP duals of consecutive-moves", value, {"potentials": listed, "prices": prices.tolist()})

    program = Program("consecutive-moves", "min", tuple(blocks), (start, flow, visit), moves.start_hazard)
    return Compiled(program, problem, decode, encode, dual_evidence)


def _refuses(problem: RiskyPath) -> frozenset[str]:
    return frozenset({"a start that is a goal"}) if problem.graph.start in problem.graph.goals else frozenset()


def _size(problem: RiskyPath) -> ProgramSize:
    graph, moves = problem.graph, problem.moves
    begin, follow, edges = float(len(moves.begin)), float(len(moves.first)), float(len(graph.tail))
    return ProgramSize(begin + follow + edges, edges + graph.num_states + 1.0, 3.0 * (begin + follow) + edges)


FEATURES = frozenset({"objective:hazard", "goals", "locale-risk", "action-risk"})

FORMS.enter(Form("consecutive-moves", "risky-path", FEATURES, build, refuses=_refuses, size=_size))
