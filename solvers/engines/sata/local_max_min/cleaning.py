"""Sensing graphs as the local algorithm works on them: without what cannot matter, laid out robot after robot."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .....instances.errors import InputError
from .....instances.number_arrays import Floats as Floats
from .....instances.sata.sensing_graph import SensingGraph

Indices = NDArray[np.int32]


LIGHTEST, HEAVIEST = 1e-100, 1e100
"""Weights beyond these are refused: levels and their quotients would leave the range of a double."""


class Layout(NamedTuple):
    """The arrays of a ``CleanGraph``, as kernels take them.

    The actions of robot i are ``first[i]`` to ``first[i + 1] - 1``; ``starts``, ``targets`` and ``weights`` are the CSR form of actions x
    targets with at least two viewers; ``private`` is the least weight of each action among the targets that no other action sees, 0 for
    none; ``caps`` is the bound 2/n_i of each pair row of a robot with n_i actions.
    """

    first: Indices
    starts: Indices
    targets: Indices
    weights: Floats
    private: Floats
    caps: Floats


@dataclass(frozen=True, eq=False)
class CleanGraph:
    """A cleaned sensing graph, whose targets keep their numbers.

    ``actions`` are the numbers of its actions in the sensing graph, ascending within a robot, ``whole`` if they are all of those, under
    their own numbers. ``delta_r`` is the most actions of a robot, ``delta_t`` the most actions that see one target, both at least 2.
    """

    layout: Layout
    actions: Indices
    num_targets: int
    delta_r: int
    delta_t: int
    num_unseen: int
    num_graph_actions: int
    whole: bool

    @property
    def num_robots(self) -> int:
        return len(self.layout.caps)

    @property
    def num_actions(self) -> int:
        return len(self.actions)

    def spread(self, values: Floats, fill: float = 0.0) -> Floats:
        """``values`` of the cleaned actions as an array over all actions of the sensing graph."""
        if self.whole:
            return values
        everywhere = np.full(self.num_graph_actions, fill)
        everywhere[self.actions] = values
        return everywhere


def clean(graph: SensingGraph) -> CleanGraph:
    """Leave out actions that see nothing and robots without others; set apart targets with a single viewer.

    Shares arrays with ``graph`` where nothing had to be left out. A target that only action v sees asks ``c x_v >= w``; of several, the one
    of least weight asks the most. Everything is decided by what a robot knows of its own actions and of who else sees their targets. Raises
    InputError for weights below 1e-100 or above 1e100.

    Source: Floréen, Hassinen, Kaasinen, Kaski, Musto and Suomela (2011); Sung (2019), section 3.4.1;
    docs/formulations/bottleneck.md#cleaning.
    """
    owner, starts, seen = (np.ascontiguousarray(a, dtype=np.int32) for a in (graph.robot_of_action, graph.indptr, graph.indices))
    weights = np.ascontiguousarray(graph.weights, dtype=np.float64)
    viewers = np.bincount(seen, minlength=graph.num_targets)
    lightest, heaviest = weights.min(initial=math.inf), weights.max(initial=0.0)
    if len(seen) and (lightest < LIGHTEST or heaviest > HEAVIEST):
        raise InputError(
            "the local algorithm needs weights of ordinary size",
            "out-of-range",
            expected=f"{LIGHTEST:g} to {HEAVIEST:g}",
            found=f"{lightest:g} to {heaviest:g}",
        )
    sizes = np.diff(starts)
    order = np.flatnonzero(sizes).astype(np.int32)
    whole = len(order) == len(owner) and not (owner[1:] < owner[:-1]).any()
    if not whole:
        order = order[np.argsort(owner[order], kind="stable")]
    first = np.append(np.flatnonzero(np.diff(owner[order], prepend=-1)), len(order)).astype(np.int32)
    private = np.zeros(len(order))
    if not whole:
        sizes = sizes[order]
        ends = np.cumsum(sizes, dtype=np.int32)
        edges = np.arange(len(seen), dtype=np.int32) + np.repeat(starts[order] - ends + sizes, sizes)
        starts, seen, weights = np.append(np.int32(0), ends), seen[edges], weights[edges]
    lone = (viewers == 1)[seen]
    alone = np.flatnonzero(lone)
    if len(alone):
        at = np.searchsorted(starts, alone, side="right") - 1
        least = np.full(len(order), math.inf)
        np.minimum.at(least, at, weights[alone])
        private = np.where(least < math.inf, least, 0.0)
        starts = starts - np.searchsorted(alone, starts).astype(np.int32)
        seen, weights = seen[~lone], weights[~lone]
    layout = Layout(first, starts, seen, weights, private, 2.0 / np.diff(first))
    for array in layout:  # as the graph's own arrays are: kernels are then compiled for one kind only
        array.setflags(write=False)
    delta_r, delta_t = int(np.diff(first).max(initial=2)), int(viewers.max(initial=2))
    return CleanGraph(layout, order, graph.num_targets, delta_r, delta_t, int((viewers == 0).sum()), len(owner), whole)
