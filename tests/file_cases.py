"""Shared by the tests of file formats: types of their fixtures, texts with one change, and checks of refusals."""

from collections.abc import Callable
from typing import Any

import pytest

from waybound.instances.errors import InputError, UsageError

Read = Callable[..., Any]
"""Type of the fixture ``read_text_as``."""
Refusal = Callable[..., InputError]
"""Type of the fixture ``refusal``."""
Differences = Callable[[Any, Any], list[str]]
Change = Callable[[Any], Any]


def tsplib(*headers: str, **sections: str) -> str:
    """A TSPLIB-like text of headers, a line each, and sections, whose rows are parted by ``|``."""
    parts = [f"{name}\n{rows}".replace("|", "\n") for name, rows in sections.items()]
    return "".join(f"{part}\n" for part in (*headers, *parts))


def with_line_of(text: str, number: int, line: str) -> str:
    """``text`` with another line in the place of the one with that number, from 1."""
    lines = text.split("\n")
    lines[number - 1] = line
    return "\n".join(lines)


def check_fault(error: InputError, message: str, line: int | None, expected: str | None = None, found: str | None = None) -> None:
    """Check the message of an error, or its whole text where more is given, its line, and what it expected and found unless None."""
    whole = "; expected" in message or message.startswith(("expected ", "found "))
    assert message in (str(error) if whole else error.message)
    assert error.line == line
    assert expected is None or error.expected == expected
    assert found is None or error.found == found


def error_of(read: Callable[..., Any], *arguments: Any, **settings: Any) -> InputError:
    """The InputError that a call ends with, which is one line."""
    with pytest.raises(InputError) as caught:
        read(*arguments, **settings)
    assert "\n" not in str(caught.value)
    return caught.value


def refused(read: Callable[..., Any], *arguments: Any, **settings: Any) -> str:
    """Text of the InputError that a call ends with."""
    return str(error_of(read, *arguments, **settings))


def check_refused(error: type[Exception], message: str, call: Callable[..., Any], *arguments: Any, **settings: Any) -> None:
    """A call ends with an error whose text matches a regular expression."""
    with pytest.raises(error, match=message):
        call(*arguments, **settings)


# -- tests made of a table of cases ------------------------------------------------------------------------------------------


def faults(*cases: tuple[str, int | None, str, str | None, str | None]) -> Callable[..., None]:
    """A test: each text is refused at a line with a message, and tells what it expected and found there."""

    @pytest.mark.parametrize(("text", "line", "message", "expected", "found"), cases)
    def test(text: str, line: int | None, message: str, expected: str | None, found: str | None, refusal: Refusal) -> None:
        check_fault(refusal(text), message, line, expected, found)

    return test


def unwritable(write: Callable[[Any], str], text: str, *cases: tuple[Change, str]) -> Callable[..., None]:
    """A test: the instance in ``text``, changed so that the format has no place for it, is not written, for a reason."""

    @pytest.mark.parametrize(("change", "message"), cases)
    def test(change: Change, message: str, read_text_as: Read) -> None:
        with pytest.raises(UsageError, match=message):
            write(change(read_text_as(text)))

    return test


def strangers(recognises: Callable[[str], bool], *texts: str) -> Callable[[str], None]:
    """A test: these texts are of other formats or none."""

    @pytest.mark.parametrize("text", texts)
    def test(text: str) -> None:
        assert not recognises(text)

    return test
