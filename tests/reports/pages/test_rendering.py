import pytest

from waybound.reports.pages.rendering import Rendering


def test_names_occur_once() -> None:
    made = Rendering()
    assert len({made.name("f") for _ in range(5)}) == 5


def test_templates_escape_and_lack_nothing() -> None:
    from jinja2 import UndefinedError

    assert "&lt;b&gt;" in Rendering().template("code.html", lines=["<b>"])
    with pytest.raises(UndefinedError):
        Rendering().template("code.html")
