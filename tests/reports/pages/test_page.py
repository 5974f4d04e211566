import base64
import hashlib
import re
from pathlib import Path

import pandas as pd
import pytest

from waybound.instances.errors import InputError
from waybound.reports.pages.blocks import DataTable, Text
from waybound.reports.pages.page import Page
from waybound.reports.pages.rendering import asset

PAGE = Page("A title", "A lead", [Text("words"), DataTable(pd.DataFrame({"n": [2, 1]}))])


def test_page_is_one_file_without_addresses(tmp_path: Path) -> None:
    PAGE.write(tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert text.startswith("<!doctype html>") and "<title>A title</title>" in text
    assert not re.findall(r"""(?:src|href)=["'](?!data:|#)""", text) and "@import" not in text and "http:" not in text


def test_only_the_page_s_own_script_may_run() -> None:
    text = PAGE.html()
    script = re.search(r"<script>(.*)</script>", text, re.DOTALL)
    assert script is not None and "table.sorts" in script[1]
    digest = base64.b64encode(hashlib.sha256(script[1].encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}'" in text and "default-src 'none'" in text


def test_same_page_is_the_same_text() -> None:
    assert PAGE.html() == PAGE.html()


@pytest.mark.parametrize("path", ["", "missing/page.html"])
def test_page_that_cannot_be_written_leaves_nothing(tmp_path: Path, path: str) -> None:
    with pytest.raises(InputError):
        PAGE.write(tmp_path / path)
    assert not list(tmp_path.iterdir())


def test_texts_stand_out_from_the_ground_in_light_and_dark() -> None:
    """By the ratio of 4.5 that the Web Content Accessibility Guidelines (2.2, criterion 1.4.3) ask for."""
    light, dark = re.findall(r":root \{([^}]*)\}", asset("page.css"))

    def luminance(colour: str) -> float:
        parts = [int(colour[k : k + 2], 16) / 255.0 for k in (0, 2, 4)]
        red, green, blue = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts)
        return 0.2126 * red + 0.7152 * green + 0.0722 * blue

    for scheme in (light, dark):
        value = {name: luminance(colour) for name, colour in re.findall(r"--(\w+): #(\w{6})", scheme)}
        for text in ("ink", "quiet", "accent", "good", "bad"):
            for ground in ("paper", "shade"):
                low, high = sorted((value[text], value[ground]))
                assert (high + 0.05) / (low + 0.05) >= 4.5, (text, ground)


def test_title_is_escaped() -> None:
    text = Page("</title><script>x", "</p><script>y", []).html()
    assert text.count("<script>") == 1 and "&lt;/title&gt;&lt;script&gt;x" in text
