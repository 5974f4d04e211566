"""Heuristic ``heard-greedy``: each robot in turn takes the action of the most gain after which it can still be heard again in time by
itself."""

import numpy as np
from numpy.typing import NDArray

from ...formulations.auctions.room_exploration import GO, MAP, SEARCH, RoomExploration
from ...formulations.stop import Stop, Stopped
from ..heuristic import Context, Outcome, heuristic
from ._exploration import allowed, steps_to_contact


@heuristic(
    "heard-greedy", "room-exploration", {"contact"}, "each robot in turn the most gain from which it can be heard again in time by itself"
)
def heard_greedy(problem: RoomExploration, context: Context) -> Outcome:
    """At each step the robots choose in turn, and none counts on another to be heard.

    An action is allowed if a room that hears the base can be reached in time afterwards, and before the end. Of equal gains, the one on the
    way to the most gain for each step is taken.
    """
    stop, instance = context.begin(), problem.instance
    adjacent, contact = instance.adjacent, instance.linked[instance.base]
    back = steps_to_contact(adjacent, contact)
    try:
        away = _distances(adjacent, stop)
    except Stopped:
        return Outcome(None, limit=stop.reached())
    tables = {GO: instance.exploring, MAP: instance.mapping, SEARCH: instance.searching}
    done = {kind: np.zeros(instance.num_rooms, dtype=np.int64) for kind in tables}

    def gain(kind: int, room: int) -> float:
        return float(tables[kind][room, done[kind][room]]) if done[kind][room] < tables[kind].shape[1] else 0.0

    here, silent = instance.starts.tolist(), [0] * instance.num_robots
    plans: list[list[tuple[int, int]]] = [[] for _ in here]
    for step in range(1, instance.steps + 1):
        worth = np.array([max(gain(kind, room) for kind in tables) for room in range(instance.num_rooms)])
        for robot in range(instance.num_robots):
            if stop.reached():
                return Outcome(None, limit=stop.reached())
            at = here[robot]
            options = [(at, MAP), (at, SEARCH), (at, GO), *((room, GO) for room in np.nonzero(adjacent[at])[0].tolist())]
            best: tuple[float, float, int] | None = None
            for number, (room, kind) in enumerate(options):
                age = 0 if contact[room] else silent[robot] + 1
                if not allowed(age, int(back[room]), instance.silence) or int(back[room]) > instance.steps - step:
                    continue
                now = 0.0 if (room, kind) == (at, GO) else gain(kind, room)
                ahead = float((worth / (1.0 + away[room])).max())
                best = max(best or (-1.0, -1.0, 0), (now, ahead, -number))
            if best is None:
                return Outcome(None, message=f"robot {robot + 1} cannot be heard in time by itself")
            room, kind = options[-best[2]]
            if (room, kind) != (at, GO):
                done[kind][room] += 1
            here[robot], silent[robot] = room, 0 if contact[room] else silent[robot] + 1
            plans[robot].append((room, kind))
    return Outcome(tuple(map(tuple, plans)))


def _distances(adjacent: NDArray[np.bool_], stop: Stop) -> NDArray[np.float64]:
    """Doors between rooms; infinite where there is no way. Raises Stopped."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import dijkstra

    doors, distances = csr_array(adjacent), np.empty(adjacent.shape)
    for room in range(len(adjacent)):
        stop.check()
        distances[room] = dijkstra(doors, unweighted=True, indices=room)
    return distances
