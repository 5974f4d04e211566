"""Tables of texts."""

from __future__ import annotations

from waybound.reports.tables.table import Column, Table, short


def test_every_entry_is_printable_and_only_wide_columns_are_long():
    table = Table("a\x1b[2Jb", (Column("site"), Column("reason", wide=True)), (("x\ny" + "z" * 900, "\u202ew" * 900),), ("\x07", ""))
    shown = [table.title, *table.rows[0], *table.total]
    assert all(text.isprintable() for text in shown)
    assert len(table.rows[0][0]) == 200 and len(table.rows[0][1]) == 1800


def test_quantities_have_at_most_three_decimals():
    assert [short(v) for v in (2.0, 1.23456, 1e12)] == ["2", "1.235", "1e+12"]
