import os
from pathlib import Path

import pytest
from coded import coded
from hypothesis import given, strategies as st

from waybound.instances import text as t
from waybound.instances.errors import InputError


def test_a_missing_file_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.txt: no such file"):
        t.read_text(tmp_path / "none.txt")


DEVICE = pytest.param("/dev/zero", marks=pytest.mark.skipif(not Path("/dev/zero").exists(), reason="needs a device file"))


@pytest.mark.parametrize("path", [".", "a\0b", DEVICE])
def test_what_is_no_file_is_refused_unread(path: str) -> None:
    with pytest.raises(InputError, check=coded("file")):
        t.read_text(path)


@pytest.mark.skipif(os.geteuid() == 0, reason="the superuser may read everything")
def test_a_file_without_permission_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "secret.txt"
    path.write_text("x")
    path.chmod(0)
    with pytest.raises(InputError, check=coded("file")):
        t.read_text(path)


@pytest.mark.parametrize("data", [b"", b"  \n\t\r\n", b"\xef\xbb\xbf", b"\xef\xbb\xbf \n", "\x1c\x85\u2028".encode()])
def test_nothing_but_blanks_is_an_empty_file(data: bytes) -> None:
    with pytest.raises(InputError, check=coded("missing")):
        t.decode(data)


def test_bytes_that_are_not_utf8_are_refused_with_line_and_offset() -> None:
    with pytest.raises(InputError) as caught:
        t.decode(b"NAME\r\nCOMMENT : Gr\xf6tschel\r\n")
    assert caught.value.line == 2
    assert caught.value.found == "byte 0xf6 at offset 18"


def test_a_nul_byte_is_refused_with_its_line() -> None:
    with pytest.raises(InputError, match="line 3: is not a text file"):
        t.decode(b"a\nb\n\0")


def test_a_byte_order_mark_is_dropped_and_line_ends_are_one() -> None:
    assert t.decode(b"\xef\xbb\xbfa\r\nb\rc\n") == "a\nb\nc\n"


def test_lines_are_counted_as_editors_count_them() -> None:
    assert t.lines_of("a\n\n b\x0cc \n\u2028\nd") == [(1, "a"), (3, "b\x0cc"), (5, "d")]


@pytest.mark.parametrize("token", ["nan", "NaN", "inf", "-inf", "1_000", "٣", "1e999", "0x10", "1,5", "--1", "1e", "", "½", "True"])
def test_what_python_takes_for_a_number_but_a_file_does_not_mean_is_none(token: str) -> None:
    assert not t.is_number(token)
    with pytest.raises(InputError, match="line 7"):
        t.number(token, 7, "demand")


def test_the_first_bad_token_of_a_line_is_shown() -> None:
    with pytest.raises(InputError) as caught:
        t.numbers("1 2.5 nan inf", 4, "table")
    assert (caught.value.line, caught.value.found) == (4, "'nan'")


@pytest.mark.parametrize(("token", "value"), [("5", 5), ("+5", 5), ("5.0", 5), (" 12 ", 12)])
def test_whole_numbers_are_read(token: str, value: int) -> None:
    assert t.whole(token, 1, "count", least=1) == value


@pytest.mark.parametrize("token", ["0", "-3", "2.5", "1e3", "9" * 5000, "", "5.", "five"])
def test_what_is_no_positive_whole_number_is_refused(token: str) -> None:
    with pytest.raises(InputError, match="whole number; expected 1 or more"):
        t.whole(token, 1, "count", least=1)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_plain_text_of_a_number_reads_back_to_the_bit(value: float) -> None:
    assert t.is_number(t.plain(value))
    assert float(t.plain(value)).hex() == value.hex()


@given(st.text())
def test_a_label_is_printable_and_on_one_line(text: str) -> None:
    made = t.label(text)
    assert made and made.isprintable() and len(made) <= 200
    assert t.label(made) == made


@given(st.text(max_size=200))
def test_what_is_shown_of_a_token_is_short(text: str) -> None:
    assert "\n" not in t.shown(text)
    assert len(t.shown(text)) <= 4 * 50 * 3


@pytest.mark.parametrize(
    ("article", "nouns"),
    [
        ("an", ("assignment", "exploration-map", "orchard-jobs", "optimal", "item", "uncertain-path", "unintended", "mdvrp", "lp")),
        ("a", ("routing", "tsp", "cvrp", "vrptw", "uniform", "unit", "user", "utility", "European", "one-way", "bin", "'bin'", ".lp")),
    ],
)
def test_articles_are_as_words_and_letters_are_spoken(article: str, nouns: tuple[str, ...]) -> None:
    for noun in nouns:
        assert t.an(noun) == f"{article} {noun}"
