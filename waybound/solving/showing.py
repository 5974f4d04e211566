"""Where the log of ``solve`` goes: nowhere, to a file, to standard error, or into the cell of a notebook."""

from __future__ import annotations

import contextlib
import html
import sys
import time
from collections.abc import Iterator
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from ..instances.errors import InputError, UsageError, in_words
from .search_log import SearchLog

Log = bool | str | PathLike[str] | SearchLog | None

REFRESH = 0.25
"""Least seconds between two pictures of a log in a notebook."""


@contextlib.contextmanager
def shown(log: Log) -> Iterator[SearchLog | None]:
    """The log that ``log`` asks for, open while a search runs.

    Parameters
    ----------
    log : bool, path, SearchLog or None
        True shows it: in the cell of a notebook, else on standard error. A path is a file, ``-`` standard error. A ``SearchLog`` is used
        as it is.

    Raises
    ------
    InputError
        If the file cannot be written.
    UsageError
        For anything else.
    """
    if log is None or log is False:
        yield None
    elif isinstance(log, SearchLog):
        yield log
    elif log is True and in_notebook():
        cell = _Cell()
        with SearchLog(cell.write) as made:
            try:
                yield made
            finally:
                cell.show()
    elif log is True or log == "-":
        with SearchLog(lambda line: print(line, file=sys.stderr, flush=True)) as made:
            yield made
    elif isinstance(log, str | PathLike):
        try:
            stream = Path(log).open("w", encoding="utf-8", buffering=1)  # noqa: SIM115 - closed below
        except OSError as fault:
            raise InputError(f"the log cannot be written: {in_words(fault)}").at(file=fspath(log)) from fault
        with stream, SearchLog(lambda line: print(line, file=stream)) as made:
            yield made
    else:
        raise UsageError(f"log is True, the name of a file, or a SearchLog, not {type(log).__name__}")


def in_notebook() -> bool:
    """Whether this runs in the kernel of a notebook; imports nothing."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return shell is not None and "ipykernel" in sys.modules


class _Cell:
    """The output of a cell: the lines so far, shown anew now and then, so that what stays is the log as a whole."""

    def __init__(self) -> None:
        from importlib import import_module

        display: Any = import_module("IPython.display").display  # there is none without a notebook
        self._lines: list[str] = []
        self._drawn = 0.0
        self._handle: Any = display(self._page(), raw=True, display_id=True)

    def write(self, line: str) -> None:
        self._lines.append(line)
        if time.perf_counter() - self._drawn >= REFRESH:
            self.show()

    def show(self) -> None:
        self._drawn = time.perf_counter()
        self._handle.update(self._page(), raw=True)

    def _page(self) -> dict[str, str]:
        text = "\n".join(self._lines)
        return {
            "text/plain": text,
            "text/html": f'<pre style="font-family:monospace;font-size:85%;line-height:1.3">{html.escape(text)}</pre>',
        }
