import numpy as np
import pytest

from waybound.reports.battery.kinds import KINDS


@pytest.mark.parametrize("kind", list(KINDS))
def test_a_kind_repeats_and_varies_and_has_a_form(kind: str) -> None:
    one, same, other = (KINDS[kind](np.random.default_rng([7, turn])) for turn in (1, 1, 2))
    assert one.digest() == same.digest() != other.digest()
    assert one.forms()
    assert one.compile(one.forms()[0]).program.num_variables < 1000
