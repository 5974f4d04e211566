"""What the local algorithm works on: a sensing graph without what cannot matter, laid out robot after robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ....instances.sensing.graph import SensingGraph

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]


LIGHTEST, HEAVIEST = 1e-100, 1e100
"""Weights beyond these are refused: levels and their quotients would leave the range of a double."""


class Layout(NamedTuple):
    """The arrays of a ``CleanGraph``, as kernels take them.

    Parameters
    ----------
    first : array of shape (robots + 1,)
        The actions of robot i are ``first[i]`` to ``first[i + 1] - 1``.
    starts, targets, weights : arrays
        CSR form of actions x targets with at least two viewers.
    private : array of shape (actions,)
        Least weight among the targets that no other action sees; 0 for none.
    caps : array of shape (robots,)
        Bound 2/n_i of each pair row of a robot with n_i actions.
    """

    first: Indices
    starts: Indices
    targets: Indices
    weights: Floats
    private: Floats
    caps: Floats


@dataclass(frozen=True, eq=False)
class CleanGraph:
    """A cleaned sensing graph.

    Parameters
    ----------
    layout : Layout
    actions : array of shape (actions,)
        Number of each action in the sensing graph; ascending within a robot.
    num_targets : int
        Of the sensing graph; its numbers are kept.
    delta_r : int
        Most actions of a robot, at least 2.
    delta_t : int
        Most actions that see one target, at least 2.
    num_unseen : int
        Targets that no action sees: the value of the whole problem is then 0.
    num_graph_actions : int
        Actions of the sensing graph, those that see nothing included.
    whole : bool
        Whether all of them are here, under their own numbers.
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

    Parameters
    ----------
    graph : SensingGraph

    Returns
    -------
    CleanGraph
        Shares arrays with ``graph`` where nothing had to be left out.

    Raises
    ------
    InputError
        If a weight is smaller than 1e-100 or larger than 1e100.

    Notes
    -----
    A target that only action v sees asks ``c x_v >= w``; of several, the one of least weight asks the most. Everything is decided by
    what a robot knows of its own actions and of who else sees their targets. Source: Floréen, Hassinen, Kaasinen, Kaski, Musto and
    Suomela (2011); Sung (2019), section 3.4.1; docs/formulations/bottleneck.md#cleaning.
    """
    from . import cleaning_kernels as kernels

    owner, starts, seen = (np.ascontiguousarray(a, dtype=np.int32) for a in (graph.robot_of_action, graph.indptr, graph.indices))
    weights = np.ascontiguousarray(graph.weights, dtype=np.float64)
    viewers = np.zeros(graph.num_targets, dtype=np.int32)
    ascending, live, num_private, delta_t, lightest, heaviest = kernels.survey(owner, starts, seen, weights, viewers)
    if live and (lightest < LIGHTEST or heaviest > HEAVIEST):
        raise InputError(
            "the local algorithm needs weights of ordinary size",
            expected=f"{LIGHTEST:g} to {HEAVIEST:g}",
            found=f"{lightest:g} to {heaviest:g}",
        )
    whole = bool(ascending and live == len(owner))
    order = np.arange(live, dtype=np.int32) if whole else kernels.by_robot(owner, starts, graph.num_robots)
    first = np.empty(min(live, graph.num_robots) + 1, dtype=np.int32)
    robots, delta_r = kernels.group(owner, order, first)
    first = first[: robots + 1]
    private = np.zeros(live)
    if not whole or num_private:
        size = graph.num_edges - num_private
        old, starts = (starts, seen, weights), np.empty(live + 1, dtype=np.int32)
        seen, weights = np.empty(size, dtype=np.int32), np.empty(size)
        kernels.condense(order, *old, viewers, starts, seen, weights, private)
    layout = Layout(first, starts, seen, weights, private, 2.0 / np.diff(first))
    for array in layout:  # as the graph's own arrays are: kernels are then compiled for one kind only
        array.setflags(write=False)
    unseen = graph.num_targets - int(np.count_nonzero(viewers))
    return CleanGraph(layout, order, graph.num_targets, max(2, delta_r), max(2, delta_t), unseen, len(owner), whole)
