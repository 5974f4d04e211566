import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from coded import coded

from waybound import Cardinality, Coverage, SelectionInstance, UsageError
from waybound.instances import data
from waybound.instances.bundled import RECIPES, bundled_names, bundled_path, regenerate
from waybound.instances.reading import read_instance
from waybound.instances.writing import write_instance

GENERATED = [name for name in bundled_names() if not RECIPES[name].source]
CASES = [name for name in bundled_names() if RECIPES[name].source]


@pytest.mark.parametrize("name", GENERATED)
def test_a_bundled_file_comes_out_of_its_recipe_byte_for_byte(name: str, tmp_path: Path) -> None:
    made = tmp_path / RECIPES[name].file
    write_instance(regenerate(name), made)
    assert made.read_bytes() == bundled_path(name).read_bytes()


@pytest.mark.parametrize("name", GENERATED)
def test_a_bundled_file_reads_as_what_was_generated(name: str, differences: Callable[..., list[str]]) -> None:
    assert differences(regenerate(name), read_instance(bundled_path(name))) == []


@pytest.mark.parametrize("name", CASES)
def test_a_case_of_the_literature_is_written_as_it_stands_and_not_generated(name: str, tmp_path: Path) -> None:
    made = tmp_path / RECIPES[name].file
    write_instance(read_instance(bundled_path(name)), made)
    assert made.read_bytes() == bundled_path(name).read_bytes()
    with pytest.raises(UsageError, match=name, check=coded("unsupported")):
        regenerate(name)


@pytest.mark.parametrize("name", bundled_names())
def test_a_bundled_file_is_small_and_named_after_itself(name: str) -> None:
    assert bundled_path(name).stat().st_size < 20_000
    assert read_instance(bundled_path(name)).name == name


def test_cover_30_is_what_its_formula_says() -> None:
    made: Any = read_instance(bundled_path("cover-30"))
    sets = [sorted({(7 * i + j * j * (1 + i % 3)) % 61 for j in range(8)}) for i in range(30)]
    expected = Coverage.from_sets(sets, [1 + (e * e) % 5 for e in range(61)])
    assert made.digest() == SelectionInstance(expected, Cardinality(6)).digest()
    assert made.element_names == tuple(map(str, range(30)))


def test_sata_s3_and_figure_3_3_hold_the_published_weights() -> None:
    s3: Any = read_instance(bundled_path("sata-s3"))
    rows = [
        [(9, 0, 0, 3), (2, 2, 1, 0), (9, 7, 0, 8)], [(5, 0, 0, 0), (2, 2, 7, 8), (0, 7, 2, 9)], [(7, 5, 2, 6), (8, 3, 0, 1), (5, 4, 3, 1)],
    ]  # fmt: skip
    dense = np.zeros((9, 4))
    dense[s3.action_of_edge, s3.indices] = s3.weights
    assert dense.tolist() == [list(map(float, row)) for robot in rows for row in robot]
    assert s3.robot_of_action.tolist() == [0, 0, 0, 1, 1, 1, 2, 2, 2]
    figure: Any = read_instance(bundled_path("figure-3-3"))
    seen = {(figure.action_name(a), figure.target_name(t)) for a, t in zip(figure.action_of_edge, figure.indices, strict=True)}
    assert seen == {("p1", "t1"), ("p2", "t2"), ("p3", "t2"), ("p3", "t3"), ("p4", "t3"), ("p5", "t3"), ("p6", "t1")}
    assert (figure.weights == 1).all()


def test_every_data_file_is_bundled_and_named_after_itself() -> None:
    folder = Path(str(data.__file__)).parent
    files = {p.name for p in folder.iterdir() if p.suffix in (".txt", ".vrp", ".json", ".csv", ".tsp")}
    assert files == {recipe.file for recipe in RECIPES.values()}
    assert all(Path(recipe.file).stem == name for name, recipe in RECIPES.items())
    assert all(bool(recipe.source) != bool(recipe.kind) for recipe in RECIPES.values())


def test_the_recorded_command_tells_every_setting() -> None:
    for name in GENERATED:
        recipe = RECIPES[name]
        command = recipe.command(name)
        assert command.startswith(f"waybound generate {recipe.kind} ")
        told = dict(re.findall(r"--set ([a-z-]+)=(\S+)", command))
        assert told == {**{k: str(v) for k, v in recipe.settings.items()}, "name": name}


def test_an_unknown_name_lists_the_choices() -> None:
    with pytest.raises(UsageError, match="no bundled instance is named 'C101'; choose from demo-c25"):
        bundled_path("C101")
