from dataclasses import replace

import numpy as np
import pytest
from small_routing import at_risk

from waybound.formulations.routing.overrun import quantile
from waybound.solvers.engines.routing.routing_integers import integer_routing
from waybound.solvers.engines.routing.ruin_recreate_steps.risks import Risks


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e6])
def test_a_margin_is_that_of_the_judge_and_no_less(scale: float) -> None:
    problem = at_risk(0.05, 0.02, scale=scale)
    risks, data = Risks(problem), integer_routing(problem)
    (variances,), fineness = risks.variances(problem, data)
    for i, j in zip(*np.nonzero(problem.travel.variances), strict=True):
        margin = float(np.ldexp(risks.caution[0] * np.sqrt(float(variances[i, j])), -40 - fineness))
        asked = quantile(0.02) * problem.travel.variances[i, j] ** 0.5 * data.scales["time"]
        assert asked * (1 - 1e-12) <= margin <= asked * (1 + 1e-5)


def test_certain_moves_need_no_margin() -> None:
    problem = at_risk(0.05)
    certain = replace(problem, travel=replace(problem.travel, variances=np.zeros_like(problem.travel.variances)))
    assert not Risks(certain).risky.any() and not Risks(certain).caution.any() and not Risks(certain).shared
