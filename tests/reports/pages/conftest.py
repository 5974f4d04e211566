"""A headless Chromium that pages are looked at in."""

from collections.abc import Iterator

import pytest
from page_pictures import Browser


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    pytest.importorskip("selenium", reason="selenium is not installed: pages are not looked at in Chromium")
    try:
        opened = Browser()
    except FileNotFoundError as fault:
        pytest.skip(f"{fault}: pages are not looked at")
    yield opened
    opened.close()
