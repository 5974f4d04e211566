"""Cards of the gallery: six lines of code, a picture small enough for a phone, a value that was checked, and a bound."""

import io
from pathlib import Path

import gallery_page
import pytest
from PIL import Image

import waybound as wb
from waybound.formulations.certificate import certify

SCRIPTS = [gallery_page.FOLDER / f"{name}.py" for name in gallery_page.ORDER]
ROOT = Path(__file__).resolve().parents[2]


def test_every_script_has_its_place() -> None:
    assert sorted(SCRIPTS) == sorted(gallery_page.FOLDER.glob("*.py"))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_a_card_is_six_lines_with_a_title_and_a_page_that_is_there(script: Path) -> None:
    one = gallery_page.card(script)
    assert 0 < len(one.lines) <= 6 and "import waybound as wb" in one.lines
    assert one.title and one.words
    page = one.words.rpartition("](../")[2].rstrip(")").partition("#")[0]
    assert (ROOT / "docs" / page).is_file()


@pytest.mark.slow
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_a_card_shows_an_answer_that_holds_and_a_small_picture(script: Path) -> None:
    solution, axes = gallery_page.run(gallery_page.card(script))
    problem = solution.problem
    assert isinstance(problem, wb.Problem) and solution.answer is not None
    assert certify(problem, problem.evaluate(solution.answer)).feasible
    assert solution.bound is not None and not solution.faults
    picture = gallery_page.thumbnail(axes)
    assert len(picture) < 60_000
    with Image.open(io.BytesIO(picture)) as image:
        assert image.size == tuple(round(inches * gallery_page.DPI) for inches in gallery_page.INCHES)
        assert len(image.convert("RGB").getcolors() or ()) > 3


def test_without_execution_the_page_has_titles_and_code_alone() -> None:
    text, pictures = gallery_page.page(executed=False)
    assert pictures == {} and "value" not in text.split("</div>")[0].split("cards gallery")[1] and "time_windows.png" not in text
    assert text.count("```python") == len(SCRIPTS) == text.count("-   **")


def test_a_script_without_a_picture_is_refused() -> None:
    with pytest.raises(ValueError, match="empty does not end with a picture"):
        gallery_page.run(gallery_page.Card("empty", "", "", "solution = None"))
