from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from campaign_cases import hundred_instances

import waybound as wb
from waybound.reports.campaigns.counting import counted
from waybound.reports.campaigns.frames import results
from waybound.reports.campaigns.results_file import ResultsFile
from waybound.reports.pages.blocks import Animation, DataTable, Figure, Folded, Text
from waybound.reports.pages.campaigns import campaign_page
from waybound.reports.pages.page import Page
from waybound.reports.plots.drawing import axes_without_display, png_of

pytestmark = pytest.mark.slow

HOSTILE = "<img src=x onerror=alert(1)><script>alert(2)</script>" + "w" * 300


@pytest.fixture(scope="module")
def answer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("pages") / "answer.html"
    wb.solve(wb.read("demo-rc50"), heuristic="savings", bound_time=1).to_html(path)
    return path


@pytest.fixture(scope="module")
def blocks(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("pages") / "blocks.html"
    frame = pd.DataFrame({"name": ["b10", "b9", "a"], "value": [1.5, np.nan, -20.0], HOSTILE: [3, 10, 2]})
    ax = axes_without_display()
    ax.plot([1, 2])
    films = []
    for k in range(3):
        drawn = axes_without_display()
        drawn.plot(range(k + 2))
        films.append(png_of(drawn.figure, 30))
    Page(
        HOSTILE, "A lead",
        [Text(HOSTILE), DataTable(frame), Figure(ax, "a line"), Animation(films, "a film", seconds=0.05), Folded("More", [Text("within")])],
    ).write(path)  # fmt: skip
    return path


def first_column(browser: Any) -> list[str]:
    texts: list[str] = browser.run("return [...document.querySelectorAll('tbody tr')].map((row) => row.cells[0].textContent)")
    return texts


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("width", [1200, 390])
@pytest.mark.parametrize("page", ["answer", "blocks"])
def test_pages_fit_the_window_are_not_blank_and_raise_no_error(
    browser: Any, request: pytest.FixtureRequest, page: str, width: int, dark: bool
) -> None:
    browser.open(request.getfixturevalue(page), width=width, dark=dark)
    browser.run("document.querySelectorAll('details').forEach((part) => { part.open = true; })")
    assert browser.said == []
    assert browser.run("return document.documentElement.scrollWidth") <= width
    shown = browser.picture()
    assert shown.shape == (900, width, 3)
    ground = shown[-1, 2]
    assert (ground.mean() < 0.2) == dark
    assert 0.01 < (np.abs(shown - ground).max(axis=2) > 0.2).mean() < 0.8, "text and lines on empty ground"


def test_tables_sort_by_value_both_ways_and_say_so(browser: Any, blocks: Path) -> None:
    browser.open(blocks)
    names, values, counts = browser.all("th button")
    for button, upwards, downwards in (
        (names, ["a", "b9", "b10"], ["b10", "b9", "a"]), (values, ["a", "b10", "b9"], ["b10", "a", "b9"]),
        (counts, ["a", "b10", "b9"], ["b9", "b10", "a"]),
    ):  # fmt: skip
        browser.click(button)
        assert first_column(browser) == upwards
        assert [head.get_attribute("aria-sort") for head in browser.all("th[aria-sort]")] == ["ascending"]
        button.send_keys("\n")
        assert first_column(browser) == downwards
    assert browser.said == []


def test_a_route_and_a_stop_are_picked_on_the_map_in_the_list_and_by_keys(browser: Any, answer: Path) -> None:
    browser.open(answer)
    second = browser.all(".legend button")[1]
    browser.click(second)
    assert second.get_attribute("aria-pressed") == "true" and browser.all(".told h3")[0].text == second.text
    assert len(browser.all(".route.picked")) == 1 and "distance" in browser.all(".told dl")[0].text
    stop = browser.all(".told .stops button")[2]
    name = stop.text
    browser.click(stop)
    told = browser.all(".told")[0].text
    assert told.startswith(f"Site {name}, stop 3 of {second.text}") and "arrival" in told and "window" in told
    assert browser.run("return document.activeElement.textContent") == name
    browser.all("svg.routes")[0].send_keys("\ue00c")  # Escape
    assert browser.all(".route.picked") == [] and "Pick a route" in browser.all(".told")[0].text
    place = browser.run(
        "const held = JSON.parse(document.querySelector('.map script').textContent).routes[0].stops[1];"
        "const map = document.querySelector('svg.routes'), box = map.getBoundingClientRect(), k = box.width / map.viewBox.baseVal.width;"
        "return [held.id, held.at[0] * k - box.width / 2, held.at[1] * k - box.height / 2];"
    )
    from selenium.webdriver import ActionChains

    on_map = browser.all("svg.routes")[0]
    browser.run("arguments[0].scrollIntoView({block: 'center'})", on_map)
    ActionChains(browser.driver).move_to_element_with_offset(on_map, round(place[1]), round(place[2])).click().perform()
    assert browser.all(".told h3")[0].text.startswith(f"Site {place[0]}, stop 2 of")
    assert browser.said == []


def test_the_map_zooms_moves_and_returns(browser: Any, answer: Path) -> None:
    browser.open(answer)
    view = "return ['x', 'y', 'width', 'height'].map((side) => document.querySelector('svg.routes').viewBox.baseVal[side])"
    whole = browser.run(view)
    closer, farther, reset = browser.all("[data-zoom]")
    browser.click(closer)
    near = browser.run(view)
    assert near[2] == pytest.approx(whole[2] / 1.5) and near[3] == pytest.approx(whole[3] / 1.5)
    browser.all("svg.routes")[0].send_keys("\ue014")  # to the right
    assert browser.run(view)[0] > near[0]
    browser.click(reset)
    assert browser.run(view) == whole
    browser.click(farther)
    assert browser.run(view) == whole, "there is nothing around the map"


def test_certificates_unfold(browser: Any, answer: Path) -> None:
    browser.open(answer)
    (certificate,) = [part for part in browser.all("details") if part.text.startswith("Certificate")]
    assert "holds" not in certificate.text
    browser.click(certificate.find_element("css selector", "summary"))
    assert "time-windows" in certificate.text and "holds" in certificate.text


def test_animations_play_to_their_end_and_stop(browser: Any, blocks: Path) -> None:
    browser.open(blocks)
    shown = "return [...document.querySelectorAll('.animation img')].map((picture) => picture.hidden)"
    assert browser.run(shown) == [False, True, True]
    browser.click(browser.all(".player button")[0])
    ended = (
        "const done = arguments[0], button = document.querySelector('.player button');"
        "const look = () => (button.ariaLabel === 'play' ? done() : setTimeout(look, 20)); look();"
    )
    browser.driver.execute_async_script(ended)
    assert browser.run(shown) == [True, True, False]


def test_of_thousands_of_runs_the_first_are_laid_out_and_all_on_demand(browser: Any, tmp_path: Path) -> None:
    results_file = tmp_path / "r.sqlite"
    with ResultsFile(results_file) as file:
        file.add_all(hundred_instances())
    frame = counted(results(results_file))
    campaign_page(frame, results_file, name="hundred", planned=len(frame)).write(tmp_path / "page.html")
    browser.open(tmp_path / "page.html")
    browser.run("document.querySelectorAll('details').forEach((part) => { part.open = true; })")
    runs = browser.all("details table.sorts")[-1]
    assert len(runs.find_elements("css selector", "tbody tr:not([hidden])")) == 100
    browser.click(browser.all("details .more")[-1])
    assert len(runs.find_elements("css selector", "tbody tr:not([hidden])")) == 3000
    assert browser.said == []
