"""Facts for people: the same lines as plain text, as HTML for notebooks, and as a rich table."""

import html
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..instances.printable import printable
from .tolerance import EQUAL

SHOWN_LABEL = 80
"""Characters of a label that are shown."""

_STYLES = {"good": "green", "bad": "bold red", "quiet": "dim", "plain": ""}
_COLOURS = {"good": "#1a7f37", "bad": "#b42318", "quiet": "#6e7781", "plain": "inherit"}


@dataclass(frozen=True)
class Line:
    """One fact: what it is, what holds, and its tone (``good, bad, quiet, plain``). Its texts are printable, wherever they come from."""

    label: str
    text: str
    tone: str = "plain"

    def __post_init__(self) -> None:
        object.__setattr__(self, "label", printable(self.label, SHOWN_LABEL))
        object.__setattr__(self, "text", printable(self.text))


def number(value: Any) -> str:
    """A value as people read it: ten significant digits, levels of priority joined by "then", "-" where there is none."""
    if value is None:
        return "-"
    if isinstance(value, list | tuple):
        return " then ".join(number(v) for v in value)
    return f"{float(value) + 0.0:.10g}"  # -0.0 is 0


def percent(gap: float | None) -> str:
    """A relative gap as a percentage."""
    if gap is None:
        return "-"
    return "0 %" if gap <= EQUAL else f"{100.0 * gap:.3g} %"


def as_text(title: str, lines: Sequence[Line]) -> str:
    """Plain text, labels in a column of their own."""
    width = max((len(line.label) for line in lines), default=0)
    return "\n".join([printable(title), *(f"{line.label:<{width}}  {line.text}".rstrip() for line in lines)])


def as_html(title: str, lines: Sequence[Line]) -> str:
    """An HTML table."""
    cell = "text-align:left;padding:1px 10px 1px 0;vertical-align:top"
    rows = "".join(
        f'<tr><th style="{cell};font-weight:normal;white-space:pre">{html.escape(line.label)}</th>'
        f'<td style="{cell};color:{_COLOURS[line.tone]}">{html.escape(line.text)}</td></tr>'
        for line in lines
    )
    return (
        f'<table style="border-collapse:collapse"><caption style="text-align:left">{html.escape(printable(title))}</caption>{rows}</table>'
    )


def as_rich(title: str, lines: Sequence[Line]) -> Any:
    """A ``rich`` renderable."""
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    grid = Table.grid(padding=(0, 2))
    grid.add_column(no_wrap=True)
    grid.add_column(overflow="fold")
    for line in lines:
        grid.add_row(Text(line.label, style="red" if line.label.strip() == "!" else "bold cyan"), Text(line.text, style=_STYLES[line.tone]))
    return Group(Text(printable(title), style="bold"), grid)
