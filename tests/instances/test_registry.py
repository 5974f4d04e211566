import sys
from collections.abc import Callable, Iterator
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


def test_one_from_outside_gives_way_to_ours_with_a_word() -> None:
    made: Registry[int] = Registry("thing", "waybound.instances.data")
    made.add("ant", 1)
    with pytest.warns(RuntimeWarning, match="thing ant of .*test_registry is left out: waybound has one of that name"):
        exec("made.add('ant', 2)", {"__name__": "waybound.heuristics.ant", "made": made})
    assert made["ant"] == 2
    with pytest.raises(ValueError, match="two things are named 'ant'"):
        made.add("ant", 3)


def test_register_is_a_decorator() -> None:
    made: Registry[object] = Registry("thing", "waybound.instances.data")

    @made.register("f")
    def f() -> None: ...

    assert made["f"] is f


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str, dict[str, str]], None]:
    """``installed(points, modules)``: a distribution with entry points, on the path."""

    def make(points: str, modules: dict[str, str]) -> None:
        info = tmp_path / "outside-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text("Metadata-Version: 2.1\nName: outside\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(points)
        for name, text in modules.items():
            (tmp_path / f"{name}.py").write_text(text)
            monkeypatch.delitem(sys.modules, name, raising=False)
        monkeypatch.syspath_prepend(str(tmp_path))

    return make


def test_installed_packages_add_entries_by_modules_that_register_themselves_or_by_name(installed) -> None:
    made: Registry[int] = Registry("thing", group="waybound.things")
    monkey = "import builtins\nbuiltins.registry_of_things.add('seven', 7)\nNINE = 9\n"
    installed("[waybound.things]\nanything = outside_things\nnine = outside_things:NINE\n", {"outside_things": monkey})
    import builtins

    builtins.registry_of_things = made  # type: ignore[attr-defined]
    try:
        assert made.names() == ["nine", "seven"]
        assert (made["nine"], made["seven"]) == (9, 7)
    finally:
        del builtins.registry_of_things  # type: ignore[attr-defined]


def test_an_installed_package_that_cannot_be_loaded_costs_no_other_entry(installed) -> None:
    made: Registry[int] = Registry("thing", group="waybound.things")
    points = "[waybound.things]\nbroken = outside_broken\nmissing = outside_sound:NOTHING\nsound = outside_sound:ONE\n"
    installed(points, {"outside_broken": "raise RuntimeError('boom')\n", "outside_sound": "ONE = 1\n"})
    with pytest.warns(RuntimeWarning) as caught:
        assert made.names() == ["sound"]
    said = [str(w.message) for w in caught]
    assert any("thing broken of outside cannot be loaded: RuntimeError: boom" in line for line in said)
    assert any("thing missing of outside cannot be loaded" in line for line in said)


def test_a_temporary_entry_takes_the_place_of_another_and_leaves_it_as_it_was(things: Registry[int]) -> None:
    with things.temporary("ant", 5), things.temporary("new", 6):
        assert (things["ant"], things["new"]) == (5, 6)
    assert things.names() == ["ant", "zebra"]
    assert things["ant"] == 2


def test_places_walk_the_rooms_of_a_floor(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for room, value in (("red", 1), ("blue", 2)):
        folder = tmp_path / "floor_of_rooms" / room / "shelves"
        folder.mkdir(parents=True)
        (folder.parent / "__init__.py").write_text("")
        (folder / "__init__.py").write_text("")
        (folder / "box.py").write_text(f"import floor_of_rooms\nfloor_of_rooms.BOXES.add('{room}', {value})\n")
        (folder / "slow_kernels.py").write_text("raise RuntimeError('never imported')\n")
    (tmp_path / "floor_of_rooms" / "__init__.py").write_text(
        "from waybound.instances.registry import Registry\nBOXES = Registry('box', 'floor_of_rooms.*.shelves')\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    import floor_of_rooms  # type: ignore[import-not-found]

    assert floor_of_rooms.BOXES.names() == ["blue", "red"]


def test_an_entry_that_calls_itself_otherwise_than_its_entry_point_is_told(installed) -> None:
    made: Registry[object] = Registry("thing", group="waybound.things")
    source = "class Named:\n    def __init__(self, name):\n        self.name = name\nONE = Named('one')\nTWO = Named('zwei')\n"
    installed("[waybound.things]\none = outside_named:ONE\ntwo = outside_named:TWO\n", {"outside_named": source})
    with pytest.warns(RuntimeWarning, match="thing two of outside cannot be loaded: it calls itself 'zwei'"):
        assert made.names() == ["one"]
