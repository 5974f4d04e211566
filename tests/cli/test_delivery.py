"""Outputs that could not be written are refused beforehand; every output is tried, and the code tells the first that failed."""

from pathlib import Path

import pytest

from waybound.cli.delivery import Delivery, distinct_paths, output_path
from waybound.instances.atomic import atomic_write
from waybound.instances.errors import UsageError


def broken(*_: object) -> str:
    raise ZeroDivisionError("oops")


def test_all_that_can_be_written_is_and_the_exit_code_is_0(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    delivery = Delivery()
    delivery.file("--out", tmp_path / "a", lambda path: atomic_write(path, "x"))
    delivery.file("--plot", None, broken)  # type: ignore[arg-type]
    delivery.show(lambda: "shown\n", broken)
    assert delivery.code == 0
    assert (tmp_path / "a").read_text() == "x"
    assert capsys.readouterr() == ("shown\n", "")


def test_a_file_that_fails_costs_none_after_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    delivery = Delivery()
    delivery.file("--out", tmp_path / "none" / "a", lambda path: atomic_write(path, "x"))
    delivery.file("--certificate", tmp_path / "c", lambda path: atomic_write(path, "y"))
    delivery.file("--plot", tmp_path / "p", broken)  # type: ignore[arg-type]
    assert delivery.code == 2
    assert [p.name for p in tmp_path.iterdir()] == ["c"]
    first, second = capsys.readouterr().err.splitlines()
    assert first == f"error: --out {tmp_path}/none/a: cannot be written: there is no folder {tmp_path}/none"
    assert second == f"error: --plot {tmp_path}/p: cannot be written: ZeroDivisionError: oops"


def test_what_cannot_be_shown_is_told_plainly_with_a_traceback_if_asked(capsys: pytest.CaptureFixture[str]) -> None:
    delivery = Delivery(verbose=True)
    delivery.show(broken, lambda: "plain\n")
    said = capsys.readouterr()
    assert delivery.code == 1
    assert said.out == "plain\n"
    assert "Traceback" in said.err
    assert said.err.rstrip().endswith("ZeroDivisionError: oops")


def test_a_second_interrupt_is_heeded(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def asked_again(path: Path) -> None:
        raise KeyboardInterrupt

    delivery = Delivery()
    delivery.file("--out", tmp_path / "a", asked_again)
    assert delivery.code == 130
    assert "cannot be written: interrupted" in capsys.readouterr().err


def test_paths_that_could_not_be_written_are_refused_beforehand(tmp_path):
    (tmp_path / "folder.sol").mkdir()
    (tmp_path / "in.sol").touch()
    output_path("--out", tmp_path / "a.sol", (".sol",))
    for path, says in (
        (tmp_path / "a.xyz", "suffix"),
        (tmp_path / "folder.sol", "directory"),
        (tmp_path / "missing" / "a.sol", "no folder"),
        (tmp_path / "in.sol", "overwrite the input"),
    ):
        with pytest.raises(UsageError, match=says):
            output_path("--out", path, (".sol",), unlike=[str(tmp_path / "in.sol")])


def test_two_outputs_cannot_go_to_one_file(tmp_path):
    with pytest.raises(UsageError, match="--out and --certificate"):
        distinct_paths(out=tmp_path / "a.json", certificate=tmp_path / "." / "a.json", plot=None)
