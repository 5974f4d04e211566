"""Memories by number."""

from __future__ import annotations

import math

import numpy as np
import pytest
import risky_cases as cases

from waybound.formulations.risk.risky_path import RiskyPath
from waybound.instances.risk.tether import Tether
from waybound.instances.risk.traverse_elements import CollectedRisk, TetherRisk
from waybound.solvers.engines.risk.risky_path_steps.memories import Memories


def test_equal_memories_have_one_number_and_less_mud_is_no_worse():
    problem = cases.mud_costs()
    memories = Memories(problem)
    clean, _ = memories.step(memories.begin, 0, 2)
    muddy, _ = memories.step(memories.begin, 0, 1)
    assert clean == memories.begin != muddy
    assert memories.step(muddy, 5, 6)[1] == pytest.approx(9.0) and memories.step(clean, 5, 6)[1] == 0.0
    assert memories.no_worse(clean, muddy) and not memories.no_worse(muddy, clean)


def test_all_elements_are_remembered_together_and_certain_failure_is_infinite():
    at = np.array([(3, 0), (3, 2), (0, 1.5)])
    elements = [TetherRisk(Tether((0, 0), [[1, 1, 2, 2]]), 0.0, 0.03), CollectedRisk([True] * 3, [[0.0] * 3, [0.1] * 3])]
    memories = Memories(RiskyPath(cases.graph([(0, 1), (1, 2)], elements, goals=(2,), positions=at)))
    first, hazard = memories.step(memories.begin, 0, 1)
    assert hazard == pytest.approx(-math.log(0.97 * 0.9)) and not memories.no_worse(memories.begin, first)
    assert memories.step(first, 1, 2)[1] == math.inf
