"""Pages are looked at by a browser, and what they write to its console is told."""

import shutil
from pathlib import Path

import pytest
import screenshots

PAGE = "<!doctype html><title>t</title><link rel=icon href='data:,'><p>hello</p><script>{}</script>"


@pytest.mark.slow
@pytest.mark.skipif(not any(map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), reason="no Chromium is installed")
@pytest.mark.parametrize(("script", "said"), [("", 0), ("console.error('out of order')", 1), ("missing()", 1)])
def test_a_browser_tells_what_a_page_writes_to_its_console(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, script: str, said: int
) -> None:
    (tmp_path / "site").mkdir()
    (tmp_path / "site" / "index.html").write_text(PAGE.format(script))
    monkeypatch.setattr(screenshots, "LOOKS", {"desk-dark": screenshots.LOOKS["desk-dark"]})
    assert screenshots.main([str(tmp_path / "site"), str(tmp_path / "seen"), ""]) == said
    assert (tmp_path / "seen" / "home-desk-dark.png").read_bytes().startswith(b"\x89PNG")
    assert ("home: " in capsys.readouterr().err) == bool(said)


def test_without_a_browser_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(screenshots.shutil, "which", lambda name: None)
    with pytest.raises(FileNotFoundError, match="apt-get install chromium"):
        screenshots.browser()
