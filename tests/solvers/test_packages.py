import importlib.util
from importlib.metadata import PackageNotFoundError

import pytest

from waybound.solvers.packages import is_installed, version_of


def test_what_was_missing_is_looked_for_again_and_what_was_found_is_not(monkeypatch, tmp_path):
    asked = []
    find = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: asked.append(name) or find(name))
    assert not is_installed("brought_later")
    (tmp_path / "brought_later.py").touch()
    monkeypatch.syspath_prepend(tmp_path)
    assert is_installed("brought_later") and is_installed("brought_later")
    assert asked == ["brought_later"] * 2


def test_a_version_is_that_of_the_distribution():
    assert version_of("numpy")[0].isdigit()
    with pytest.raises(PackageNotFoundError):
        version_of("no-such-distribution")
