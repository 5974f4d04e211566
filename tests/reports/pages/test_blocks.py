import re

import numpy as np
import pandas as pd
import pytest

from waybound.formulations.rendering import Line
from waybound.instances.errors import UsageError
from waybound.reports.pages import blocks
from waybound.reports.pages.blocks import Animation, Code, DataTable, Facts, Figure, Folded, Picture, Section, Text
from waybound.reports.pages.rendering import Rendering
from waybound.reports.plots.drawing import axes_without_display, png_of
from waybound.reports.tables.table import Column, Table

HOSTILE = "<script>alert('1')</script>\"&\x1b[31m"


def html_of(block: blocks.Block) -> str:
    return str(block.html(Rendering()))


def png() -> bytes:
    return png_of(axes_without_display().figure, 20)


def test_text_has_paragraphs_and_lists() -> None:
    made = html_of(Text("One\nline.\n\n- first\n- second"))
    assert "<p>One line.</p>" in made and "<li>first</li><li>second</li>" in made


@pytest.mark.parametrize(
    "block",
    [
        Text(HOSTILE), Text(f"- {HOSTILE}"), Code(HOSTILE), Facts([(HOSTILE, HOSTILE), Line(HOSTILE, HOSTILE, "good")], HOSTILE),
        DataTable(Table(HOSTILE, (Column(HOSTILE),), ((HOSTILE,),), total=(HOSTILE,)), note=HOSTILE),
        DataTable(pd.DataFrame({HOSTILE: [HOSTILE, "b"]}), title=HOSTILE), Picture(png(), HOSTILE, HOSTILE),
        Animation([png(), png()], HOSTILE, HOSTILE, captions=[HOSTILE, "b"]), Section(HOSTILE, [Text(HOSTILE)]),
        Folded(HOSTILE, [Text(HOSTILE)]),
    ],
    ids=lambda block: type(block).__name__,
)  # fmt: skip
def test_hostile_text_is_escaped(block: blocks.Block) -> None:
    made = html_of(block)
    assert "<script" not in made and "\x1b" not in made
    assert "&lt;script&gt;" in made
    assert not re.search(r'="[^"]*alert\(\'', made)


def test_hostile_text_in_a_figure_is_escaped() -> None:
    ax = axes_without_display()
    ax.set_title(HOSTILE.replace("\x1b", ""))
    made = html_of(Figure(ax, HOSTILE, HOSTILE))
    assert "<script" not in made and "&lt;script&gt;" in made


def test_text_of_a_figure_is_none_of_its_colours_and_ids() -> None:
    ax = axes_without_display()
    ax.set_title('fill: #ff0000 id="x" href="#y"')
    assert 'fill: #ff0000 id="x" href="#y"<' in html_of(Figure(ax, "x"))


def test_table_of_a_frame() -> None:
    frame = pd.DataFrame({"name": ["a", None], "value": [-2.5e-7, np.nan], "count": [3, 12345678]})
    made = html_of(DataTable(frame))
    assert '<td class="n">-2.5e-07</td><td class="n">3</td>' in made
    assert '<td></td><td class="n"></td><td class="n">12345678</td>' in made
    assert made.count("<button") == 3


def test_index_with_a_name_is_shown() -> None:
    frame = pd.DataFrame({"share": [0.5]}, index=pd.Index(["x"], name="method"))
    assert '<th scope="col">method</th>' in html_of(DataTable(frame))


def test_rows_beyond_the_most_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blocks, "MOST_ROWS", 3)
    table = Table("", (Column("n", right=True),), tuple((str(k),) for k in range(1003)))
    for data in (table, pd.DataFrame({"n": range(1003)})):
        made = html_of(DataTable(data))
        assert made.count("<td") == 3 and "and 1,000 more rows" in made


def test_table_without_headings_does_not_sort() -> None:
    made = html_of(DataTable(Table("", (Column(""), Column("")), (("a", "b"), ("c", "d")))))
    assert "<button" not in made and "<thead" not in made


def test_unknown_pictures_are_refused() -> None:
    with pytest.raises(UsageError, match="PNG, GIF, JPEG or WebP"):
        html_of(Picture(b"<svg onload='alert(1)'/>", "x"))


def test_animation_needs_pictures_and_a_caption_each() -> None:
    for frames, captions in (([], ()), ([b"", b""], ("one",))):
        with pytest.raises(UsageError, match="as many captions as pictures"):
            Animation(frames, "x", captions=captions)
