"""Heuristics with their stated guarantees, from what they declare."""

from markdown_tables import markdown_table, plain

from waybound.heuristics.heuristic import HEURISTICS, Heuristic

HEAD = """# Heuristics and their guarantees

Made from what is registered. A guarantee is stated as its source states it, and each assumption is checked on the instance at hand: an
answer carries the guarantee only where all hold, and its *observed* ratio against a verified bound beside it. [Thousands of
instances](../ratios.md) compare the two. "No guarantee" means that none is known here, not that answers are bad.
"""


def page() -> str:
    """The whole page: one table a family."""
    families = sorted({family for heuristic in HEURISTICS.values() for family in heuristic.families})
    return "\n".join([HEAD, *(_section(family) for family in families)])


def _section(family: str) -> str:
    members = [h for h in HEURISTICS.values() if family in h.families]
    rows = [(f"`{h.name}`", plain(h.summary), plain(h.stated), _options(h)) for h in members]
    return f"## {family}\n\n{markdown_table(('heuristic', 'what it does', 'guarantee', 'options'), rows)}\n"


def _options(heuristic: Heuristic) -> str:
    return ", ".join(f"`{name}={default!r}`" for name, default in heuristic.parameters().items())
