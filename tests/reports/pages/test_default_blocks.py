import pytest

import waybound as wb
from waybound.reports.pages.blocks import DataTable, Figure, Folded
from waybound.reports.pages.default_blocks import SHOWN_ROWS, charts, default_blocks
from waybound.reports.plots import PLOTS


@pytest.mark.parametrize("name", ["figure-3-3", "sata-s3", "cover-30"])
def test_a_family_without_blocks_of_its_own_has_its_pictures_and_its_table(name: str) -> None:
    blocks = default_blocks(wb.solve(wb.read(name), "highs", bound_time=0))
    assert isinstance(blocks[0], Figure) and isinstance(blocks[-1], DataTable)


def test_all_views_but_the_history_are_shown() -> None:
    solution = wb.solve(wb.read("demo-tiny"), heuristic="savings", bound_time=0)
    assert [title for title, _ in charts(solution, ["", "schedule", "loads", "history"])] == ["Picture", "Schedule", "Loads"]


def test_answers_that_cannot_be_drawn_have_their_table_and_long_ones_are_folded(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = wb.generate("assignment", seed=1, robots=SHOWN_ROWS + 1, bins=SHOWN_ROWS + 1)
    solution = wb.solve(problem, time_limit=5, bound_time=0)
    monkeypatch.setattr(PLOTS, "_entries", {})
    (table,) = default_blocks(solution)
    assert isinstance(table, Folded) and table.title == f"Answer ({SHOWN_ROWS + 1} rows)"
