"""The registry that everything registers itself in."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from waybound.instances.errors import UsageError
from waybound.instances.registry import Registry

MODULE = "import {registry}\n{registry}.THINGS.add({name!r}, {value})\n"


@pytest.fixture
def things(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Registry[int]]:
    """A package of two modules and a private one, with a registry of what they add."""
    package = tmp_path / "some_things"
    package.mkdir()
    (package / "__init__.py").write_text("from waybound.instances.registry import Registry\nTHINGS = Registry('thing', 'some_things')\n")
    (package / "aa.py").write_text(MODULE.format(registry="some_things", name="zebra", value=1))
    (package / "bb.py").write_text(MODULE.format(registry="some_things", name="ant", value=2))
    (package / "_private.py").write_text("raise RuntimeError('never imported')\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    import some_things  # type: ignore[import-not-found]

    yield some_things.THINGS
    for name in [name for name in sys.modules if name.startswith("some_things")]:
        del sys.modules[name]


def test_modules_are_found_and_private_ones_are_not(things: Registry[int]) -> None:
    assert "some_things.aa" not in sys.modules
    assert things["ant"] == 2
    assert things.names() == ["ant", "zebra"]
    assert list(things) == ["ant", "zebra"]
    assert things.values() == [2, 1]
    assert "zebra" in things and "bee" not in things


def test_the_order_does_not_depend_on_what_was_imported_first(things: Registry[int]) -> None:
    import some_things.bb  # type: ignore[import-not-found]  # noqa: F401

    assert things.names() == ["ant", "zebra"]


def test_an_unknown_name_lists_the_choices(things: Registry[int]) -> None:
    with pytest.raises(UsageError, match="unknown thing 'bee'; choose from ant, zebra"):
        things["bee"]


def test_two_entries_of_one_name_are_a_programming_error(things: Registry[int]) -> None:
    with pytest.raises(ValueError, match="two things are named 'ant'"):
        things.add("ant", 3) if things.names() else None


def test_register_is_a_decorator() -> None:
    made: Registry[object] = Registry("thing", "waybound.instances.data")

    @made.register("f")
    def f() -> None: ...

    assert made["f"] is f
