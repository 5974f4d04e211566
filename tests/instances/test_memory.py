"""What needs more memory than there is, is refused before anything is made."""

from pathlib import Path

import numpy as np
import pytest

from waybound import Travel, UsageError
from waybound.instances import memory
from waybound.instances.routing import travel


def test_something_is_known_of_this_machine() -> None:
    assert 1e6 < memory.available() < 1e16
    assert memory.fits(1e6)
    assert not memory.fits(1e18)


def test_sizes_are_readable() -> None:
    assert memory.readable(7.2e9) == "6.7 GiB"
    assert memory.readable(3e6) == "2.9 MiB"
    assert memory.readable(9.4e11) == "875 GiB"


def test_a_container_leaves_what_is_unused(tmp_path: Path) -> None:
    (tmp_path / "memory.max").write_text("1000\n")
    (tmp_path / "memory.current").write_text("400\n")
    assert memory._of_container(tmp_path) == 600.0
    (tmp_path / "memory.max").write_text("max\n")
    assert memory._of_container(tmp_path) == float("inf")
    assert memory._of_container(tmp_path / "nothing") == float("inf")


def test_a_matrix_that_does_not_fit_is_refused_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "available", lambda: 1e6)
    many = Travel("EUC_2D", np.zeros((1_000, 2)))
    with pytest.raises(UsageError, match=r"all distances between 1,000 sites need 7\.6 MiB, more than there is"):
        _ = many.distances
    assert many.distance(0, np.arange(1_000)).shape == (1_000,)


def test_a_matrix_is_the_same_in_strips(monkeypatch: pytest.MonkeyPatch) -> None:
    xy = np.random.default_rng(1).uniform(0, 100, (30, 2))
    for metric in travel.METRICS:
        whole = Travel(metric, xy).distances
        with monkeypatch.context() as patch:
            patch.setattr(travel, "STRIP", 70)
            assert (Travel(metric, xy).distances == whole).all()
