"""Tables of best known values: found beside instances, and read with care."""

from pathlib import Path

import pytest
from coded import coded

from waybound.instances.errors import InputError
from waybound.reports.campaigns.best_known import best_known, value_for
from waybound.reports.campaigns.instance_list import Named

TABLE = """family,instance,convention,objective,value
x,a,euclidean-double,distance,10
x,a,dimacs-trunc1,distance,9
x,a,euclidean-double,vehicles-then-distance,3
x,b,tsplib,score(max),7
x,c,tsplib-nint,distance (at most k=7 routes),4
x,c,tsplib-nint,distance (fleet unlimited),5
"""


def named(folder: Path, name: str) -> Named:
    return Named(name, name, folder / f"{name}.txt", f"hash-{name}")


def test_the_value_of_a_problem_is_that_of_its_convention_and_sense(tmp_path: Path) -> None:
    (tmp_path / "bks.csv").write_text(TABLE)
    inner = tmp_path / "solomon" / "R1"
    inner.mkdir(parents=True)
    made = best_known([named(inner, name) for name in "abcd"])
    assert set(made) == {"hash-a", "hash-b", "hash-c"}
    assert value_for(made["hash-a"], "exact", "min") == 10.0 and value_for(made["hash-a"], "trunc1", "min") == 9.0
    assert value_for(made["hash-a"], "round", "min") is None and value_for(made["hash-a"], "exact", "max") is None
    assert value_for(made["hash-b"], "file", "max") == 7.0
    assert value_for(made["hash-c"], "file", "min") is None, "which of the two is meant, the table does not say"


def test_two_columns_are_enough(tmp_path: Path) -> None:
    (tmp_path / "own.csv").write_text("instance,value\na,3.5\n")
    made = best_known([named(tmp_path, "a")], tmp_path / "own.csv")
    assert value_for(made["hash-a"], "exact", "max") == 3.5
    assert best_known([named(tmp_path, "a")]) == {}


@pytest.mark.parametrize(
    ("text", "told"), [("instance,best\na,1\n", "no column 'value'"), ("instance,value\na,x\n", ":2: 'x' is no number")]
)
def test_a_table_that_is_none_is_told_with_its_place(tmp_path: Path, text: str, told: str) -> None:
    (tmp_path / "own.csv").write_text(text)
    with pytest.raises(InputError, match=told):
        best_known([named(tmp_path, "a")], tmp_path / "own.csv")
    with pytest.raises(InputError, match="no such file", check=coded("file")):
        best_known([named(tmp_path, "a")], tmp_path / "gone.csv")
