"""Pictures of pages for the documentation."""

import shutil
from pathlib import Path

import page_pictures
import pytest
import screenshots
from matplotlib.image import imread

from waybound.reports.pages.blocks import Section, Text
from waybound.reports.pages.page import Page


@pytest.mark.slow
def test_a_page_is_shown_on_a_desk_and_on_a_phone_in_the_dark(tmp_path: Path) -> None:
    pytest.importorskip("selenium", reason="selenium is not installed")
    try:
        shown = page_pictures.Browser()
    except FileNotFoundError as fault:
        pytest.skip(str(fault))
    Page("A page", "", [Section("Words", [Text("words")])]).write(tmp_path / "a.html")
    page_pictures.side_by_side(shown, tmp_path / "a.html", tmp_path / "a.png")
    shown.close()
    made = imread(tmp_path / "a.png")[:, :, :3]
    (wide, high), (narrow, _), gutter = page_pictures.DESK, page_pictures.PHONE, page_pictures.GUTTER
    assert made.shape == (high, wide + gutter + narrow, 3)
    assert made[-1, 0].mean() == 1.0 and made[-1, -1].mean() < 0.2


def test_without_chromium_s_driver_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("selenium", reason="selenium is not installed")
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(FileNotFoundError, match="apt-get install chromium"):
        page_pictures.Browser()
    assert page_pictures.browser is screenshots.browser
