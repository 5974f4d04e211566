import subprocess
import sys
from statistics import NormalDist

import numpy as np
import pytest

from waybound.formulations.risk.normal import ndtr, ndtri


@pytest.mark.parametrize("z", [-6.0, -1.5, 0.0, 0.25, 3.0])
def test_it_is_that_of_the_standard_library_and_its_inverse(z: float) -> None:
    below = NormalDist().cdf(z)
    assert float(ndtr(z)) == pytest.approx(below, rel=1e-9)
    assert ndtri(np.array([below]))[0] == pytest.approx(z, abs=1e-9)


def test_a_problem_without_risk_loads_none_of_it() -> None:
    code = "import sys, waybound as wb; wb.read('demo-tiny').features(); sys.exit('scipy.special' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
