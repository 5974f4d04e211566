from collections.abc import Callable
from pathlib import Path

import pytest
from coded import coded
from file_cases import check_refused

from waybound.instances.errors import InputError, UsageError
from waybound.instances.generating import generate
from waybound.instances.reading import read_instance
from waybound.instances.text import an
from waybound.instances.writing import format_of_suffix, write_instance


@pytest.mark.parametrize(
    ("suffix", "name"), [(".json", "json"), (".txt", "solomon"), (".vrp", "vrplib"), (".tsp", "vrplib"), (".csv", "csv"), (".JSON", "json")]
)
def test_the_suffix_chooses_the_format(suffix: str, name: str) -> None:
    assert format_of_suffix(f"a{suffix}").name == name


def test_an_unknown_suffix_lists_the_choices() -> None:
    with pytest.raises(
        UsageError, match=r"a.xml: the suffix stands for no format of a routing instance; use one of .csv, .hvrp, .json, .mdvrp, .mtsp, "
    ):
        format_of_suffix("a.xml")


@pytest.mark.parametrize(
    ("kind", "suffix", "name"), [("sensing", ".csv", "edges"), ("sensing", ".json", "json"), ("max-min", ".json", "json")]
)
def test_the_kind_chooses_among_formats_of_one_suffix(kind: str, suffix: str, name: str) -> None:
    assert format_of_suffix(f"a{suffix}", kind).name == name


@pytest.mark.parametrize(
    ("kind", "suffix"),
    [("sensing", ".txt"), ("selection", ".csv"), ("max-min", ".vrp"), ("assignment", ".xyz"), ("exploration-map", ".csv")],
)
def test_a_suffix_that_stands_for_formats_of_other_kinds_is_refused(kind: str, suffix: str) -> None:
    with pytest.raises(UsageError, match=f"no format of {an(kind)} instance"):
        format_of_suffix(f"a{suffix}", kind)


def test_a_sensing_graph_goes_through_a_csv_file(tmp_path: Path, differences: Callable[..., list[str]]) -> None:
    made = generate("sata", 3, robots=5, targets=9, phi=40)
    write_instance(made, tmp_path / "a.csv")
    assert differences(made, read_instance(tmp_path / "a.csv")) == []
    for other in ("csv", "solomon", "vrplib"):
        with pytest.raises(UsageError, match="holds no routing data"):
            write_instance(made, tmp_path / "b.txt", other)
    with pytest.raises(UsageError, match="holds no sensing graph"):
        write_instance(generate("random", 1), tmp_path / "b.csv", "edges")
    assert [p.name for p in tmp_path.iterdir()] == ["a.csv"]


def test_a_named_format_wins_over_the_suffix(tmp_path: Path, differences: Callable[..., list[str]]) -> None:
    made = generate("solomon", 1, customers=5)
    write_instance(made, tmp_path / "a.dat", "solomon")
    assert differences(made, read_instance(tmp_path / "a.dat")) == []


def test_what_cannot_be_expressed_leaves_no_file(tmp_path: Path) -> None:
    check_refused(UsageError, "cannot be written as solomon", write_instance, generate("uchoa", 1), tmp_path / "a.txt")
    check_refused(UsageError, "cannot be written as vrplib", write_instance, generate("random", 1), tmp_path / "a.vrp")
    assert list(tmp_path.iterdir()) == []


def test_a_directory_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, check=coded("file")):
        write_instance(generate("random", 1), tmp_path, "json")
