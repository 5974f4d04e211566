"""Standard output: tables and lines for people, one JSON object for machines; nothing a solver prints gets in between."""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import sys
import threading
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from ..instances.errors import InputError, in_words

if TYPE_CHECKING:
    from ..formulations.rendering import Line
    from ..reports.tables.table import Table

PIPE_WIDTH = 120
"""Columns of a table that is not written to a terminal."""

begun = False
"""True once the command that runs has put something on standard output."""


def _console() -> Any:
    from rich.console import Console

    known = sys.stdout.isatty() or "COLUMNS" in os.environ
    return Console(file=sys.stdout, width=None if known else PIPE_WIDTH, highlight=False, markup=False, emoji=False)


def write_out(text: str) -> None:
    """Put ``text`` on standard output; raises InputError where it cannot be written."""
    global begun
    begun = True
    try:
        try:
            sys.stdout.write(text)
        except UnicodeEncodeError:
            sys.stdout.write(re.sub(r"[^\x00-\x7f]", lambda character: json.dumps(character[0])[1:-1], text))
        sys.stdout.flush()
    except (OSError, ValueError) as fault:  # a full disk, a reader that left; a closed stream
        raise unprinted(fault) from fault


def unprinted(fault: Exception) -> InputError:
    """The error for a standard output that fails; it is given up."""
    silence(sys.stdout)
    return InputError(f"standard output cannot be written to: {in_words(fault)}", "file")


def silence(stream: Any) -> None:
    """Let what is left for a stream that fails go nowhere, for Python flushes it once more at its end."""
    with contextlib.suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


def print_json(data: Any) -> None:
    """The one object that ``--json`` promises."""
    from ..formulations.json_text import json_text

    write_out(json_text(data))


def table_text(table: Table, every: bool = False) -> str:
    """A table, its title above it; ``every`` row where it says itself how many come first."""
    from ..reports.tables.table import SHOWN_ROWS, table_rich

    shown = SHOWN_ROWS if table.most is None else len(table.rows) if every else table.most
    more, where = len(table.rows) - shown, "--json has all" if table.most is None else "-v shows all"
    return _rendered(table_rich(table, shown)) + (f"and {more:,} {table.rest}; {where}\n" if more > 0 else "")


def table_fits(table: Table) -> bool:
    """Whether the numbers of a table can stand side by side, and a few letters of its texts."""
    longest = [max(len(column.name), *(len(row[k]) for row in table.rows), 1) for k, column in enumerate(table.columns)]
    least = [size if column.right else min(size, 10) for size, column in zip(longest, table.columns, strict=True)]
    width: int = _console().width
    return sum(least) + 2 * len(least) <= width


def lines_text(title: str, lines: Sequence[Line]) -> str:
    """A certificate or the like."""
    from ..formulations.rendering import as_rich

    return _rendered(as_rich(title, lines))


def print_table(table: Table, every: bool = False) -> None:
    """Put a table on standard output."""
    write_out(table_text(table, every))


def print_lines(title: str, lines: Sequence[Line]) -> None:
    """Put facts under a title on standard output."""
    write_out(lines_text(title, lines))


def print_text(text: str = "") -> None:
    """Print a line of text."""
    from ..instances.printable import printable

    write_out(printable(text) + "\n")


def _rendered(thing: Any, **options: Any) -> str:
    from rich.console import Console

    shown, held = _console(), _Held()
    Console(
        file=held, width=shown.width, force_terminal=shown.is_terminal, color_system=shown.color_system, highlight=False, markup=False,
        emoji=False, legacy_windows=False,
    ).print(thing, **options)  # fmt: skip
    return held.getvalue()


class _Held(io.StringIO):
    """Text meant for standard output: its encoding decides which lines a table is drawn with."""

    encoding = property(lambda _: sys.stdout.encoding)


UNASKED = (b"HighsMipSolverData::",)
"""Beginnings of the lines that a library prints whatever its options say."""


@contextlib.contextmanager
def stdout_is_ours() -> Iterator[None]:
    """Send to standard error whatever native code writes to file descriptor 1 meanwhile, but for lines that nobody asked for."""
    try:
        sys.stdout.flush()
        kept = os.dup(1)
    except (OSError, ValueError):  # closed, or no real file
        yield
        return
    ours, theirs = os.pipe()
    reader = threading.Thread(target=_pass_on, args=(ours,), daemon=True, name="native-output")
    reader.start()
    try:
        os.dup2(theirs, 1)
        yield
    finally:
        _flush_native()
        os.dup2(kept, 1)
        os.close(kept)
        os.write(theirs, _END)  # a child that was left behind may hold the pipe open
        os.close(theirs)
        reader.join()


_END = b"\0\n"


def _pass_on(source: int) -> None:
    with open(source, "rb") as lines:
        for line in lines:
            text = line.removesuffix(_END)
            if text and not text.startswith(UNASKED):
                with contextlib.suppress(OSError):
                    os.write(2, text)
            if text != line:
                return


def _flush_native() -> None:
    """Flush the buffers of C libraries, which would come out at the end of the process otherwise, behind what is ours."""
    import ctypes

    with contextlib.suppress(OSError, AttributeError, TypeError):
        ctypes.CDLL(None).fflush(None)
