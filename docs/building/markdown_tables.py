"""Tables as Markdown."""

from collections.abc import Iterable, Sequence


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A pipe table, one entry a column; cells are Markdown but for bars and line ends, which would end them."""

    def line(cells: Sequence[str]) -> str:
        return "| " + " | ".join(cells) + " |"

    told = [line([_cell(c) for c in row]) for row in rows]
    return "\n".join([line([_cell(c) for c in head]), line(["---"] * len(head)), *told])


def plain(text: str, keep: str = "") -> str:
    """Text in which nothing is Markdown or HTML, but for the marks of ``keep``."""
    escaped = text.replace("&", "&amp;").replace("<", "&lt;").replace("\\", "\\\\")
    for mark in set("*_`[]") - set(keep):
        escaped = escaped.replace(mark, "\\" + mark)
    return escaped


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")
