import pytest
from bin_assignments import worked

import waybound as wb
from waybound import BinAssignment, UnsupportedError
from waybound.solvers.backend import BACKENDS, Control, Options

OTHER = {"lapjv": "bottleneck", "epsilon-scaling": "bottleneck", "min-cost-flow": "bottleneck", "threshold-matching": "sum"}


@pytest.mark.parametrize("solver", OTHER)
def test_the_other_objective_is_refused_by_name(solver: str) -> None:
    with pytest.raises(UnsupportedError, match=f"{solver} cannot take this problem: it does not handle objective:{OTHER[solver]}"):
        wb.solve(worked("O", objective=OTHER[solver]), solver)


@pytest.mark.parametrize("solver", OTHER)
def test_fewer_pairs_than_asked_for_are_found_in_the_data(solver: str) -> None:
    objective = "sum" if OTHER[solver] == "bottleneck" else "bottleneck"
    none = BinAssignment.from_matrix([[1.0], [2.0]], objective=objective, match="robots")
    raw = BACKENDS[solver]().run(none, Options(), Control())
    assert raw.status == "infeasible" and raw.evidence[0].kind == "pair-cover"
