"""Answers as tables in files: CSV, and workbooks of Excel and others."""

from __future__ import annotations

import io
from collections.abc import Mapping
from importlib.util import find_spec
from os import PathLike
from typing import TYPE_CHECKING

from ..instances.errors import InputError, MissingPackageError, in_words

if TYPE_CHECKING:
    import pandas as pd

VISITS = frozenset({"vehicle", "site"})
"""Titles by which a table of visits is recognised."""


def is_table(text: str) -> bool:
    """Whether a text is a CSV of visits."""
    first = next((line for line in text.split("\n") if line.strip()), "")
    return {title.strip().strip('"').casefold() for title in first.replace(";", ",").split(",")} >= VISITS


def frame_of(text: str) -> pd.DataFrame:
    """The table in a CSV, all cells as text; raises InputError where it is none."""
    import pandas as pd

    try:
        frame = pd.read_csv(io.StringIO(text), sep=None, engine="python", dtype=str, skipinitialspace=True)
    except (ValueError, pd.errors.ParserError) as error:
        raise InputError(f"is no CSV: {in_words(error)}") from None
    return _ordered(frame)


def _ordered(frame: pd.DataFrame) -> pd.DataFrame:
    """The frame with positions as numbers, since text sorts 10 before 2; without positions, the order of rows counts."""
    import pandas as pd

    frame.columns = [str(title).strip() for title in frame.columns]
    if "position" in frame.columns:
        try:
            frame["position"] = pd.to_numeric(frame["position"])
        except (ValueError, TypeError):
            raise InputError("column position must hold numbers", expected="1, 2, ... along each route") from None
        return frame
    return frame.assign(position=range(1, len(frame) + 1))


def _need_openpyxl() -> None:
    if find_spec("openpyxl") is None:
        raise MissingPackageError("files of .xlsx need the package openpyxl: pip install openpyxl")


def first_sheet(path: str | PathLike[str], data: bytes) -> pd.DataFrame:
    """The sheet ``visits`` of a workbook, or its first one."""
    import pandas as pd

    _need_openpyxl()
    try:
        sheets = pd.read_excel(io.BytesIO(data), sheet_name=None, dtype=str, keep_default_na=False, na_values=[""], engine="openpyxl")
    except Exception as error:  # a broken archive fails in many ways
        raise InputError(f"is no workbook: {in_words(error)}", file=path) from None
    sheet = sheets.get("visits", next(iter(sheets.values()), None))
    if sheet is None:
        raise InputError("holds no sheet", "missing", file=path)
    try:
        return _ordered(sheet)
    except InputError as error:
        raise error.at(file=path) from None


def workbook(sheets: Mapping[str, pd.DataFrame]) -> bytes:
    """A workbook with one sheet a table; moments lose their time zone, which cells cannot hold.

    Texts that begin with ``=`` stay texts.
    """
    import pandas as pd

    _need_openpyxl()
    stream = io.BytesIO()
    with pd.ExcelWriter(stream, engine="openpyxl") as writer:
        for name, frame in sheets.items():
            cells = frame.copy()
            for title in cells.columns:
                if isinstance(cells[title].dtype, pd.DatetimeTZDtype):
                    cells[title] = cells[title].dt.tz_localize(None)
            cells.to_excel(writer, sheet_name=name[:31], index=False)
        for sheet in writer.book.worksheets:
            for row in sheet.iter_rows(min_row=2):
                for cell in row:
                    if cell.data_type == "f":
                        cell.data_type = "s"
    return stream.getvalue()
