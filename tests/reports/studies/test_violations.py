from pathlib import Path

import pytest

import waybound as wb
from waybound.formulations.problem import problem_from_instance
from waybound.instances.errors import InputError
from waybound.instances.writing import write_instance
from waybound.reports.studies.auctions import local_ratio
from waybound.reports.studies.risk.families import risky_graphs, uncertain_graphs as uncertain
from waybound.reports.studies.routing.families import routing as routes
from waybound.reports.studies.sata.families import max_min as graphs, selection as random
from waybound.reports.studies.study import Fault, Report
from waybound.reports.studies.violations import instance_of, instance_text, summary_lines, write_faults
from waybound.reports.tables.table import Table


@pytest.mark.parametrize(
    "kind", ["bottleneck-lp", "winner-takes-all", "max-min-lp", "selection", "tsp", "cvrp", "risky-path", "generalised-assignment"]
)
def test_every_kind_of_instance_is_written_and_read_back(kind, tmp_path):
    problem = {
        "bottleneck-lp": graphs.RANDOM_FAMILIES[3], "winner-takes-all": random.RANDOM_ASSIGNMENTS,
        "max-min-lp": graphs.RANDOM_PROGRAMS,
        "selection": random.random_families("knapsack")[2], "tsp": routes.random_families("salesman")[4],
        "cvrp": routes.random_families("shared")[0], "risky-path": risky_graphs.least_risk(),
        "generalised-assignment": local_ratio.RANDOM_PROFITS,
    }[kind].case(5, 1).problem  # fmt: skip
    path = tmp_path / "instance.json"
    write_instance(instance_of(problem, "something is wrong here"), path)
    again = wb.read(path)
    assert again.problem == kind
    assert again.digest() == problem.digest()
    assert any("something is wrong here" in note for note in again.notes)
    assert "something is wrong here" in instance_text(problem, "something is wrong here")
    assert problem_from_instance(instance_of(problem)).digest() == problem.digest()


def test_a_file_holds_the_settings_too(tmp_path):
    problem = uncertain.graphs(0.2).case(1, 1).problem
    path = tmp_path / "instance.json"
    write_instance(instance_of(problem, "something is wrong here"), path)
    again = wb.read(path)
    assert again.digest() == problem.digest()
    assert again.notes == ("something is wrong here",)


def test_a_users_function_has_no_file_and_says_so():
    problem = random.random_families("cardinality")[-1].case(1, 1).problem
    assert instance_of(problem) is None
    assert "cannot be written" in instance_text(problem)


def report(*faults: Fault) -> Report:
    return Report("mine", "title", Table("title", (), ()), faults=faults, num_faults=len(faults))


def test_files_are_numbered_by_the_faults_that_have_an_instance(tmp_path: Path) -> None:
    problem = random.random_families("cardinality")[0].case(1, 1).problem
    with_file, without = Fault("ratio", "too far", instance_of(problem)), Fault("error", "crashed")
    files = write_faults(report(with_file, without, with_file), tmp_path)
    assert [None if f is None else Path(f).name for f in files] == ["violation-mine-1.json", None, "violation-mine-2.json"]
    assert wb.read(files[2]).digest() == problem.digest()


def test_a_folder_that_is_none_is_told(tmp_path: Path) -> None:
    problem = random.random_families("cardinality")[0].case(1, 1).problem
    with pytest.raises(InputError):
        write_faults(report(Fault("ratio", "too far", instance_of(problem))), tmp_path / "missing")


def test_lines_are_few_and_tell_how_many_more_there_are() -> None:
    faults = [Fault("ratio", f"case {k}") for k in range(5)]
    files = ["a.json", None, None, None, None]
    assert summary_lines(faults, files, 9, most=2) == ["ratio: case 0; instance in a.json", "ratio: case 1", "and 7 more"]
    assert summary_lines(faults[:1], files[:1], 1) == ["ratio: case 0; instance in a.json"]
