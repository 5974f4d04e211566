"""The arrays of a sensing graph in the order in which the compiled loops of the game take them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .....formulations.sata.balls import Floats
from .....instances.sata.sensing_graph import SensingGraph


class Layout(NamedTuple):
    """The arrays of a graph, as kernels take them.

    The actions of robot i are ``order[first[i]]`` to ``order[first[i + 1] - 1]``; ``starts``, ``targets`` and ``weights`` are the CSR form
    of actions x targets; ``viewer_starts``, ``viewing`` and ``viewer_weights`` that of targets x actions; ``viewers`` are the robots of
    ``viewing``.
    """

    first: NDArray[np.int32]
    order: NDArray[np.int32]
    starts: NDArray[np.int32]
    targets: NDArray[np.int32]
    weights: Floats
    viewer_starts: NDArray[np.int32]
    viewing: NDArray[np.int32]
    viewer_weights: Floats
    viewers: NDArray[np.int32]

    @property
    def by_action(self) -> tuple[NDArray[np.int32], NDArray[np.int32], Floats]:
        """Weights as a CSR matrix, actions x targets."""
        return self.starts, self.targets, self.weights

    @property
    def by_target(self) -> tuple[NDArray[np.int32], NDArray[np.int32], Floats]:
        """Weights as a CSR matrix, targets x actions."""
        return self.viewer_starts, self.viewing, self.viewer_weights

    @classmethod
    def of(cls, graph: SensingGraph) -> Layout:
        """The layout of a graph."""
        first, order = graph.by_robot
        sight = graph.by_target
        arrays = cls(first, order, graph.indptr, graph.indices, graph.weights, *sight, graph.robot_of_action[sight.indices])
        return cls(*(_read_only(array) for array in arrays))


LAYOUT = f"named(Layout, {', '.join(f'read({kind}[::1])' for kind in ('i4', 'i4', 'i4', 'i4', 'f8', 'i4', 'i4', 'f8', 'i4'))})"
"""In the words of ``kernel``."""


def _read_only(array: NDArray[Any]) -> NDArray[Any]:
    """A view: kernels are compiled for one kind of arrays."""
    view = array.view()
    view.setflags(write=False)
    return view
