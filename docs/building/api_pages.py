"""The reference of the public interface: every public name in a group, told by its docstring."""

import waybound as wb
from waybound import _MODULES

GROUPS: dict[str, tuple[str, tuple[str, ...]]] = {
    "functions": ("Functions", ("api", "solving", "reports", "heuristics")),
    "routing": ("Routing", ("formulations.routing", "instances.routing")),
    "robots": (
        "Robots, selection, risk and auctions",
        ("formulations.sata", "formulations.risk", "formulations.auctions", "instances"),
    ),
    "answers": ("Answers, evidence, programs and errors", ("formulations", "instances.errors")),
}
"""File name: title, and the modules whose public names it tells; a name goes to the group with the longest match."""


def group_of(module: str) -> str:
    """The page on which the names of a module are told."""
    matches = [(len(place), group) for group, (_, places) in GROUPS.items() for place in places if f"{module}.".startswith(f"{place}.")]
    return max(matches)[1]


def pages() -> dict[str, str]:
    """Markdown by file name, for mkdocstrings to fill."""
    held: dict[str, list[str]] = {group: [] for group in GROUPS}
    for module, names in _MODULES.items():
        held[group_of(module)] += names
    told = {name for names in held.values() for name in names}
    held["functions"] += [name for name in ("heuristics", "solvers") if name not in told]
    return {group: _page(GROUPS[group][0], sorted(names, key=str.lower)) for group, names in held.items()}


def _page(title: str, names: list[str]) -> str:
    sections = "\n\n".join(_entry(name) for name in names)
    return f"# API: {title}\n\nAll of these are names of `waybound`: `import waybound as wb`, then `wb.{names[0]}`.\n\n{sections}\n"


def _entry(name: str) -> str:
    value = getattr(wb, name)
    listed = {"solvers": "list_solvers", "heuristics": "list_heuristics"}  # callable packages: their tables are told
    place = f"waybound.reports.tables.listing.{listed[name]}" if name in listed else f"{value.__module__}.{value.__qualname__}"
    return (
        f"::: {place}\n    options:\n      heading: {name}\n      toc_label: {name}\n      heading_level: 2\n      show_root_heading: true"
    )
