"""KEY=VALUE pairs, output paths, and the way from an error to one line."""

from __future__ import annotations

import math
import warnings

import pytest
import typer
from hypothesis import given
from hypothesis import strategies as st

from waybound.cli.options import MOST_WHOLE, bounded, distinct_paths, handled, output_path, parse_pairs, parse_value
from waybound.instances.errors import CheckFailedError, InputError, NoAnswerError, UsageError


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("3", 3), ("-3", -3), ("2.5", 2.5), ("1e3", 1000.0), (".5", 0.5), ("true", True), ("False", False), ("unlimited", "unlimited"),
        ("1-100", "1-100"), ("nan", "nan"), ("inf", "inf"), ("0x10", "0x10"), ("1_000", "1_000"),
        ("1e999", "1e999"), ("9" * 5000, "9" * 5000),
        ("\u0663", "\u0663"),
    ],
)  # fmt: skip
def test_values_are_numbers_flags_or_text(text, value):
    assert parse_value(text) == value
    assert type(parse_value(text)) is type(value)


@given(st.integers())
def test_whole_numbers_stay_whole(number):
    assert parse_value(str(number)) == number


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_decimal_numbers_are_read_back_exactly(number):
    assert parse_value(repr(number)) == number


def test_a_value_may_hold_an_equals_sign():
    assert parse_pairs(["rule=a=b"], "--set") == {"rule": "a=b"}


@pytest.mark.parametrize("pair", ["vehicles", "=3", "vehicles=", "", " = "])
def test_what_is_no_pair_is_refused(pair):
    with pytest.raises(UsageError, match="KEY=VALUE"):
        parse_pairs([pair], "--set")


def test_a_repeated_key_is_refused_even_with_the_same_value():
    with pytest.raises(UsageError, match="vehicles is given twice"):
        parse_pairs(["vehicles=3", "vehicles=3"], "--set")


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_options_must_be_finite(value):
    with pytest.raises(UsageError, match="--gap must be a finite number"):
        bounded(gap=value)


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("time_limit", 1e18, "--time-limit must be at most 1e+09, not 1e+18"),
        ("time_limit", 0.0, "--time-limit must be positive, not 0.0"),
        ("bound_time", 2e9, "--bound-time must be at most"),
        ("bound_time", -1.0, "--bound-time must be not negative"),
        ("memory_limit", 1e18, "--memory-limit must be at most"),
        ("iterations", 10**20, "--iterations must be a whole number between 1 and 2147483647"),
        ("iterations", 0, "--iterations must be a whole number"),
        ("seed", 2**63, "--seed must be a whole number between 0 and 9223372036854775807, not 9223372036854775808"),
        ("seed", -1, "--seed must be a whole number"),
        ("threads", 10**6, "--threads must be a whole number between 1 and 1024"),
        ("jobs", 10**400, "--jobs must be a whole number between 1 and 1024, not a number of 1329 bits"),
        ("steps", 10**12, "--steps must be a whole number"),
    ],
)
def test_what_no_machine_can_do_is_refused(name, value, says):
    with pytest.raises(UsageError) as caught:
        bounded(**{name: value})
    assert says in str(caught.value)


def test_numbers_of_every_day_pass():
    bounded(
        time_limit=0.001, bound_time=0.0, gap=0.0, memory_limit=None, iterations=None, seed=0, threads=1, steps=1, jobs=1, instances=None
    )


def test_a_value_beyond_what_machines_count_is_refused():
    assert parse_pairs([f"k={MOST_WHOLE}"], "--set") == {"k": MOST_WHOLE}
    for value in (f"{MOST_WHOLE + 1}", "-99999999999999999999", "9" * 300):
        with pytest.raises(UsageError, match=r"--set k=.*: whole numbers go up to 9223372036854775807"):
            parse_pairs([f"k={value}"], "--set")


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


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (UsageError("x"), 2),
        (InputError("x"), 2),
        (NoAnswerError("x"), 4),
        (CheckFailedError("x"), 5),
        (KeyboardInterrupt(), 130),
        (ValueError("x"), 1),
    ],
)
def test_each_error_has_its_exit_code_and_one_line(error, code, capsys):
    def command(verbose: bool = False) -> None:
        raise error

    with pytest.raises(typer.Exit) as caught:
        handled(command)()
    assert caught.value.exit_code == code
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ")


def test_an_internal_error_shows_its_traceback_only_when_asked(capsys):
    def command(verbose: bool = False) -> None:
        raise ValueError("boom")

    with pytest.raises(typer.Exit):
        handled(command)()
    assert "run again with -v" in capsys.readouterr().err
    with pytest.raises(typer.Exit):
        handled(command)(verbose=True)
    told = capsys.readouterr().err
    assert "Traceback" in told
    assert told.strip().splitlines()[-1] == "error: internal error: ValueError: boom"


def test_no_line_on_standard_error_is_forged(capsys):
    def command(verbose: bool = False) -> None:
        raise ValueError("boom\x1b[2J\nerror: all is well" + "x" * 9000)

    for verbose in (False, True):
        with pytest.raises(typer.Exit):
            handled(command)(verbose=verbose)
        told = capsys.readouterr().err.splitlines()
        assert all(line.isprintable() for line in told)
        assert len(told[-1]) < 400
        assert verbose or len(told) == 1


def test_want_of_memory_is_told_as_such(capsys):
    def command(verbose: bool = False) -> None:
        raise MemoryError("Unable to allocate 55. GiB")

    with pytest.raises(typer.Exit) as caught:
        handled(command)()
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


def test_a_failure_names_file_and_line_as_json(run, strict_json, tmp_path):
    path = tmp_path / "costs.csv"
    path.write_text("robot,bin,cost\na,b,3\na,c,x\n")
    data = strict_json(run("solve", path, "--json").stdout)
    assert (data["code"], data["file"], data["line"]) == (2, str(path), 3)
