import hashlib
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from waybound import AssignmentInstance, ExplorationMap, GeneralisedAssignmentInstance, OrchardJobs, RiskyGraph, RobotTasks, UncertainGraph
from waybound.instances.auctions.joint_assignment import JointAssignmentInstance
from waybound.instances.auctions.orchard_grid import OrchardGrid
from waybound.instances.bundled import bundled_path
from waybound.instances.generating import generate
from waybound.instances.reading import read_instance
from waybound.instances.risk.elements import AccessRisk, LocaleRisk, MoveRisk
from waybound.instances.sata.constraints import Knapsack
from waybound.instances.sata.max_min_lp import MaxMinInstance, SparseMatrix
from waybound.instances.sata.selection import SelectionInstance
from waybound.instances.sata.sensing_graph import SensingGraph
from waybound.instances.sata.set_functions import Coverage
from waybound.instances.writing import write_instance

INF = math.inf
CORNERS = np.array([[0.0, 0.5], [1.0, 2.0]])

SAMPLES: dict[str, Callable[[], Any]] = {
    "assignment": lambda: AssignmentInstance.from_matrix(
        [[1.0, INF], [2.5, -3.0]], filled=np.array([0.0, INF]), bin_names=("x", "y"), robot_positions=CORNERS, notes=("told",),
        problem="bottleneck-assignment", name="two",
    ),
    "assignment of pairs": lambda: AssignmentInstance.from_pairs(3, 3, [0, 2], [1, 2], [1.0, 2.0]),
    "generalised-assignment": lambda: GeneralisedAssignmentInstance(
        [[1.0, INF], [2.5, -3.0]], [1.5, 2.0], 5.0, agent_names=("a", "b"), notes=("told",)
    ),
    "profits": lambda: GeneralisedAssignmentInstance([[1.0, -INF]], [[1.0, 2.0]], [5.0], "profit", job_names=("x", "y")),
    "joint-assignment": lambda: JointAssignmentInstance(
        [[1.0, INF]], [[2.0]], [[3.0, 4.0]], np.array([0.0, INF]), request_names=("x",), bin_names=("p", "q")
    ),
    "joint-assignment without requests": lambda: JointAssignmentInstance([[1.0]], np.zeros((1, 0)), np.zeros((0, 1)), name="none"),
    "exploration-map": lambda: ExplorationMap(
        [(0, 1)], [[0.0], [1.0]], np.zeros((2, 0)), [[1.0, 0.5]] * 2, [0], 0, [(0, 1)], 1, 4, ("a", "b"), CORNERS, notes=("told",)
    ),
    "orchard-jobs": lambda: OrchardJobs(
        OrchardGrid(1, 6), [0, 3], [0, 2], [1, 1, 4], [-1, 0, -1], np.array([True, False, True]), [2, 2, 0], notes=("told",)
    ),
    "robot-tasks": lambda: RobotTasks.of_positions(
        [0, 10], [(4, 1), (6, 2)], "manhattan", weights=[1, -2], task_names=("a", "b"), problem="balanced-partition"
    ),
    "robot-tasks of distances": lambda: RobotTasks.of_distances([[1, 2]], [[9, 3], [4, 9]], robot_names=("ann",), notes=("told",)),
    "sensing": lambda: SensingGraph(
        [0, 1, 1], [0, 1, 3, 3], [0, 0, 1], [1.0, 0.5, 2.0], 2, 3, ("r", "s"), ("a", "b", "c"), None, None, np.arange(6.0).reshape(3, 2),
        problem="selection", problems=("selection", "bottleneck"), notes=("told",),
    ),
    "max-min": lambda: MaxMinInstance(
        SparseMatrix.of([[1, 2], [0, 1]]), SparseMatrix.of([[1, 1]]), variable_names=("u", "v"), notes=("told",)
    ),
    "max-min of numbers": lambda: MaxMinInstance(SparseMatrix.of([[1, 1]]), SparseMatrix.of([[1, 1], [0, 1]]), "min"),
    "selection": lambda: SelectionInstance(
        Coverage.from_sets([[0, 2], [1]], [1.0, 2.0, 0.5]), Knapsack([1.0, 2.0], 2.5), ("e", "f"), notes=("told",)
    ),
    "risky-graph": lambda: RiskyGraph(
        3, [1, 0], [2, 1], [LocaleRisk([0.1, 0.2, 0.3]), AccessRisk([1, 2, 3], 0.1, 0.2), MoveRisk([-1, 0], [0, 1], [1, 2], [0.5, 0.25])],
        0, False, (2,), [0, 0.5, 1], 0.5, positions=np.arange(9.0).reshape(3, 3) / 10, obstacles=[[0, 0, 0, 1, 1, 1]],
        state_names=("a", "b", "c"), notes=("told",),
    ),
    "risky-graph of rewards": lambda: RiskyGraph(2, [0], [1], [LocaleRisk([0.1, 0.2])], 0, True, rewards=[0, 2]),
    "uncertain-graph": lambda: UncertainGraph(
        3, [1, 0, 1], [2, 1, 0], [2.0, 1.0, 1.0], [3.0, 0.5, 0.5], 0, 2, [0.1, 0.2, 0.2], [7, 8, 8], ("a", "b", "c"),
        np.arange(6.0).reshape(3, 2), notes=("told",),
    ),
    "uncertain-graph of means": lambda: UncertainGraph(2, [0], [1], [1.0], [0.25], 0, 1),
    "routing": lambda: read_instance(bundled_path("demo-rc50")),
    "routing of kilometres": lambda: generate("uchoa", 5, customers=12),
    "risk-allocation": lambda: generate("risk-allocation", 3, family="corridor", steps=3),
    "generated sensing": lambda: generate("sensing-ring", 2),
    "generated selection": lambda: generate("coverage", 2),
}  # fmt: skip
"""By kind: what says everything that a file of the kind can hold, and what says as little as it may."""

HELD: dict[str, tuple[str, str]] = {
    "assignment": ("3b96c7619ce05a83", "9b03ab7e027f035e"),
    "assignment of pairs": ("a0fda60a5cc36cc6", "14f38760d5a9f4a4"),
    "generalised-assignment": ("b51d7c81e4088933", "f4962075805b0d71"),
    "profits": ("9ca53601e8987995", "7ae62f0c261eb6f9"),
    "joint-assignment": ("c193c5b7f37e20bc", "084e17f4181014cf"),
    "joint-assignment without requests": ("5714d4cbc266bccb", "6fe82f5989af45a5"),
    "exploration-map": ("ed8b71c56c27447f", "17632c23d4c58406"),
    "orchard-jobs": ("ee304d062e92e70b", "c0fe37cea3528960"),
    "robot-tasks": ("aaf34dd9b97b9854", "ea7af1a413286453"),
    "robot-tasks of distances": ("d2600344df8ea03b", "ea47adbbd176cb9d"),
    "sensing": ("361b794eba5b6579", "5e4290fca9bf45ce"),
    "max-min": ("37a2397064a0097c", "21eb67a6cf4be397"),
    "max-min of numbers": ("1138a504f44d9e9d", "0e89637fdd8c07e0"),
    "selection": ("c2b2c6730cc365f5", "8f64971f79c1af2b"),
    "risky-graph": ("144bf89938e94e34", "b9fb7550c773e674"),
    "risky-graph of rewards": ("f5af234ac061f930", "a890cec4b2f19769"),
    "uncertain-graph": ("0b60d374ae9b46a3", "ffc855f03bc6c96f"),
    "uncertain-graph of means": ("73b0ee24de5a78dc", "98a8c502ddf5a585"),
    "routing": ("", "6e9705094fbb81bf"),
    "routing of kilometres": ("", "ff753a2472568999"),
    "risk-allocation": ("04c43414836e973a", "fdeff3230233ace7"),
    "generated sensing": ("9d9513d1e4ad62d6", "512632feed60b068"),
    "generated selection": ("f4687448a8f814b8", "b247b6c9419aca97"),
}
"""Beginnings of the digest, and of the hash of the file."""


@pytest.mark.parametrize("sample", SAMPLES)
def test_digest_and_file_are_those_of_earlier_versions_and_what_is_read_is_written_the_same(sample: str, tmp_path: Path) -> None:
    instance = SAMPLES[sample]()
    write_instance(instance, tmp_path / "first.json")
    again = read_instance(tmp_path / "first.json")
    write_instance(again, tmp_path / "second.json")
    first, second = ((tmp_path / name).read_bytes() for name in ("first.json", "second.json"))
    assert first == second and again.notes == instance.notes
    if hasattr(instance, "digest"):
        assert again.digest() == instance.digest()
    assert (digest_of(instance), hashlib.sha256(first).hexdigest()[:16]) == HELD[sample]


def digest_of(instance: Any) -> str:
    return str(instance.digest())[7:23] if hasattr(instance, "digest") else ""
