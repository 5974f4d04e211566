"""File formats and generators, from what is registered."""

from markdown_tables import markdown_table, plain

from waybound.instances.formats import FORMATS, Format
from waybound.instances.generators import GENERATORS

TEXT = """# Formats at a glance

Made from what is registered; [each format in full](../formats.md). A format is recognised from a file's content, and can be forced with
`--format`. `waybound convert` writes one as another, and refuses by name what the other has no place for.

{formats}

## Generators

`waybound generate NAME --seed 1 --set KEY=VALUE`, or `wb.generate("NAME", seed=1, key=value)`; the same seed gives the same instance
on every machine.

{generators}
"""


def page() -> str:
    """The whole page."""
    formats = markdown_table(
        ("format", "holds", "problems", "written", "distances", "solution files"), [_format(entry) for entry in FORMATS.values()]
    )
    generators = markdown_table(
        ("generator", "makes", "settings"),
        [(f"`{name}`", plain(GENERATORS[name].summary), ", ".join(f"`{key}`" for key in GENERATORS[name].settings)) for name in GENERATORS],
    )
    return TEXT.format(formats=formats, generators=generators)


def _format(entry: Format) -> tuple[str, ...]:
    return (
        f"`{entry.name}`",
        plain(entry.summary),
        ", ".join(f"`{name}`" for name in entry.problems) or "as the file says",
        "no" if entry.write is None else ", ".join(f"`{suffix}`" for suffix in entry.suffixes) or "yes",
        f"`{entry.convention}`" if entry.convention else "",
        ", ".join(f"`{suffix}`" for suffix in entry.solutions),
    )
