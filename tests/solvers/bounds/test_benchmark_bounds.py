"""On real files no verified bound exceeds the best known value, and the methods reach the gaps they are known for."""

import csv
import math

import pytest

from waybound.formulations.problem import problem_from_instance
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.reading import read_instance
from waybound.solving.bounding import find_bounds

pytestmark = pytest.mark.usefixtures("without_trees")

CONVENTIONS = {"tsplib-nint": "file", "tsplib": "file", "dimacs-trunc1": "trunc1", "euclidean-double": "exact"}

# family, instance, largest gap in percent that the best bound found within a few seconds leaves
SAMPLE = [
    ("cvrp/A", "A-n32-k5", 13.0), ("cvrp/P", "P-n16-k8", 12.0), ("vrptw-solomon", "R101", 1.5), ("tsplib", "gr17", 0.5),
    ("tsplib", "eil51", 1.5),
]  # fmt: skip
LONG = [
    ("vrptw-solomon", "C201", 0.01), ("cvrp/X", "X-n101-k25", 9.0), ("cvrp/X", "X-n200-k36", 4.0), ("vrptw-solomon", "C101", 0.5),
    ("vrptw-solomon", "RC101", 13.5), ("cvrp/X", "X-n1001-k43", 15.0), ("vrptw-solomon", "R112", 13.0), ("tsplib", "a280", 2.0),
]  # fmt: skip


def rows_of(benchmarks, family, instance):
    with (benchmarks / "bks.csv").open() as table:
        found = [r for r in csv.DictReader(table) if (r["family"], r["instance"]) == (family, instance) and r["objective"] == "distance"]
    assert found, f"no row for {family} {instance}"
    return found


def best_bounds(benchmarks, family, instance, seconds):
    """For each convention: best known value and best verified bound."""
    path = next(p for p in sorted((benchmarks / family).glob(f"{instance}.*")) if p.suffix not in (".sol", ".tour"))
    for row in rows_of(benchmarks, family, instance):
        problem = problem_from_instance(read_instance(path), convention=CONVENTIONS[row["convention"]])
        bounds = [verified_bound(problem, e) for e in find_bounds(problem, seconds)]
        yield float(row["value"]), bounds


def check(benchmarks, family, instance, percent, seconds):
    for value, bounds in best_bounds(benchmarks, family, instance, seconds):
        assert bounds, "no bound was found"
        assert max(bounds) <= value * (1 + 1e-9) + 1e-6
        assert 100.0 * (value - max(bounds)) / value <= percent
        assert not math.isnan(sum(bounds))


@pytest.mark.share(3)
@pytest.mark.parametrize(("family", "instance", "percent"), SAMPLE)
def test_bounds_stay_below_best_known_values(benchmarks, family, instance, percent):
    check(benchmarks, family, instance, percent, 10.0)


@pytest.mark.long
@pytest.mark.parametrize(("family", "instance", "percent"), LONG)
def test_bounds_of_larger_files_stay_below_best_known_values(benchmarks, family, instance, percent):
    check(benchmarks, family, instance, percent, 30.0)
