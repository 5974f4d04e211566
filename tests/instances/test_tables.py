from pathlib import Path

import pytest

from waybound.instances.formats import FORMATS
from waybound.instances.tables import TABLES, with_tables

PAGE = Path(__file__).resolve().parents[2] / "docs" / "formats.md"


@pytest.mark.skipif(not PAGE.exists(), reason="the documentation lies in the repository alone")
def test_the_page_holds_the_tables_of_today() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert all(f"<!-- table {name} -->" in text for name in TABLES)
    assert with_tables(text) == text, "run python -m waybound.instances.tables"


def test_every_format_has_its_row() -> None:
    table = TABLES["formats"]()
    assert all(f"| `{name}` |" in table for name in FORMATS)


def test_no_table_breaks_its_lines() -> None:
    for make in TABLES.values():
        lines = make().split("\n")
        assert len({line.count("|") for line in lines}) == 1
