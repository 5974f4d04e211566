"""Heuristic ``consensus-bundle``: consensus-based bundles (CBBA), an auction without an auctioneer over a communication graph."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...formulations.auctions.task_allocation import Paths, TaskAllocation
from ...formulations.stop import Stop
from ...instances.errors import UsageError
from ...instances.number_arrays import Flags, Floats, Integers
from ..heuristic import Context, Outcome, heuristic
from .auction_steps.task_paths import ANY_OBJECTIVE, CUT_SHORT, arrays_of, completed

GRAPHS = ("complete", "ring", "line", "star")


@heuristic(
    "consensus-bundle",
    "task-allocation",
    ANY_OBJECTIVE,
    "consensus-based bundle algorithm (CBBA): an auction without an auctioneer, over a communication graph",
)
def consensus_bundle(problem: TaskAllocation, context: Context, *, communication: str = "complete", most: int | None = None) -> Outcome:
    """Robots fill bundles by what a task adds to their path, tell their neighbours, and give up what others do for less.

    ``communication`` says who hears whom, in the order of the robots: ``complete``, ``ring``, ``line``, or ``star`` around the first.
    ``most`` limits the tasks in a robot's bundle; what nobody has room for is inserted where it is cheapest afterwards. There is no
    guarantee: half of the optimum holds for gains that diminish as a bundle grows, and what a task adds to a path need not.

    Source: Choi, Brunet, How (2009), Consensus-based decentralized auctions for robust task allocation;
    docs/formulations/task-allocation.md#consensus-based-bundles.
    """
    if communication not in GRAPHS:
        raise UsageError(f"communication must be {', '.join(GRAPHS)}, not {communication!r}", "unknown-name")
    if most is not None and (isinstance(most, bool) or not isinstance(most, int) or most < 1):
        raise UsageError(f"most must be a whole number of at least 1, not {most!r}", "out-of-range")
    stop = context.begin()
    agreement = _agree(problem, communication, most, stop)
    paths = agreement.paths
    statistics = {"rounds": agreement.rounds, "messages": agreement.messages}
    if stop.reached():
        return Outcome(completed(problem, _once(paths)), statistics=statistics, message=CUT_SHORT, limit=stop.reached())
    spare = problem.num_tasks - len({task for path in paths for task in path})
    message = "" if agreement.agreed else "the robots did not agree; the first of them keeps a contested task"
    if spare:
        message = "; ".join(
            part for part in (message, f"{spare} tasks that nobody had room for were inserted where they add least") if part
        )
    return Outcome(_inserted(problem, _once(paths), stop), statistics=statistics, message=message)


def graph_of(communication: str, robots: int) -> Flags:
    """Pairs of robots that hear each other, shape (robots, robots)."""
    number = np.arange(robots)
    apart = np.abs(number[:, None] - number)
    if communication == "complete":
        connected = apart > 0
    elif communication == "star":
        connected = (apart > 0) & ((number[:, None] == 0) | (number == 0))
    else:
        connected = (apart == 1) | ((apart == robots - 1) & (robots > 1) & (communication == "ring"))
    return np.asarray(connected)


def _agree(problem: TaskAllocation, communication: str, most: int | None, stop: Stop) -> "Consensus":
    from .auction_steps.bidding_kernels import insertions

    starts, between = arrays_of(problem)
    waiting, largest = problem.objective == "mini-ave", problem.objective == "mini-max"

    def gains(robot: int, path: tuple[int, ...]) -> tuple[Floats, Integers]:
        added, place = insertions(stop.flag, starts[robot], between, np.array(path, dtype=np.int64), waiting)
        return -(added + float(problem.legs(robot, path).sum())) if largest else -added, place

    return consensus(gains, problem.num_tasks, graph_of(communication, problem.num_robots), stop, most)


def _once(paths: Paths) -> Paths:
    """The paths without the second mention of a task."""
    seen: set[int] = set()
    kept = []
    for path in paths:
        kept.append(tuple(task for task in path if task not in seen))
        seen.update(path)
    return tuple(kept)


def _inserted(problem: TaskAllocation, paths: Paths, stop: Stop) -> Paths:
    """The paths with missing tasks inserted, one after the other, where each adds least."""
    from .auction_steps.bidding_kernels import insertions

    starts, between = arrays_of(problem)
    longer = [list(path) for path in paths]
    for task in sorted(set(range(problem.num_tasks)) - {task for path in paths for task in path}):
        ways = [insertions(stop.flag, starts[r], between, np.array(path, np.int64), False) for r, path in enumerate(longer)]
        robot = min(range(len(longer)), key=lambda r: float(ways[r][0][task]))
        longer[robot].insert(int(ways[robot][1][task]), task)
    return tuple(tuple(path) for path in longer)


Gains = Callable[[int, tuple[int, ...]], tuple[Floats, Integers]]
"""Gains that each task would add to the value of a robot's path, and at which place; tasks of the path are ignored."""

NOBODY = -1


@dataclass(frozen=True)
class Consensus:
    """The paths that robots agreed on, the rounds until nothing changed, messages (one to each neighbour and round), and whether they
    agreed.

    They agree if every task is in at most one path, and all know the same winners.
    """

    paths: tuple[tuple[int, ...], ...]
    rounds: int
    messages: int
    agreed: bool


class _Robot:
    """One robot's knowledge: its bundle in the order of its bids, its path, and the winner and bid of each task as it knows them."""

    def __init__(self, number: int, robots: int, tasks: int) -> None:
        self.number = number
        self.bundle: list[int] = []
        self.path: tuple[int, ...] = ()
        self.bid, self.winner = np.full(tasks, -np.inf), np.full(tasks, NOBODY)
        self.heard = np.full(robots, -1)  # the round that news of each robot are of

    def fill(self, gains: Gains, most: int) -> None:
        """Add the task of the largest bid that beats the known one, until there is none; a bid is at most the one before."""
        cap = min((float(self.bid[task]) for task in self.bundle), default=np.inf)
        while len(self.bundle) < most:
            value, place = gains(self.number, self.path)
            offer = np.minimum(value, cap)
            beats = (offer > self.bid) | ((offer == self.bid) & (self.number < self.winner))
            beats[self.bundle] = False
            beats &= offer > -np.inf
            if not beats.any():
                return
            task = int(np.where(beats, offer, -np.inf).argmax())
            at = int(place[task])
            self.bundle.append(task)
            self.path = (*self.path[:at], task, *self.path[at:])
            cap = float(offer[task])
            self.bid[task], self.winner[task] = cap, self.number

    def hear(self, bid: Floats, winner: Integers, heard: Integers, sender: int) -> None:
        """Table 1 of Choi, Brunet, How (2009): for each task adopt the sender's account, reset one's own, or keep it."""
        me, mine = self.number, self.winner
        newer = heard > self.heard  # of each robot, whether the sender knows more recent news
        theirs_newer = (winner >= 0) & newer[np.maximum(winner, 0)]
        mine_newer = (mine >= 0) & newer[np.maximum(mine, 0)]
        own_older = (mine >= 0) & (self.heard[np.maximum(mine, 0)] < heard[np.maximum(mine, 0)])
        theirs_older = (winner >= 0) & (self.heard[np.maximum(winner, 0)] > heard[np.maximum(winner, 0)])
        more = (bid > self.bid) | ((bid == self.bid) & (winner >= 0) & (winner < mine))
        other = (mine >= 0) & (mine != me) & (mine != sender)
        third = (winner >= 0) & (winner != me) & (winner != sender)
        none = mine == NOBODY
        take = (winner == sender) & ((mine == sender) | none | ((mine == me) & more) | (other & (mine_newer | more)))
        drop = (winner == me) & ((mine == sender) | (other & mine_newer))
        take |= third & (mine == me) & theirs_newer & more
        take |= third & (mine == sender) & theirs_newer
        drop |= third & (mine == sender) & ~theirs_newer
        take |= third & other & (mine == winner) & theirs_newer
        fourth = third & other & (mine != winner)
        take |= fourth & theirs_newer & (own_older | more)
        drop |= fourth & own_older & theirs_older & ~take
        take |= third & none & theirs_newer
        take |= (winner == NOBODY) & ((mine == sender) | (other & mine_newer))
        self.bid = np.where(take, bid, np.where(drop, -np.inf, self.bid))
        self.winner = np.where(take, winner, np.where(drop, NOBODY, mine))

    def release(self) -> None:
        """Give up the first task of the bundle that somebody else won, and all tasks after it."""
        lost = next((k for k, task in enumerate(self.bundle) if self.winner[task] != self.number), None)
        if lost is None:
            return
        for task in self.bundle[lost + 1 :]:
            if self.winner[task] == self.number:
                self.bid[task], self.winner[task] = -np.inf, NOBODY
        kept = set(self.bundle[:lost])
        self.bundle = self.bundle[:lost]
        self.path = tuple(task for task in self.path if task in kept)


def consensus(gains: Gains, tasks: int, neighbours: Flags, stop: Stop, most: int | None = None) -> Consensus:
    """Fill bundles and talk, round after round, until nothing has changed for as many rounds as there are robots.

    ``neighbours[i, k]`` says that i hears k; the graph must be connected, or there is no agreement. ``most`` limits the tasks of a robot.

    Source: algorithm 3 and table 1 of Choi, Brunet, How (2009), with bids that never rise along a bundle (Johnson, Choi, Ponda, How 2012),
    so that it converges for any gains.
    """
    robots = len(neighbours)
    team = [_Robot(number, robots, tasks) for number in range(robots)]
    limit, quiet, last = 2 * robots * (tasks + 2), 0, 0
    known: tuple[bytes, ...] = ()
    rounds = 0
    while rounds < limit and quiet <= robots and not stop.reached():
        rounds += 1
        for robot in team:
            robot.fill(gains, tasks if most is None else most)
            robot.heard[robot.number] = rounds
        messages = [(robot.bid.copy(), robot.winner.copy(), robot.heard.copy()) for robot in team]
        for robot in team:
            senders = [k for k in np.nonzero(neighbours[robot.number])[0].tolist() if k != robot.number]
            for sender in senders:
                robot.hear(*messages[sender], sender)
                robot.heard = np.maximum(robot.heard, messages[sender][2])
                robot.heard[robot.number] = rounds
            robot.release()
        now = tuple(part.tobytes() for robot in team for part in (robot.bid, robot.winner))
        quiet = quiet + 1 if now == known else 0
        last = last if now == known else rounds
        known = now
    count = np.bincount([task for robot in team for task in robot.path], minlength=tasks)
    agreed = bool((count <= 1).all()) and all((robot.winner == team[0].winner).all() for robot in team)
    links = int(neighbours.sum() - np.trace(neighbours))
    return Consensus(tuple(robot.path for robot in team), last, last * links, agreed)
