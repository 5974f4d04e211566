from types import SimpleNamespace

import pytest

from waybound.solvers.engines.routing import pace


@pytest.mark.parametrize(("takes", "waits"), [(0.0, 0.05), (0.001, 0.05), (0.1, 2.0)])
def test_the_next_incumbent_waits_for_as_much_longer_as_one_takes_to_hand_out(
    takes: float, waits: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = [100.0]
    monkeypatch.setattr(pace, "time", SimpleNamespace(perf_counter=lambda: clock[0]))
    held = pace.Pace()
    assert held.due
    with held.handing_out():
        clock[0] += takes
    clock[0] += 0.99 * waits
    assert not held.due
    clock[0] += 0.02 * waits
    assert held.due
