import re

import pytest

from waybound.reports.pages.blocks import Figure
from waybound.reports.pages.figures import DARK_GROUND, LEAST_CONTRAST, dark_colour
from waybound.reports.pages.rendering import Rendering
from waybound.reports.plots.drawing import COLOURS, axes_without_display


def drawn() -> Figure:
    ax = axes_without_display()
    for k in range(2):
        ax.plot([0, 1], [0, k], color=f"#{k * 5:02x}10f0")
    ax.set_title("title")
    return Figure(ax, "lines")


def test_ids_are_unique_and_every_reference_is_met() -> None:
    text = str(Rendering().blocks([drawn(), drawn()]))
    ids = re.findall(r'\bid="([^"]+)"', text)
    assert len(ids) > 10 and len(set(ids)) == len(ids)
    assert set(re.findall(r'(?:href="#|url\(#)([^")]+)', text)) <= set(ids)


def test_text_stays_text_and_the_same_figure_is_the_same_text() -> None:
    texts = [str(drawn().html(Rendering())) for _ in range(2)]
    assert ">title</text>" in texts[0] and texts[0] == texts[1]
    assert "<metadata" not in texts[0] and "<?xml" not in texts[0] and "<!DOCTYPE" not in texts[0]


def test_colours_turn_with_the_ground_unless_they_stand_for_numbers() -> None:
    plain, scale = Rendering(), Rendering()
    assert "var(--c0010f0)" in str(drawn().html(plain)) and "0010f0" in plain.colours
    ax = axes_without_display()
    ax.scatter([0, 1], [0, 1], c=[0.0, 1.0])
    made = str(Figure(ax, "numbers").html(scale))
    assert "var(--c" not in made and 'class="drawing white"' in made and not scale.colours


@pytest.mark.parametrize("colour", [*(colour[1:].lower() for colour in COLOURS), "000000", "222222", "b42318", "0000ff"])
def test_dark_colours_can_be_told_from_the_ground(colour: str) -> None:
    rgb = [int(dark_colour(colour)[k : k + 2], 16) / 255.0 for k in (0, 2, 4)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in rgb]
    luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    assert (luminance + 0.05) / (DARK_GROUND + 0.05) >= 0.98 * LEAST_CONTRAST


def test_white_becomes_dark() -> None:
    assert dark_colour("ffffff") == "1c1c1c"
