import numpy as np
import pytest
from hypothesis import given, strategies as st
from selection_problems import KINDS, OWN_KINDS, random_function

from waybound.formulations.stop import Stop
from waybound.instances.sata.set_functions import Coverage
from waybound.solvers.bounds.sata.growing_sets import empty_set


@given(st.integers(0, 10**6), st.sampled_from((*KINDS, *OWN_KINDS)))
def test_values_and_gains_are_the_functions(seed: int, kind: str) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 9))
    f, order = random_function(rng, kind, n), rng.permutation(n).tolist()
    grown = empty_set(f)
    grown.add(order[:1])
    for k in range(1, n):
        base = f.value(np.array(order[:k]))
        assert grown.value == pytest.approx(base)
        gains = grown.gains(np.arange(n))
        assert gains == pytest.approx([f.value(np.unique([*order[:k], e])) - base for e in range(n)], abs=1e-9)
        grown.take(order[k], float(gains[order[k]]))
    assert grown.evaluations == n * (n - 1)
    assert grown.value == pytest.approx(f.value(np.arange(n)))


def test_the_best_is_the_first_of_equal_ones_and_none_after_the_end() -> None:
    grown, late = empty_set(Coverage.from_sets([[0], [1], [1]], [1.0, 2.0])), Stop()
    assert grown.best_of(np.arange(3)) == (1, 2.0)
    late.ask()
    assert grown.best_of(np.arange(3), late) == (-1, 0.0)
