"""Standard output that fails, or that knows few characters."""

import io
import json
import subprocess
import sys

import pytest
from coded import coded

from waybound.cli.output import print_json, print_table, write_out
from waybound.instances.errors import InputError
from waybound.reports.tables.table import Column, Table


class Failing(io.StringIO):
    def flush(self) -> None:
        raise OSError(28, "No space left on device")


def test_what_the_system_refuses_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", Failing())
    with pytest.raises(InputError, match=r"standard output .*No space left on device", check=coded("file")):
        write_out("x")


def test_a_closed_stream_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    closed = io.StringIO()
    closed.close()
    monkeypatch.setattr(sys, "stdout", closed)
    with pytest.raises(InputError, match="standard output cannot be written to: ValueError: I/O operation on closed file"):
        write_out("x")


def test_characters_that_the_stream_lacks_are_escaped_as_json_does(monkeypatch: pytest.MonkeyPatch) -> None:
    bytes_out = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(bytes_out, encoding="ascii"))
    data = {"name": "Zürich \U0001f69a"}
    print_json(data)
    print_table(Table("Züge", (Column("a"),), (("1",),)))
    told, table = bytes_out.getvalue().decode("ascii").split("}\n")
    assert json.loads(told + "}") == data
    assert "Z\\u00fc" in table


def test_a_table_of_many_rows_is_cut_and_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    print_table(Table("Routes", (Column("a"),), tuple((f"row {k}",) for k in range(1, 2001))))
    told = capsys.readouterr().out
    assert "row 100" in told and "row 101" not in told
    assert "and 1,900 more rows; --json has all" in told


NATIVE = """
import ctypes, os, sys
from waybound.cli.output import stdout_is_ours, write_out
libc = ctypes.CDLL(None)
write_out("{")
with stdout_is_ours():
    libc.printf(b"HighsMipSolverData::transformNewIntegerFeasibleSolution tmpSolver.run();\\n")
    libc.printf(b"a log that was asked for\\n")
    libc.printf(b"without an end")
write_out("}\\n")
"""


def test_native_output_goes_to_standard_error_and_what_nobody_asked_for_nowhere() -> None:
    done = subprocess.run([sys.executable, "-c", NATIVE], capture_output=True, text=True, timeout=60)
    assert done.stdout == "{}\n"
    assert done.stderr == "a log that was asked for\nwithout an end"
