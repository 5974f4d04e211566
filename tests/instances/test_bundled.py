"""Bundled instances."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from waybound.instances import data
from waybound.instances.bundled import RECIPES, bundled_names, bundled_path, regenerate
from waybound.instances.errors import UsageError
from waybound.instances.reading import read_instance
from waybound.instances.writing import write_instance


@pytest.mark.parametrize("name", bundled_names())
def test_a_bundled_file_comes_out_of_its_recipe_byte_for_byte(name: str, tmp_path: Path) -> None:
    made = tmp_path / RECIPES[name].file
    write_instance(regenerate(name), made)
    assert made.read_bytes() == bundled_path(name).read_bytes()


@pytest.mark.parametrize("name", bundled_names())
def test_a_bundled_file_is_small_and_reads_as_what_was_generated(name: str, differences: Callable[..., list[str]]) -> None:
    assert bundled_path(name).stat().st_size < 20_000
    read = read_instance(bundled_path(name))
    assert differences(regenerate(name), read) == []
    assert read.name == name


def test_every_data_file_is_bundled_and_named_after_itself() -> None:
    folder = Path(str(data.__file__)).parent
    files = {p.name for p in folder.iterdir() if p.suffix in (".txt", ".vrp", ".json", ".csv", ".tsp")}
    assert files == {recipe.file for recipe in RECIPES.values()}
    assert all(Path(recipe.file).stem == name for name, recipe in RECIPES.items())


def test_the_recorded_command_tells_every_setting() -> None:
    for name, recipe in RECIPES.items():
        command = recipe.command(name)
        assert command.startswith(f"waybound generate {recipe.kind} ")
        told = dict(re.findall(r"--set ([a-z-]+)=(\S+)", command))
        assert told == {**{k: str(v) for k, v in recipe.settings.items()}, "name": name}


def test_an_unknown_name_lists_the_choices() -> None:
    with pytest.raises(UsageError, match="no bundled instance is named 'C101'; choose from demo-c25"):
        bundled_path("C101")
