"""A compiled loop sees a flag that another thread sets while it runs, and does not see one that is not set."""

import threading

import numpy as np

from waybound.formulations.kernels import kernel
from waybound.formulations.stop_kernel import asked


@kernel()
def turns(flag, most):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    done = 0
    while done < most and not asked(flag):
        done += 1
    return done


def test_any_value_but_0_asks_for_an_end() -> None:
    for value in (1, -1, 2**40):
        assert turns(np.array([value], dtype=np.int64), 10) == 0
    assert turns(np.zeros(1, dtype=np.int64), 10) == 10


def test_a_loop_that_runs_sees_a_flag_that_is_set_later() -> None:
    """A plain load is taken out of the loop by the compiler, and the loop then takes minutes."""
    flag = np.zeros(1, dtype=np.int64)
    turns(flag, 1)
    timer = threading.Timer(0.05, flag.__setitem__, (0, 1))
    timer.start()
    assert turns(flag, 10**12) < 10**12
    timer.join()
