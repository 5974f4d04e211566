"""Form ``time-expanded``: where each robot is after each step, and flows of contact from the base."""

from typing import Any

import numpy as np

from ....instances.errors import InputError
from ....instances.number_arrays import Floats, Integers
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import Program, Rows, Variables
from ...programs.rows import rows
from ...programs.size import ProgramSize
from ..room_exploration import GO, MAP, SEARCH, Plans, RoomExploration

MOST_VARIABLES = 100_000
DEEDS = ("go", "map", "search")


def build(problem: RoomExploration) -> Compiled:
    """Robot r makes move a, from a room to a room by an action, in step t (m_rat, t = 1..T; of T steps). Visits and observations of kind g
    gain by their number, k-th times G_gvk; robot r has contact after step t where K_rt is 1, by a flow f from the base b over pairs of
    robots that hear each other (c)::

        max  sum G_gvk z_gvk,   0 <= z <= 1
        start[r]        sum_(a from start of r) m_ra1 = 1
        keep[r,v,t]     sum_(a into v) m_rat = sum_(a out of v) m_ra,t+1
        gain[g,v]       sum_k z_gvk <= sum_(r,t, a gains g in v) m_rat
        base[r,t]       f_brt <= n sum_(a into rooms that hear b) m_rat                  n robots
        link[q,r,t]     f_qrt <= n c_qrt
        hears[q,r,v,t]  c_qrt + sum_(a into v) m_qat <= 1 + sum_(a into rooms that hear v) m_rat
        flow[r,t]       f_brt + sum_q f_qrt - sum_q f_rqt = K_rt
        contact[r,t]    sum_(t <= s <= t + S) K_rs >= 1,         end[r]  K_rT = 1

    Gains never rise with k, so that the first ones are taken. Source: Zhang (2015), section 5.3, as a program;
    docs/formulations/room-exploration.md#form.
    """
    plan = _PlanColumns(problem)
    return Compiled(Program("time-expanded", "max", tuple(plan.blocks), tuple(plan.constraints())), problem, plan.decode, plan.encode)


class _PlanColumns:
    """The program's columns by what they stand for, its rows, and how answers and points become each other.

    ``m`` has the shape (robots, moves, steps), ``heard`` and ``direct`` (robots, steps), ``flow`` and ``link`` (pairs, steps), and each of
    ``z``, one a kind of gain, (rooms, visits); ``first`` and ``second`` are the robots of each pair.
    """

    def __init__(self, problem: RoomExploration) -> None:
        self.problem, self.instance = problem, problem.instance
        self.blocks: list[Variables] = []
        self.size = 0
        n, last = self.instance.num_robots, self.instance.steps
        self.tail, self.head, self.action = self._moves()
        robots, rooms = [str(k + 1) for k in range(n)], [self.instance.room_name(v) for v in range(self.instance.num_rooms)]
        r, a, t = (index.ravel() for index in np.indices((n, len(self.tail), last)))
        moves = (r, self.tail[a], self.head[a], self.action[a], t + 1)
        self.m = self._add("m", moves, (robots, rooms, rooms, DEEDS, None)).reshape(n, -1, last)
        self.z = [
            self._add(f"z-{name}", tuple(i.ravel() for i in np.indices(gain.shape)), (rooms, None), cost=gain.ravel(), whole=False).reshape(
                gain.shape
            )
            for name, gain in zip(DEEDS, (self.instance.exploring, self.instance.mapping, self.instance.searching), strict=True)
        ]
        each = tuple(index.ravel() for index in np.indices((n, last)))
        self.heard = self._add("K", each, (robots, None)).reshape(n, last)
        self.direct = self._add("b", each, (robots, None), float(n), whole=False).reshape(n, last)
        self.first, self.second = np.argwhere(~np.eye(n, dtype=bool)).T
        pair, at = (index.ravel() for index in np.indices((len(self.first), last)))
        sent = (self.first[pair], self.second[pair], at + 1)
        self.flow = self._add("f", sent, (robots, robots, None), float(n), whole=False).reshape(-1, last)
        self.link = self._add("c", sent, (robots, robots, None)).reshape(-1, last)

    def _moves(self) -> tuple[Integers, Integers, Integers]:
        """Tail, head and action of every move: through doors, staying, mapping, searching."""
        a, b = np.nonzero(self.instance.adjacent)
        every = np.arange(self.instance.num_rooms)
        action = np.repeat([GO, MAP, SEARCH], [len(a) + len(every), len(every), len(every)])
        return np.concatenate([a, every, every, every]), np.concatenate([b, every, every, every]), action

    def _add(
        self, name: str, keys: tuple[Integers, ...], labels: tuple[Any, ...], upper: float = 1.0, *, cost: Any = 0.0, whole: bool = True
    ) -> Integers:
        """The columns of one more block of variables."""
        count = len(keys[0])
        cost = np.array(np.broadcast_to(np.asarray(cost, dtype=np.float64), count))
        self.blocks.append(Variables(name, keys, labels, np.zeros(count), np.full(count, upper), cost, integer=whole))
        self.size += count
        return np.arange(self.size - count, self.size)

    def _gaining(self, kind: int, room: int) -> Integers:
        """Columns of the moves that gain in a room by exploring, mapping or searching; to stay there explores nothing."""
        moved = (self.tail != self.head) | (self.action != GO)
        return np.asarray(self.m[:, np.nonzero((self.action == kind) & moved & (self.head == room))[0], :].ravel())

    def constraints(self) -> list[Rows]:
        """The rows in the order of the form; each is a list of columns with their coefficient."""
        m, heard, direct, flow, link, instance = self.m, self.heard, self.direct, self.flow, self.link, self.instance
        n, last, silence, inf = instance.num_robots, instance.steps, instance.silence, np.inf
        robots, rooms, steps = range(n), range(instance.num_rooms), range(last)
        starts = list(enumerate(instance.starts.tolist()))
        into = [np.nonzero(self.head == v)[0] for v in rooms]
        outof = [np.nonzero(self.tail == v)[0] for v in rooms]
        hearing = [np.nonzero(instance.linked[v][self.head])[0] for v in rooms]
        pairs = list(enumerate(zip(self.first.tolist(), self.second.tolist(), strict=True)))
        return [
            _block("start", [[(m[r, outof[v], 0], 1.0)] for r, v in starts], 1.0, 1.0),
            _block("elsewhere", [[(m[r, np.nonzero(self.tail != v)[0], 0], 1.0)] for r, v in starts], 0.0, 0.0),
            _block("keep", [
                [(m[r, into[v], t], 1.0), (m[r, outof[v], t + 1], -1.0)] for r in robots for v in rooms for t in range(last - 1)
            ], 0.0, 0.0),
            _block("gain", [[(self.z[g][v], 1.0), (self._gaining(g, v), -1.0)] for g in range(3) for v in rooms], -inf, 0.0),
            _block("base", [
                [(direct[r, [t]], 1.0), (m[r, hearing[instance.base], t], -float(n))] for r in robots for t in steps
            ], -inf, 0.0),
            _block("link", [[(flow[k, [t]], 1.0), (link[k, [t]], -float(n))] for k, _ in pairs for t in steps], -inf, 0.0),
            _block("hears", [
                [(link[k, [t]], 1.0), (m[q, into[v], t], 1.0), (m[r, hearing[v], t], -1.0)]
                for k, (q, r) in pairs for v in rooms for t in steps
            ], -inf, 1.0),
            _block("flow", [
                [(direct[r, [t]], 1.0), (flow[self.second == r, t], 1.0), (flow[self.first == r, t], -1.0), (heard[r, [t]], -1.0)]
                for r in robots for t in steps
            ], 0.0, 0.0),
            _block("contact", [[(heard[r, t : t + silence + 1], 1.0)] for r in robots for t in range(last - silence)], 1.0, inf),
            _block("end", [[(heard[r, [last - 1]], 1.0)] for r in robots], 1.0, 1.0),
        ]  # fmt: skip

    def decode(self, vector: Floats) -> Plans:
        chosen = vector[self.m].argmax(axis=1)
        return tuple(tuple((int(self.head[k]), int(self.action[k])) for k in moves) for moves in chosen.tolist())

    def encode(self, answer: Any) -> Floats:
        judged = self.problem.evaluate(answer)
        if not judged.feasible:
            raise InputError(judged.violations[0].message, "unsupported")
        vector = np.zeros(self.size)
        number = {move: k for k, move in enumerate(zip(self.tail.tolist(), self.head.tolist(), self.action.tolist(), strict=True))}
        for robot, deeds in enumerate(answer):
            here = int(self.instance.starts[robot])
            for step, (room, act) in enumerate(deeds):
                vector[self.m[robot, number[here, room, act], step]] = 1.0
                here = room
        for g, columns in enumerate(self.z):
            done = np.array([vector[self._gaining(g, v)].sum() for v in range(len(columns))])
            vector[columns] = np.arange(len(columns[0])) < done[:, None]
        contacts = self.problem.contacts(answer)
        vector[self.heard] = contacts.T
        for step in range(self.instance.steps):
            self._send(vector, step, [deeds[step][0] for deeds in answer], np.nonzero(contacts[step])[0].tolist())
        return vector

    def _send(self, vector: Floats, step: int, at: list[int], heard: list[int]) -> None:
        """Send one unit of flow from the base to each robot in contact, along a tree of robots that hear each other."""
        linked = self.instance.linked
        pair = {ends: k for k, ends in enumerate(zip(self.first.tolist(), self.second.tolist(), strict=True))}
        parent = {k: -1 for k, room in enumerate(at) if linked[self.instance.base, room]}
        ahead = list(parent)
        while ahead:
            k = ahead.pop()
            for other in range(len(at)):
                if other not in parent and linked[at[k], at[other]]:
                    parent[other] = k
                    ahead.append(other)
        for robot in heard:
            here = robot
            while parent[here] >= 0:
                sent = pair[parent[here], here]
                vector[self.flow[sent, step]] += 1.0
                vector[self.link[sent, step]] = 1.0
                here = parent[here]
            vector[self.direct[here, step]] += 1.0


def _block(name: str, parts: list[list[tuple[Integers, float]]], lower: float, upper: float) -> Rows:
    entries = [(np.full(len(columns), k), columns, value) for k, row in enumerate(parts) for columns, value in row if len(columns)]
    return rows(name, len(parts), entries, lower, upper, (np.arange(len(parts)),))


def _refuses(problem: Any) -> frozenset[str]:
    instance = problem.instance
    moves = instance.num_robots * instance.steps * (2 * len(instance.doors) + 3 * instance.num_rooms)
    return frozenset({f"more than {MOST_VARIABLES:,} moves"}) if moves > MOST_VARIABLES else frozenset()


def _size(problem: RoomExploration) -> ProgramSize:
    instance = problem.instance
    n, rooms, last = float(instance.num_robots), float(instance.num_rooms), float(instance.steps)
    doors, heard = 2.0 * len(instance.doors), float(instance.linked.mean())
    moves, pairs = doors + 3.0 * rooms, n * (n - 1.0)
    gains = float(instance.exploring.size + instance.mapping.size + instance.searching.size)
    hears = pairs * last * moves * (1.0 + rooms * heard)
    return ProgramSize(
        n * last * (moves + 2.0) + 2.0 * pairs * last + gains, n * rooms * last + pairs * rooms * last + 4.0 * n * last + 3.0 * rooms,
        n * last * (3.0 * moves + instance.silence + 8.0) + gains + hears + (rooms + 4.0) * pairs * last,
    )  # fmt: skip


FORMS.enter(Form("time-expanded", "room-exploration", frozenset({"contact"}), build, refuses=_refuses, size=_size))
