import numpy as np
from draws import draws
from joint_assignments import WORKED, enumerated, random_joint

import waybound as wb


def test_bins_alone_are_assigned_best_and_requests_best_beside_them() -> None:
    found = wb.solve(WORKED, heuristic="bins-then-requests", bound_time=60.0)
    assert found.answer == ((1, 0), (0, 1)) and found.objective == 8.0 and found.bound == 6.0
    rng = np.random.default_rng(7)
    for _ in range(draws(30)):
        problem = random_joint(rng)
        answer = wb.solve(problem, heuristic="bins-then-requests", bound_time=0)
        assert answer.certificate.feasible and answer.objective >= enumerated(problem) - 1e-9
