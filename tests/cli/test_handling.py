"""The way from an error to one line and an exit code."""

import warnings

import pytest
import typer

from waybound.cli.handling import handled
from waybound.instances.errors import CheckFailedError, InputError, NoAnswerError, UsageError


def raising(error: BaseException):
    """A command that fails so."""

    def command(verbose: bool = False) -> None:
        raise error

    return handled(command)


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (UsageError("x"), 2), (InputError("x"), 2), (NoAnswerError("x"), 4), (CheckFailedError("x"), 5), (KeyboardInterrupt(), 130),
        (ValueError("x"), 1),
    ],
)  # fmt: skip
def test_each_error_has_its_exit_code_and_one_line(error, code, capsys):
    with pytest.raises(typer.Exit) as caught:
        raising(error)()
    assert caught.value.exit_code == code
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ")


def test_an_internal_error_shows_its_traceback_only_when_asked(capsys):
    command = raising(ValueError("boom"))
    with pytest.raises(typer.Exit):
        command()
    assert "run again with -v" in capsys.readouterr().err
    with pytest.raises(typer.Exit):
        command(verbose=True)
    told = capsys.readouterr().err
    assert "Traceback" in told
    assert told.strip().splitlines()[-1] == "error: internal error: ValueError: boom"


def test_no_line_on_standard_error_is_forged(capsys):
    command = raising(ValueError("boom\x1b[2J\nerror: all is well" + "x" * 9000))
    for verbose in (False, True):
        with pytest.raises(typer.Exit):
            command(verbose=verbose)
        told = capsys.readouterr().err.splitlines()
        assert all(line.isprintable() for line in told)
        assert len(told[-1]) < 400
        assert verbose or len(told) == 1


def test_want_of_memory_is_told_as_such(capsys):
    with pytest.raises(typer.Exit) as caught:
        raising(MemoryError("Unable to allocate 55. GiB"))()
    assert caught.value.exit_code == 4
    assert capsys.readouterr().err == "error: not enough memory for this: Unable to allocate 55. GiB\n"


def test_a_warning_is_one_line(capsys):
    def command(verbose: bool = False) -> None:
        warnings.warn("a\x1b[2J\nb", stacklevel=1)

    handled(command)()
    assert capsys.readouterr().err == "note: a [2J b\n"


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("solve", "nowhere.txt"), "nowhere.txt: no such file"),
        (("info", "demo-tiny", "--set", "nothing=3"), "unknown setting nothing"),
        (("solve", "demo-tiny", "--fast"), "No such option: --fast"),
        (("solve", "demo-tiny", "--time-limit", "soon"), "Invalid value for '--time-limit'"),
        (("explain",), "Missing argument 'FILE'"),
        (("run", "nothing"), "unknown mission 'nothing'"),
        (("solve", "demo-tiny", "--solver", "nobody"), "unknown solver 'nobody'"),
    ],
)
def test_a_failure_is_one_json_object_where_json_is_asked_for(arguments, told, run, strict_json):
    result = run(*arguments, "--json")
    data = strict_json(result.stdout)
    assert result.exit_code == data["code"] == 2 and data["error"].startswith(told)
    assert told in " ".join(result.stderr.split()).replace("│ ", "")
    assert run(*arguments).stdout == ""


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (("solve", "demo-tiny", "--fast"), "unknown-name"),
        (("solve", "demo-tiny", "--time-limit", "soon"), "malformed"),
        (("explain",), "missing"),
        (("compare", "demo-tiny"), "missing"),
        (("solvers", "--examine", "highs", "--by", "size"), "unknown-name"),
        (("solve", "demo-tiny", "--set", "k"), "malformed"),
        (("solve", "demo-tiny", "--set", "k=1", "--set", "k=2"), "duplicate"),
        (("solve", "demo-tiny", "--gap", "inf"), "out-of-range"),
        (("solve", "demo-tiny", "--plot", "a.txt"), "unsupported"),
        (("solve", "demo-tiny", "--solver", "highs", "--heuristic", "savings"), "contradiction"),
    ],
)
def test_json_tells_the_code_of_what_is_wrong(arguments, code, json_of):
    assert json_of(*arguments, code=2)["error_code"] == code


def test_a_failure_names_file_and_line_as_json(json_of, tmp_path):
    path = tmp_path / "costs.csv"
    path.write_text("robot,bin,cost\na,b,3\na,c,x\n")
    data = json_of("solve", path, code=2)
    assert (data["code"], data["file"], data["line"]) == (2, str(path), 3)


def test_an_interrupt_that_python_makes_another_error_of_is_one(capsys):
    error = RuntimeError("Error calling __set_name__")
    error.__cause__ = KeyboardInterrupt()
    with pytest.raises(typer.Exit) as caught:
        raising(error)()
    assert caught.value.exit_code == 130 and capsys.readouterr().err == "error: interrupted\n"
