"""The local algorithm over arrays on near-regular graphs of growing size, beside HiGHS on the same linear program.

One thread. The clock of the local algorithm starts with a ``SensingGraph`` and ends with the shares: cleaning, search, smoothing, solution
and normalising, best of the repeats in CPU seconds; it uses none of the graph's cached arrays. Compiling the kernels is outside and told
apart. Memory is the peak of what numpy holds beyond the graph. HiGHS is timed from the compiled program, once with its own choice of
algorithm and once with the one that the form advises; ``--full`` gives it 30,000 and 100,000 robots too, which takes minutes. ``--quality``
compares heights with optima instead.
"""

import math
import time
import tracemalloc
from dataclasses import replace
from typing import Annotated, Any

import numpy as np

import waybound as wb
from waybound.solvers.engines.sata.local_max_min.shares import local_shares

from ._harness import Option, command, generated, solved, timed

SLOPE = 1.15
"""Most growth of log time by log size."""

LARGEST_ADVISED = 30_000
"""Beyond, the form's advice (the interior point) takes longer than HiGHS' own choice on these graphs: minutes."""


def instance(kind: str, robots: int) -> wb.SensingGraph:
    return generated(wb.SensingGraph, f"sensing-{kind}", robots, robots=robots)


def local_seconds(graph: wb.SensingGraph, h: int, repeats: int) -> tuple[float, float]:
    """CPU seconds, best of ``repeats``, and the value of the shares."""
    runs = [timed(lambda: local_shares(graph, h).shares) for _ in range(repeats)]
    return min(seconds for seconds, _ in runs), float(wb.BottleneckSATA(graph, fractional=True).coverage(runs[-1][1]).min())


def local_memory(graph: wb.SensingGraph, h: int) -> int:
    """Largest number of bytes that numpy held at a time beyond the graph."""
    tracemalloc.start()
    local_shares(graph, h)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak


def highs_seconds(graph: wb.SensingGraph, advised: bool) -> tuple[float, float | None]:
    """CPU seconds of HiGHS on the compiled program, and the optimum."""
    program = wb.BottleneckSATA(graph, fractional=True).compile("max-min").program
    if not advised:
        program = replace(program, name="unknown")
    seconds, result = solved(program, "highs", 3600.0)
    return seconds, result.objective if result.status == "optimal" else None


def slope(sizes: list[int], seconds: list[float]) -> float:
    """Slope of the least-squares line through logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(seconds), 1)[0]) if len(sizes) > 1 else math.nan


def compare(graph: wb.SensingGraph, own: list[float]) -> list[str]:
    """One line for each of HiGHS' ways, with how many times longer it takes than the local algorithm at each height."""
    lines = []
    ways = {"its own choice": False, "as the form advises": True}
    for name, advised in ways.items():
        if advised and graph.num_robots > LARGEST_ADVISED:
            continue
        seconds, best = highs_seconds(graph, advised)
        optimum = "not found" if best is None else f"{best:.4f}"
        times = "".join(f"{seconds / other:10.0f}x" for other in own)
        lines.append(f"    HiGHS, {name}: {seconds:.2f} s, optimum {optimum}; longer than the local algorithm{times}")
    return lines


SATA = {"kind": "sata", "actions": 2, "targets": 50, "phi": 15}
FAMILIES: dict[str, list[dict[str, Any]]] = {
    **{f"sata, {robots} robots": [{**SATA, "robots": robots, "seed": k} for k in range(1, 21)] for robots in (8, 12, 16, 20)},
    "sata, 4 actions": [{**SATA, "robots": 12, "actions": 4, "seed": k} for k in range(1, 21)],
    **{kind: [{"kind": f"sensing-{kind}", "robots": 400, "seed": k} for k in range(1, 9)] for kind in ("regular", "ring", "geometric")},
}
"""Small instances on which heights are compared."""


def quality_of(heights: list[int], families: dict[str, list[dict[str, Any]]]) -> dict[str, list[float]]:
    """Mean of value over optimum at each height, by family, and over all of them."""
    means: dict[str, list[float]] = {}
    for name, recipes in families.items():
        ratios = []
        for recipe in recipes:
            graph = generated(wb.SensingGraph, recipe["kind"], **{name: value for name, value in recipe.items() if name != "kind"})
            _, best = highs_seconds(graph, advised=False)
            assert best is not None
            ratios.append([local_seconds(graph, h, 1)[1] / best for h in heights])
        means[name] = np.mean(ratios, axis=0).tolist()
    means["mean"] = np.mean(list(means.values()), axis=0).tolist()
    return means


@command
def main(
    robots: tuple[int, ...] = (1000, 10_000, 100_000, 1_000_000),
    heights: tuple[int, ...] = (2, 3, 5, 10),
    repeats: int = 3,
    kind: Annotated[str, Option(choices=("regular", "ring", "geometric"))] = "regular",
    highs: tuple[int, ...] = (1000, 10_000),
    full: bool = False,
    quality: Annotated[bool, Option(help="instead, value over optimum by height on small instances")] = False,
) -> None:
    if quality:
        compare_heights()
        return
    sizes = sorted({*robots, *((30_000, 100_000) if full else ())})
    compared = {*highs, *((30_000, 100_000) if full else ())}
    began = time.perf_counter()
    local_shares(instance(kind, 200), 2)
    print(f"kernels ready after {time.perf_counter() - began:.1f} s (compiled, or read from the disk's cache)")
    print(f"{kind} graphs; CPU seconds of one thread, best of {repeats}; values normalised")
    heads = "".join(f"{f'h = {h}':>11s}" for h in heights)
    print(f"{'robots':>9s}{'edges':>10s}{heads}{'MB, bytes an edge':>20s}")
    rows: list[list[float]] = []
    for size in sizes:
        graph = instance(kind, size)
        runs = [local_seconds(graph, h, repeats) for h in heights]
        rows.append([seconds for seconds, _ in runs])
        peak = local_memory(graph, max(heights))
        memory = f"{peak / 1e6:.0f}, {peak / graph.num_edges:.0f}"
        print(f"{size:9d}{graph.num_edges:10d}" + "".join(f"{s:11.4f}" for s in rows[-1]) + f"{memory:>20s}")
        print(f"{'value':>19s}" + "".join(f"{value:11.4f}" for _, value in runs), flush=True)
        for line in compare(graph, rows[-1]) if size in compared else ():
            print(line, flush=True)
    slopes = [slope(sizes, [row[k] for row in rows]) for k in range(len(heights))]
    print(f"{'slope':>19s}" + "".join(f"{s:11.3f}" for s in slopes) + f"   (target: below {SLOPE})")


def compare_heights() -> None:
    heights = [1, 2, 3, 4, 5, 6, 8, 10]
    print(f"{'value over optimum':20s}" + "".join(f"{f'h = {h}':>8s}" for h in heights))
    for name, means in quality_of(heights, FAMILIES).items():
        print(f"{name:20s}" + "".join(f"{mean:8.3f}" for mean in means))
