"""Time from a sensing graph to a solver's model of the max-min LP: waybound and PuLP side by side.

Robots with 10 actions each, each robot near a window of the targets, one target for every 20 actions, up to 10 targets seen by an action:
at 100,000 actions 100,001 columns, 15,000 rows and some 970,000 entries. waybound goes from a graph whose other directions were never asked
for to a HiGHS model ready to start. PuLP gets the edges of each target and the actions of each robot ready-made as lists, outside its
clock, builds the same model and writes it as MPS, which is how it hands a model over; that the two are the same is checked.
"""

import time
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from waybound.formulations.sata.bottleneck_sata import BottleneckSATA
from waybound.instances.sata.sensing_graph import SensingGraph, graph_of_edges

from ._harness import Option, command, met
from .side_by_side import MODEL, Medians, Once, print_clocks

PER_ROBOT, PER_TARGET, SEEN, REACH = 10, 20, 10, 15
"""Actions of a robot, actions for each target, targets drawn for each action, and how far from the robot's own they lie."""

TARGET = 30.0


def generate(actions: int, seed: int) -> SensingGraph:
    """Actions in robots of ten, each seeing up to ten of the 31 targets around its robot's own; weights in [0.1, 1]."""
    rng = np.random.default_rng(seed)
    robots, targets = max(1, actions // PER_ROBOT), max(1, actions // PER_TARGET)
    owner = np.minimum(np.arange(actions) // PER_ROBOT, robots - 1)
    seen = ((owner * targets // robots)[:, None] + rng.integers(-REACH, REACH + 1, (actions, min(SEEN, targets)))) % targets
    pairs = np.unique((np.arange(actions)[:, None] * targets + seen).ravel())
    weights = rng.uniform(0.1, 1.0, len(pairs))
    return graph_of_edges(owner, pairs // targets, pairs % targets, weights, robots=robots, targets=targets)


def with_waybound(graph: SensingGraph) -> Any:
    """Compile the graph to a HiGHS model ready to start."""
    return BottleneckSATA(graph, fractional=True).compile().to_highs(names=False)


def lists_for_pulp(graph: SensingGraph) -> dict[str, Any]:
    """The lists that a modeller would hold before the first variable is made."""
    starts, actions = graph.by_robot
    seen = graph.by_target
    return {
        "actions": graph.num_actions,
        "robots": [actions[a:b].tolist() for a, b in pairwise(starts)],
        "targets": [list(zip(seen.indices[a:b].tolist(), seen.weights[a:b].tolist(), strict=True)) for a, b in pairwise(seen.indptr)],
    }


def with_pulp(data: dict[str, Any], path: Path) -> tuple[Any, float]:
    """The same rows and columns in PuLP's own words, and its MPS file; also the seconds that the file took."""
    import pulp

    model = pulp.LpProblem("max_min", pulp.LpMaximize)
    x = [model.add_variable(f"x_{m}", 0, 1) for m in range(data["actions"])]
    w = model.add_variable("w", 0)
    model += w
    for i, mine in enumerate(data["robots"]):
        model += pulp.lpSum(x[m] for m in mine) <= 1, f"robot_{i}"
    for j, seeing in enumerate(data["targets"]):
        model += pulp.lpSum(c * x[m] for m, c in seeing) - w >= 0, f"target_{j}"
    began = time.perf_counter()
    model.writeMPS(str(path), rename=True)
    return model, time.perf_counter() - began


def run_once(which: str, actions: int, seed: int, folder: Path) -> None:
    """One measurement in this process, after imports and data."""
    import highspy  # noqa: F401  (imports are not part of any clock)

    graph = generate(actions, seed)
    if which == "pulp":
        import pulp  # noqa: F401

        print_clocks(partial(with_pulp, lists_for_pulp(graph), folder / MODEL))
        return
    with_waybound(generate(100, seed))  # loads the modules
    print_clocks(partial(with_waybound, graph))


def report(actions: int, seed: int, repeats: int) -> str:
    """Measure, and say what came out."""
    program = BottleneckSATA(generate(actions, seed), fractional=True).compile().program
    module = __spec__.name if __spec__ else __name__
    median = Medians(module, ["--actions", actions, "--seed", seed], ["waybound", "pulp"], program, repeats)
    (a, a_cpu), (b, b_cpu) = ((median(which, "wall"), median(which, "cpu")) for which in median.runs)
    lines = [
        f"max-min LP, {actions} actions, seed {seed}; each run in a fresh process",
        f"  {program.num_variables} columns, {program.num_rows} rows, {len(program.data)} entries",
        "",
        f"{median.heading:44}{'wall s':>9}{'CPU s':>9}   waybound, by wall (CPU) time",
        f"{'waybound: sensing graph to HiGHS model':44}{a:>9.4f}{a_cpu:>9.4f}",
        f"{'PuLP: lists to MPS file, same model':44}{b:>9.4f}{b_cpu:>9.4f}   {b / a:.0f}x ({b_cpu / a_cpu:.0f}x) as fast",
        f"{'  of these the file':44}{median('pulp', 'part'):>9.4f}",
        "",
        f"target: at least {TARGET:.0f}x as fast as PuLP: {met(min(b / a, b_cpu / a_cpu) >= TARGET)}",
    ]
    return "\n".join(lines)


@command
def main(
    actions: int = 100_000, seed: int = 1, repeats: int = 5, once: Once = "", folder: Annotated[Path, Option(type=Path)] = Path()
) -> None:
    if once:
        run_once(once, actions, seed, folder)
    else:
        print(report(actions, seed, repeats))
