from pathlib import Path

import pytest
from coded import coded

from waybound.instances.bundled import bundled_path
from waybound.instances.errors import InputError, UsageError
from waybound.instances.formats import FORMATS
from waybound.instances.reading import read_instance, recognise

from .test_reading_fuzz import BASES


def test_the_content_decides_and_not_the_name(tmp_path: Path) -> None:
    for name, expected in (("demo-c25", "solomon"), ("demo-x40", "vrplib"), ("demo-tiny", "json"), ("figure-3-3", "edges")):
        path = tmp_path / "some.csv"
        path.write_bytes(bundled_path(name).read_bytes())
        assert read_instance(path).format == expected


def test_a_format_can_be_forced(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="heading is missing"):
        read_instance(bundled_path("demo-x40"), format="solomon")
    with pytest.raises(UsageError, match="unknown format 'excel'; choose from agent-jobs, assignment-matrix, assignment-pairs, chao, "):
        read_instance(tmp_path / "does-not-matter", format="excel")


def test_two_possible_formats_are_named(tmp_path: Path) -> None:
    path = tmp_path / "both.txt"
    path.write_text("VEHICLE\nNUMBER CAPACITY\n3 5\nDIMENSION: 5\n")
    with pytest.raises(
        UsageError,
        match=r"both.txt: the content allows more than one format; choose with --format, or --problem, from solomon ",
        check=coded("ambiguous"),
    ):
        read_instance(path)


@pytest.mark.parametrize("bins", ["x,y", "id,b", "role,x,y", "robot,action,target", "robot,bin,cost"])
def test_names_of_bins_are_no_titles_of_another_format(bins: str) -> None:
    assert recognise(f"# name: yard\nrobot/bin,{bins}\nr{',1' * (bins.count(',') + 1)}\n").name == "assignment-matrix"


@pytest.mark.parametrize(("text", "found"), [(",a,b\nr1,1,2\nr2,-,3e1\n", ",a,b"), ("1;2\n3;4\n", "1;2"), ("r;a;b\np;1;\n", "r;a;b")])
def test_a_matrix_without_its_corner_is_told_what_it_lacks(text: str, found: str, tmp_path: Path) -> None:
    path = tmp_path / "costs.csv"
    path.write_text(text)
    wanted = "robot/bin and the names of the bins as titles, then rows of a robot's name and its costs"
    with pytest.raises(
        InputError, match=f"costs.csv:1: is of no known format, but nearly assignment-matrix; expected {wanted}; found '{found}'"
    ):
        read_instance(path)
    with pytest.raises(InputError, match=f"costs.csv:1: is a matrix without its corner; expected {wanted}"):
        read_instance(path, format="assignment-matrix")


def test_no_known_format_lists_them_all(tmp_path: Path) -> None:
    path = tmp_path / "letter.txt"
    path.write_text("\nDear customer,\n")
    names = ", ".join(FORMATS.names())
    with pytest.raises(InputError, match=f"letter.txt:1: is of no known format; expected {names}; found 'Dear customer,'"):
        read_instance(path)


@pytest.mark.parametrize("text", ["Route #1: 1 2\nCost 5\n", "TOUR_SECTION\n1\n-1\n"])
def test_a_solution_file_is_named_as_one(text: str, tmp_path: Path) -> None:
    path = tmp_path / "a.sol"
    path.write_text(text)
    with pytest.raises(InputError, check=coded("foreign")):
        read_instance(path)


def test_every_format_recognises_what_it_writes_and_nothing_else_does() -> None:
    instance = read_instance(bundled_path("demo-tiny"))
    made = {name: FORMATS[name].write for name in FORMATS}
    written = {name: write(instance) for name, write in made.items() if write is not None and name in ("csv", "json")}
    written["solomon"] = bundled_path("demo-c25").read_text()
    written["vrplib"] = bundled_path("demo-x40").read_text()
    written["edges"] = bundled_path("figure-3-3").read_text()
    written["uncertain-edges"] = "# start: a\n# goal: b\nfrom,to,mean,variance\na,b,1,1\n"
    written["agent-jobs"] = "agent,job,cost,consumption,capacity\np,,,,4\np,a,2,2,\n"
    written["assignment-pairs"] = "robot,bin,cost\na,b,1\n"
    written["assignment-matrix"] = "robot/bin,left,right\na,1,2\n"
    written["robot-tasks"] = "role,x,y\nrobot,0,0\ntask,1,1\n"
    written["risk-map"] = "# risk map\n# conditional: yes\n# length: 0.1\nS.G\n"
    written["risk-states"] = "# conditional: yes\n# reach: 2\n# start: a\nstate,easting,northing,risk\na,0,0,0.1\nb,1,0,0.2\n"
    written |= {name: "\n".join(BASES[name]) for name in FORMATS if name in BASES}
    assert set(written) == set(FORMATS)
    for name, text in written.items():
        assert recognise(text).name == name


def test_non_utf8_is_refused_before_a_format_is_looked_for(tmp_path: Path) -> None:
    path = tmp_path / "old.tsp"
    path.write_bytes(b"NAME: x\nCOMMENT: Gr\xf6tschel\nTYPE: TSP\n")
    with pytest.raises(InputError, match=r"old.tsp:2: is not UTF-8; expected UTF-8 text; found byte 0xf6 at offset 19"):
        read_instance(path)
