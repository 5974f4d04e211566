import importlib.util
from typing import Any

import pandas as pd
import pytest

import waybound as wb
from waybound.reports.pages.routing import streets

HOSTILE = "`${alert(1)}</script><script>alert(2)</script>"


@pytest.fixture(scope="module")
def solution() -> wb.Solution:
    shops = pd.DataFrame({
        "name": ["hub", HOSTILE, "Bakery"], "lat": [45.81, 45.83, 45.79], "lon": [15.98, 15.93, 16.02], "demand": [0, 4, 2],
    })  # fmt: skip
    return wb.solve(wb.RoutingProblem.from_frame(shops, vehicles=2, capacity=10, speed=30), heuristic="savings", bound_time=0)


def test_sites_and_routes_are_on_it_and_names_are_no_code(solution: wb.Solution) -> None:
    pytest.importorskip("folium", reason="folium is not installed")
    made = solution.to_folium()
    text = made.get_root().render()
    assert made.get_bounds() == [[45.79, 15.93], [45.83, 16.02]]
    assert "45.83" in text and "Bakery" in text and "vehicle 1" in text
    assert "alert(2)</script>" not in text and "${alert" not in text and "`$" not in text


def test_without_folium_it_says_what_to_install(solution: wb.Solution, monkeypatch: pytest.MonkeyPatch) -> None:
    found = importlib.util.find_spec
    monkeypatch.setattr(streets, "find_spec", lambda name: None if name == "folium" else found(name))
    with pytest.raises(wb.MissingPackageError, match=r"pip install 'waybound\[maps\]'"):
        solution.to_folium()


@pytest.mark.parametrize(("name", "says"), [("demo-tiny", "latitude and longitude"), ("cover-30", "no map of streets")])
def test_what_has_no_place_on_streets_is_refused(name: str, says: str) -> None:
    heuristic: dict[str, Any] = {"heuristic": "savings" if name == "demo-tiny" else "greedy"}
    with pytest.raises(wb.UsageError, match=says):
        wb.solve(wb.read(name), bound_time=0, **heuristic).to_folium()
