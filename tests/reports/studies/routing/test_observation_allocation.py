import numpy as np
import pytest

from waybound.reports.studies.routing import observation_allocation as study

HOW = {**study.DEFAULTS, "looks": 200}


def test_each_step_looks_at_the_cells_of_the_largest_worth(monkeypatch):
    class Fixed:
        pass

    order, worth = np.linspace(1.0, 0.0, study.CELLS), np.zeros(study.CELLS)
    worth[[3, 700]] = 2.0, 1.0
    monkeypatch.setattr(study, "cell_worth", lambda map_, utility, weight: worth)
    assert study._chosen(Fixed(), "proposed", 1.0, 3, order).tolist() == [3, 700, study.CELLS - 1]
    assert study._chosen(Fixed(), "random", 1.0, 2, order).tolist() == [study.CELLS - 2, study.CELLS - 1]


def test_both_utilities_beat_random_looks():
    both, random = (study.allocated(1, 300, **{**HOW, "objective": name}) for name in ("proposed", "random"))
    assert both["entropy"] < random["entropy"] and both["response"] < random["response"]
    assert study.allocated(1, 300, **HOW) == both


@pytest.mark.slow
@pytest.mark.parametrize(("looks", "printed", "tolerance"), [(100, 0.2644, 0.03), (150, 0.1634, 0.02), (200, 0.1238, 0.013)])
def test_responses_of_random_looks_are_those_printed(looks, printed, tolerance):
    runs = [study.allocated(seed, 1000, **{**HOW, "objective": "random", "looks": looks}) for seed in (1, 2, 3)]
    assert np.mean([run["response"] for run in runs]) == pytest.approx(printed, abs=tolerance)
    assert all(run["unobserved"] == 0 for run in runs)
    assert round(100 * 150 / study.CELLS, 2) == 13.98
