from waybound.formulations.rendering import Line, as_html, as_text, number, percent


def test_numbers_are_short_and_absent_ones_are_a_dash():
    assert number(191.3) == "191.3"
    assert number([3.0, 191.30000000000001]) == "3 then 191.3"
    assert number(None) == percent(None) == "-"
    assert percent(0.0) == "0 %"
    assert percent(0.0123) == "1.23 %"


def test_html_is_escaped():
    assert "<script>" not in as_html("<script>", [Line("<script>", "a < b & c")])
    assert "a &lt; b &amp; c" in as_html("t", [Line("x", "a < b & c")])


def test_plain_text_keeps_labels_in_a_column():
    assert as_text("title", [Line("a", "1"), Line("long", "2")]) == "title\na     1\nlong  2"


def test_labels_and_texts_are_printable_and_no_longer_than_people_read():
    line = Line("a\x1b[2J" * 900, "b\n" * 50000)
    assert line.label.isprintable() and line.text.isprintable()
    assert len(line.label) <= 80 and len(line.text) <= 2000


def test_no_number_is_minus_nothing() -> None:
    assert number(-0.0) == "0" and number([-0.0, 1.5]) == "0 then 1.5"
