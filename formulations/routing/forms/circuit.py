"""The circuit form, for solvers that know what a circuit is: routes are circuits through the depot, and no row has to join their arcs.

Where all customers must be visited and the two-index forms can take the problem, one variable per arc says enough. Every other problem
that the three-index form can take is written with its variables and rows, less ``depart``, ``flow`` and, without shipments, ``order``:
the arcs with x_ijk = 1, the loops (i,i) with off_ik = 1, which leave a customer to the other vehicles, and (g,o), which is always used
(back_k = 1), are one circuit. It has no linear relaxation. Rows: docs/formulations/routing.md#circuit-form.

Source: Laurière (1978) for circuits as a constraint.
"""

from functools import partial

import numpy as np

from ...forms import FORMS, Form
from ...programs.circuits import Circuit
from ...programs.compiled import Compiled
from ...programs.program import CIRCUITS, INTEGERS, Floats
from ..preparation import prepare
from ..problem import RoutingProblem
from . import _sizes, three_index, two_index
from ._routes import with_levels
from ._vehicles import Drive, VehicleBlocks


def arcs_say_enough(problem: RoutingProblem) -> bool:
    """Whether one variable per arc will do, and no customer may be left out."""
    required = bool(problem.sites.required[problem.customers].all())
    return required and problem.features() <= two_index.FEATURES and not two_index.refuses(problem)


def refuses(problem: RoutingProblem) -> frozenset[str]:
    """Features that the three-index form refuses, where that one is needed."""
    return frozenset() if arcs_say_enough(problem) else three_index.refuses(problem)


def build(problem: RoutingProblem) -> Compiled:
    """The program of the circuit form."""
    if arcs_say_enough(problem):
        return with_levels(problem, _of_arcs)
    return with_levels(problem, partial(three_index.written, form="circuit", connect=_of_each_vehicle))


def _of_arcs(problem: RoutingProblem) -> Compiled:
    prep = prepare(problem)
    blocks = two_index.ArcColumns(problem, prep)
    blocks.fleet()
    for name, resource in two_index.needed_resources(problem, prep).items():
        if name != "order":
            blocks.node_levels(resource)
    head = np.where(prep.head == prep.end, 0, prep.head)
    return two_index.written(blocks, "circuit", (Circuit("circuit", prep.end, prep.tail, head, blocks.arcs, several=True),))


def _of_each_vehicle(blocks: VehicleBlocks) -> tuple[Circuit, ...]:
    """One circuit per vehicle, with its loops."""
    nodes, circuits = np.arange(1, blocks.nodes + 1), []
    for kind in blocks.types:
        count, end = kind.count, kind.prep.end
        keys = (np.repeat(nodes, count), np.tile(kind.vehicles, blocks.nodes))
        off = blocks.add_columns("off", keys, (blocks.names, kind.numbers), 0.0, 1.0, integer=True)
        back = blocks.add_columns("back", (kind.vehicles,), (kind.numbers,), 1.0, 1.0, integer=True)
        tail, head = np.concatenate([kind.tail, nodes, [end]]), np.concatenate([kind.head, nodes, [0]])
        arcs = kind.first + np.arange(len(kind.tail)) * count
        for k, vehicle in enumerate(kind.vehicles.tolist()):
            column = np.concatenate([arcs + k, off + (nodes - 1) * count + k, [back + k]])
            circuits.append(Circuit(f"circuit[{kind.numbers[vehicle]}]", end + 1, tail, head, column))

        def encode(x: Floats, drives: list[Drive], first: int = off, of: object = kind, count: int = count) -> None:
            x[first : first + blocks.nodes * count] = 1.0
            for d in drives:
                if d.kind is of:
                    x[first + (d.nodes[1:-1] - 1) * count + d.number] = 0.0

        blocks.encoders.append(encode)
    return tuple(circuits)


FORMS.enter(
    Form(
        "circuit", "routing", three_index.FEATURES, build, refuses=refuses, makes=lambda problem: INTEGERS | CIRCUITS, order=6,
        size=lambda problem: _sizes.circuit(problem, arcs_say_enough(problem)),
    ),
)  # fmt: skip
