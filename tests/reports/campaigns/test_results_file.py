"""The results file: rows come in whole or not at all, and what is wrong with it is told in one line."""

import sqlite3
from pathlib import Path
from typing import Any

import pytest
from campaign_cases import outcome, planned
from coded import coded

from waybound.instances.errors import Code, InputError, UsageError, WayboundError
from waybound.reports.campaigns.frames import results
from waybound.reports.campaigns.results_file import SCHEMA, ResultsFile, opened


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A results file of two runs."""
    path = tmp_path / "r.sqlite"
    with ResultsFile(path) as file:
        file.add(planned(), outcome())
        file.add(planned(seed=2), outcome(2.0))
    return path


def test_a_run_is_there_once_and_known_by_its_key(path: Path) -> None:
    with ResultsFile(path) as file:
        assert file.keys() == {planned().key, planned(seed=2).key}
        file.add(planned(), outcome(9.0))
        file.add(planned("b", time_limit=1.0), outcome(3.0))
    assert results(path)["objective"].tolist() == [1.0, 2.0, 3.0]


def test_several_runs_come_in_together_or_not_at_all(path: Path) -> None:
    def broken() -> Any:
        yield planned("b"), outcome()
        raise ZeroDivisionError

    with ResultsFile(path) as file:
        with pytest.raises(ZeroDivisionError):
            file.add_all(broken())
        assert len(file.keys()) == 2
        file.add_all([(planned("b"), outcome()), (planned("c"), outcome())])
        assert len(file.keys()) == 4


def test_nothing_but_the_file_is_left_when_it_is_closed(path: Path) -> None:
    assert [file.name for file in path.parent.iterdir()] == ["r.sqlite"]


def test_only_errors_are_forgotten_and_only_those_that_are_named(path: Path) -> None:
    bad = planned("bad")
    with ResultsFile(path) as file:
        for run in (bad, planned("bad", seed=2)):
            file.add(run, outcome(None, status="error"))
        assert file.forget({bad.key, planned().key}) == 1
        there = file.keys()
        assert bad.key not in there and planned().key in there


def test_a_second_campaign_is_kept_away_while_one_writes(path: Path) -> None:
    with ResultsFile(path), pytest.raises(UsageError, match="another campaign is writing", check=coded("file")), ResultsFile(path):
        pass
    with ResultsFile(path):
        pass


def changed(path: Path, statement: str) -> None:
    with sqlite3.connect(path) as connection:
        connection.execute(statement)


def test_a_newer_schema_is_refused_by_name(path: Path) -> None:
    changed(path, f"PRAGMA user_version = {SCHEMA + 1}")
    for use in (ResultsFile, results):
        with pytest.raises(
            InputError, match=f"newer waybound: its schema is {SCHEMA + 1}, this one reads {SCHEMA}", check=coded("unsupported")
        ):
            use(path)


def test_a_file_from_before_a_column_is_read_and_added_to(path: Path) -> None:
    changed(path, "ALTER TABLE runs DROP COLUMN cpu_seconds")
    assert results(path)["cpu_seconds"].isna().all()
    with ResultsFile(path) as file:
        file.add(planned(seed=3), outcome(3.0, cpu_seconds=0.5))
    assert results(path)["cpu_seconds"].fillna(0.0).tolist() == [0.0, 0.0, 0.5]


@pytest.mark.parametrize(
    ("content", "code", "told"),
    [(b"nonsense " * 99, "malformed", "damaged"), (b"SQLite format 3\0" + b"\xff" * 4096, "malformed", "damaged")],
)
def test_a_damaged_file_is_told_and_left_as_it_is(tmp_path: Path, content: bytes, code: Code, told: str) -> None:
    path = tmp_path / "r.sqlite"
    path.write_bytes(content)
    for use in (ResultsFile, results):
        with pytest.raises(WayboundError, match=told, check=coded(code)) as fault:
            use(path)
        assert "\n" not in str(fault.value)
    assert path.read_bytes() == content and not path.with_name("r.sqlite.lock").exists()


def test_damage_within_the_file_is_found_before_anything_is_added(path: Path) -> None:
    with sqlite3.connect(path) as connection:
        (page,) = connection.execute("SELECT rootpage FROM sqlite_master WHERE name = 'runs'").fetchone()
        (size,) = connection.execute("PRAGMA page_size").fetchone()
    data = bytearray(path.read_bytes())
    data[(page - 1) * size : page * size] = b"\x5a" * size
    path.write_bytes(data)
    with pytest.raises(InputError, match="damaged", check=coded("malformed")):
        ResultsFile(path)


def test_a_database_of_somebody_else_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "r.sqlite"
    changed(path, "CREATE TABLE songs (title)")
    for use in (ResultsFile, results):
        with pytest.raises(InputError, match="holds no results of a campaign", check=coded("foreign")):
            use(path)


def test_a_full_disk_costs_the_run_that_did_not_fit_and_no_other(path: Path) -> None:
    with ResultsFile(path) as file:
        file._connection.execute("PRAGMA max_page_count = 1")
        with pytest.raises(InputError, match="the disk is full; what was there is kept", check=coded("file")):
            file.add(planned(seed=3), outcome(3.0, [["x" * 100_000]]))
        assert len(file.keys()) == 2
    with ResultsFile(path) as file:
        file.add(planned(seed=3), outcome(3.0))
    assert len(results(path)) == 3


@pytest.mark.parametrize(("name", "told"), [("none/r.sqlite", "there is no folder"), (".", "cannot be")])
def test_a_place_that_cannot_be_written_to_is_told(tmp_path: Path, name: str, told: str) -> None:
    with pytest.raises(InputError, match=told, check=coded("file")):
        ResultsFile(tmp_path / name)


def test_reading_needs_a_file_with_results_and_never_writes(tmp_path: Path, path: Path) -> None:
    with pytest.raises(InputError, match="no such results file", check=coded("file")):
        results(tmp_path / "gone.sqlite")
    (tmp_path / "empty.sqlite").touch()
    with pytest.raises(InputError, match="holds no results", check=coded("missing")):
        results(tmp_path / "empty.sqlite")
    with opened(path) as connection, pytest.raises(sqlite3.OperationalError, match="readonly"):
        connection.execute("DELETE FROM runs")


def test_rows_can_be_read_while_a_campaign_writes(path: Path) -> None:
    with ResultsFile(path) as file:
        file.add(planned(seed=3), outcome(3.0))
        assert len(results(path)) == 3


def test_what_is_not_known_of_a_run_is_nothing_and_not_zero(tmp_path: Path) -> None:
    path = tmp_path / "r.sqlite"
    with ResultsFile(path) as file:
        lost: Any = outcome(None)
        file.add(planned(), type(lost)({"status": "error"}, {}, {}, {}))
    frame = results(path)
    assert frame["objective"].isna().all() and frame["seconds"].isna().all() and not frame["checked"].any()
