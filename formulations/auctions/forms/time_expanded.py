"""Form ``time-expanded``: where each robot is after each step, and flows of contact from the base."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import Program, Rows, Variables
from ...programs.rows import rows
from ...programs.size import ProgramSize
from ..room_exploration import GO, MAP, SEARCH, Plans, RoomExploration

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

MOST_VARIABLES = 100_000


class _Columns:
    """Blocks of variables one after the other."""

    def __init__(self) -> None:
        self.blocks: list[Variables] = []
        self.size = 0

    def add(
        self, name: str, keys: tuple[Integers, ...], labels: tuple[Any, ...], upper: float, cost: Any = 0.0, whole: bool = True
    ) -> Integers:
        count = len(keys[0])
        cost = np.array(np.broadcast_to(np.asarray(cost, dtype=np.float64), count))
        self.blocks.append(Variables(name, keys, labels, np.zeros(count), np.full(count, upper), cost, integer=whole))
        self.size += count
        return np.arange(self.size - count, self.size)


def _moves(problem: RoomExploration) -> tuple[Integers, Integers, Integers]:
    """Tail, head and action of every move: through doors, staying, mapping, searching."""
    instance = problem.instance
    a, b = np.nonzero(instance.adjacent)
    every = np.arange(instance.num_rooms)
    ends = [(a, b, GO), (every, every, GO), (every, every, MAP), (every, every, SEARCH)]
    tail, head = (np.concatenate([part[k] for part in ends]) for k in (0, 1))
    return tail, head, np.concatenate([np.full(len(part[0]), part[2]) for part in ends])


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
    instance = problem.instance
    n, rooms, last = instance.num_robots, instance.num_rooms, instance.steps
    tail, head, action = _moves(problem)
    count, linked = len(tail), instance.linked
    columns = _Columns()
    names = [str(k + 1) for k in range(n)], [instance.room_name(v) for v in range(rooms)], ("go", "map", "search")
    r, a, t = (i.ravel() for i in np.indices((n, count, last)))
    m = columns.add("m", (r, tail[a], head[a], action[a], t + 1), (names[0], names[1], names[1], names[2], None), 1.0).reshape(
        n, count, last
    )
    gains = [instance.exploring, instance.mapping, instance.searching]
    z = [
        columns.add(f"z-{names[2][g]}", (*(i.ravel() for i in np.indices(gain.shape)),), (names[1], None), 1.0, gain.ravel(), False)
        for g, gain in enumerate(gains)
    ]
    heard = columns.add("K", tuple(i.ravel() for i in np.indices((n, last))), (names[0], None), 1.0).reshape(n, last)
    direct = columns.add("b", tuple(i.ravel() for i in np.indices((n, last))), (names[0], None), float(n), whole=False).reshape(n, last)
    pair = [(p, q) for p in range(n) for q in range(n) if p != q]
    p, q = (np.array([k[i] for k in pair], dtype=np.int64) for i in (0, 1))
    of, at = (i.ravel() for i in np.indices((len(pair), last)))
    flow = columns.add("f", (p[of], q[of], at + 1), (names[0], names[0], None), float(n), whole=False).reshape(-1, last)
    link = columns.add("c", (p[of], q[of], at + 1), (names[0], names[0], None), 1.0).reshape(-1, last)

    into = [np.nonzero(head == v)[0] for v in range(rooms)]
    outof = [np.nonzero(tail == v)[0] for v in range(rooms)]
    hearing = [np.nonzero(linked[v][head])[0] for v in range(rooms)]
    blocks: list[Rows] = []

    def block(name: str, parts: list[list[tuple[Integers, float]]], lower: float, upper: float) -> None:
        """One row of columns and coefficients each."""
        entries = [(np.full(len(c), k), c, v) for k, row in enumerate(parts) for c, v in row if len(c)]
        blocks.append(rows(name, len(parts), entries, lower, upper, (np.arange(len(parts)),)))

    inf = np.inf
    block("start", [[(m[k, outof[int(s)], 0], 1.0)] for k, s in enumerate(instance.starts)], 1.0, 1.0)
    block("elsewhere", [[(m[k, np.nonzero(tail != s)[0], 0], 1.0)] for k, s in enumerate(instance.starts)], 0.0, 0.0)
    block("keep", [
        [(m[k, into[v], s], 1.0), (m[k, outof[v], s + 1], -1.0)] for k in range(n) for v in range(rooms) for s in range(last - 1)
    ], 0.0, 0.0)  # fmt: skip
    visiting = [(action == g) & ((tail != head) | (g != GO)) for g in range(3)]
    block("gain", [
        [(z[g].reshape(gains[g].shape)[v], 1.0), (m[:, np.nonzero(visiting[g] & (head == v))[0], :].ravel(), -1.0)]
        for g in range(3) for v in range(rooms)
    ], -inf, 0.0)  # fmt: skip
    block("base", [
        [(direct[k, s : s + 1], 1.0), (m[k, hearing[instance.base], s], -float(n))] for k in range(n) for s in range(last)
    ], -inf, 0.0)  # fmt: skip
    block("link", [[(flow[k, s : s + 1], 1.0), (link[k, s : s + 1], -float(n))] for k in range(len(pair)) for s in range(last)], -inf, 0.0)
    block("hears", [
        [(link[k, s : s + 1], 1.0), (m[int(p[k]), into[v], s], 1.0), (m[int(q[k]), hearing[v], s], -1.0)]
        for k in range(len(pair)) for v in range(rooms) for s in range(last)
    ], -inf, 1.0)  # fmt: skip
    block("flow", [
        [(direct[k, s : s + 1], 1.0), (flow[q == k, s], 1.0), (flow[p == k, s], -1.0), (heard[k, s : s + 1], -1.0)]
        for k in range(n) for s in range(last)
    ], 0.0, 0.0)  # fmt: skip
    block("contact", [
        [(heard[k, s : s + instance.silence + 1], 1.0)] for k in range(n) for s in range(last - instance.silence)
    ], 1.0, inf)  # fmt: skip
    block("end", [[(heard[k, last - 1 :], 1.0)] for k in range(n)], 1.0, 1.0)

    def decode(vector: Floats) -> Plans:
        chosen = vector[m].argmax(axis=1)
        return tuple(tuple((int(head[k]), int(action[k])) for k in chosen[robot].tolist()) for robot in range(n))

    def encode(answer: Any) -> Floats:
        judged = problem.evaluate(answer)
        if not judged.feasible:
            raise InputError(judged.violations[0].message)
        vector = np.zeros(columns.size)
        number = {move: k for k, move in enumerate(zip(tail.tolist(), head.tolist(), action.tolist(), strict=True))}
        for robot, deeds in enumerate(answer):
            here = int(instance.starts[robot])
            for step, (room, act) in enumerate(deeds):
                vector[m[robot, number[here, room, act], step]] = 1.0
                here = room
        for g in range(3):
            done = np.array([vector[m[:, np.nonzero(visiting[g] & (head == v))[0], :]].sum() for v in range(rooms)])
            vector[z[g]] = (np.arange(gains[g].shape[1]) < done[:, None]).ravel()
        contacts = problem.contacts(answer)
        for step in range(last):
            _send(
                problem, [deeds[step][0] for deeds in answer], contacts[step], vector, (direct[:, step], flow[:, step], link[:, step]), pair
            )
        vector[heard] = contacts.T
        return vector

    return Compiled(Program("time-expanded", "max", tuple(columns.blocks), tuple(blocks)), problem, decode, encode)


def _send(
    problem: RoomExploration, at: list[int], heard: NDArray[np.bool_], vector: Floats, columns: tuple[Integers, Integers, Integers],
    pair: list[tuple[int, int]],
) -> None:  # fmt: skip
    """Send one unit of flow from the base to each robot in contact, along a tree of robots that hear each other."""
    linked, base = problem.instance.linked, problem.instance.base
    direct, flow, link = columns
    number = {ends: k for k, ends in enumerate(pair)}
    parent = {k: -1 for k, room in enumerate(at) if linked[base, room]}
    ahead = list(parent)
    while ahead:
        k = ahead.pop()
        for other in range(len(at)):
            if other not in parent and linked[at[k], at[other]]:
                parent[other] = k
                ahead.append(other)
    for robot in np.nonzero(heard)[0].tolist():
        here = robot
        while parent[here] >= 0:
            edge = number[parent[here], here]
            vector[flow[edge]] += 1.0
            vector[link[edge]] = 1.0
            here = parent[here]
        vector[direct[here]] += 1.0


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


FORMS.add("time-expanded", Form("time-expanded", "room-exploration", frozenset({"contact"}), build, refuses=_refuses, size=_size))
