"""The instances that a campaign names: bundled ones, files and patterns, and what is told of those that are not there."""

from pathlib import Path

import pytest
from coded import coded

from waybound.instances.errors import Code, InputError
from waybound.reports.campaigns.instance_list import files_named, hash_of, named_instances

CAMPAIGN = Path("c.toml")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "data").mkdir()
    for name in ("b.txt", "a.txt", "c.csv"):
        (tmp_path / "data" / name).write_text(name)
    return tmp_path


def test_a_file_is_named_without_its_suffix_and_hashed(folder: Path) -> None:
    (one,) = named_instances("data/a.txt", folder, CAMPAIGN)
    assert (one.name, one.file, one.hash) == ("a", "data/a.txt", hash_of(folder / "data" / "a.txt"))


def test_a_pattern_names_all_that_match_in_order(folder: Path) -> None:
    assert [one.file for one in named_instances("data/*.txt", folder, CAMPAIGN)] == ["data/a.txt", "data/b.txt"]
    assert [one.name for one in named_instances(f"{folder}/**/?.csv", folder, CAMPAIGN)] == ["c"]


def test_a_bundled_instance_is_named_as_it_is_unless_a_file_has_its_name(folder: Path) -> None:
    (bundled,) = named_instances("demo-tiny", folder, CAMPAIGN)
    assert bundled.path.name == "demo-tiny.json" and bundled.source == "demo-tiny"
    assert [one.source for one in named_instances("demo-[cr]25", folder, CAMPAIGN)] == ["demo-c25", "demo-r25"]
    (folder / "demo-tiny").write_text("own")
    (own,) = named_instances("demo-tiny", folder, CAMPAIGN)
    assert own.path == folder / "demo-tiny" and own.source == str(folder / "demo-tiny")


@pytest.mark.parametrize(
    ("said", "code", "told"),
    [
        ("demo-tinny", "missing", "did you mean 'demo-tiny'"),
        ("data/gone.txt", "missing", "no such file"),
        ("data/*.vrp", "missing", "no instance matches"),
        ("data", "file", "write data/[*] for the files in it"),
        ("a\0b", "missing", "no such file"),
    ],
)
def test_what_is_not_there_is_told(folder: Path, said: str, code: Code, told: str) -> None:
    with pytest.raises(InputError, match=told, check=coded(code)):
        named_instances(said, folder, CAMPAIGN)


def test_files_that_changes_name_are_hashed_and_other_values_are_not(folder: Path) -> None:
    assert set(files_named({"fleet": "data/c.csv", "vehicles": "unlimited", "capacity": 3}, folder)) == {"fleet"}
