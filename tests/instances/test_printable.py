import pytest
from hypothesis import given, strategies as st

from waybound.instances.errors import InputError, UnsupportedError, UsageError
from waybound.instances.printable import LONGEST_LINE, one_line, printable

HOSTILE = {
    "colour": "\x1b[31;1mred\x1b[0m", "window title": "\x1b]0;title\x07", "eight-bit control": "\x9b2J",
    "forged line": "source\nbound  999999, verified: optimal", "carriage return": "infeasible\rfeasible  ", "backspaces": "no\b\byes",
    "bidirectional override": "\u202e0.1 dnuob\u202c\u2066x\u2069", "zero width": "op\u200bti\u200dmal\ufeff",
    "line separator": "a\u2028b\u2029c", "lone surrogate": "\ud800", "nothing to see": "\u3164\u115f\u2800",
    "piled marks": "a" + "\u0301" * 500, "tags": "\U000e0041\U000e0042",
}  # fmt: skip


@pytest.mark.parametrize("text", HOSTILE.values(), ids=HOSTILE)
def test_nothing_moves_hides_or_reorders(text: str) -> None:
    for made in (printable(text), one_line(text), str(UsageError(text)), str(InputError(text, file=text, expected=text, found=text))):
        assert made.isprintable()
        made.encode()  # no lone surrogates
        assert not set(made) & set("\u3164\u115f\u2800")
        assert "\u0301" * 3 not in made


def test_ordinary_text_is_left_as_it_is() -> None:
    for text in ("  visits", "Müller 3, 東京, São João", "\u0417\u0438\u043c\u0430 a\u0301", ""):
        assert printable(text) == text


def test_a_long_text_keeps_its_beginning_and_its_end() -> None:
    made = one_line("beginning " + "x" * 10**6 + " end")
    assert len(made) == LONGEST_LINE
    assert made.startswith("beginning") and made.endswith(" end") and " ... " in made


@pytest.mark.parametrize("error", [UsageError("x" * 9000), InputError("y", found="z" * 9000), UnsupportedError("a", ["b" * 3000] * 3)])
def test_no_error_is_longer_than_a_few_lines_of_a_terminal(error: Exception) -> None:
    assert len(str(error)) <= LONGEST_LINE


@given(st.text(), st.integers(20, 300))
def test_cleaning_once_is_enough(text: str, most: int) -> None:
    made = printable(text, most)
    assert made.isprintable() and len(made) <= most
    assert printable(made, most) == made
    assert one_line(one_line(text)) == one_line(text)


def test_what_python_refuses_to_write_out_is_told_by_its_type() -> None:
    deep: list[object] = []
    for _ in range(100_000):
        deep = [deep]
    assert printable(10**5000) == "too large to show: int"
    assert printable(deep) == "too large to show: list"
