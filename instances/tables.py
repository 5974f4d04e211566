"""Tables for the documentation, made from the registries: ``python -m waybound.instances.tables`` puts them into docs/formats.md."""

from collections.abc import Sequence
from pathlib import Path

from .atomic import atomic_write
from .bundled import RECIPES
from .formats import FORMATS
from .generators import GENERATORS

Row = tuple[str, ...]


def _markdown(titles: Row, rows: Sequence[Row]) -> str:
    return "\n".join("| " + " | ".join(row) + " |" for row in (titles, ("---",) * len(titles), *rows))


def _code(names: tuple[str, ...]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def formats_table() -> str:
    """Format, default problem, problems allowed, default convention, sense, answer, solution files."""
    rows = [
        (f"`{f.name}`", f.summary, f"`{f.problem}`" if f.problem else "as the file says", _code(f.problems) or "as the file says",
         f"`{f.convention}`", f.sense, f.answer, _code(f.solutions), _code(f.suffixes) if f.write else "-")
        for f in FORMATS.values()
    ]  # fmt: skip
    titles = (
        "format",
        "what it is",
        "default problem",
        "problems allowed",
        "convention",
        "sense",
        "answer",
        "solution files",
        "written as",
    )
    return _markdown(titles, rows)


def generators_table() -> str:
    """Every setting of every generator."""
    rows: list[Row] = []
    for recipe in GENERATORS.values():
        for name, setting in recipe.settings.items():
            default = "-" if setting.default is None else f"`{setting.default}`"
            help_text = setting.help + (f" ({_code(setting.choices)})" if setting.choices else "")
            rows.append((f"`{recipe.name}`", f"`{name}`", default, help_text))
    return _markdown(("generator", "setting", "default", "meaning"), rows)


def bundled_table() -> str:
    """Every bundled instance, and the command that makes it or where it comes from."""
    rows = [(f"`{name}`", recipe.source or f"`{recipe.command(name)}`") for name, recipe in RECIPES.items()]
    return _markdown(("name", "made by"), rows)


TABLES = {"formats": formats_table, "generators": generators_table, "bundled": bundled_table}


def with_tables(text: str) -> str:
    """``text`` with what stands between ``<!-- table NAME -->`` and ``<!-- end -->`` made anew."""
    for name, make in TABLES.items():
        start, end = f"<!-- table {name} -->\n", "\n<!-- end -->"
        head, _, rest = text.partition(start)
        _, _, tail = rest.partition(end)
        text = head + start + make() + end + tail
    return text


if __name__ == "__main__":  # pragma: no cover
    page = Path(__file__).resolve().parent.parent / "docs" / "formats.md"
    atomic_write(page, with_tables(page.read_text(encoding="utf-8")))
