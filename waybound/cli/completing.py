"""Names that the shell offers after an option or for an argument: of what is registered, bundled instances and campaigns, and files.

Registries are asked, which loads the modules of waybound that fill them, and no solver's package.
"""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path

PLACES: dict[str, tuple[str, ...]] = {
    "solver": ("solvers.backend:BACKENDS",),
    "heuristic": ("heuristics.heuristic:HEURISTICS",),
    "form": ("formulations.forms:FORMS",),
    "problem": ("formulations.problem:PROBLEMS",),
    "format": ("instances.formats:FORMATS",),
    "generator": ("instances.generators:GENERATORS",),
    "convention": ("instances.routing.travel:CONVENTIONS", "instances.routing.travel:ALIASES"),
    "mission": ("reports.missions.mission:MISSIONS",),
    "study": ("reports.studies.study:STUDIES",),
    "instance": ("instances.bundled:RECIPES",),
}
"""Places of the names of each kind of thing: a module, and what in it is iterated over."""


def names(what: str) -> Callable[[str], list[str]]:
    """A completion by the names of ``PLACES[what]``."""

    def complete(incomplete: str) -> list[str]:
        known = [name for place in PLACES[what] for name in _members(place)]
        return [name for name in known if name.startswith(incomplete)]

    return complete


def instances(incomplete: str) -> list[str]:
    """Bundled instances and files."""
    return [*names("instance")(incomplete), *files(incomplete)]


def campaigns(incomplete: str) -> list[str]:
    """Bundled campaigns and files."""
    from ..reports.campaigns.campaign import bundled_campaigns

    return [*(name for name in bundled_campaigns() if name.startswith(incomplete)), *files(incomplete)]


def files(incomplete: str) -> list[str]:
    """Files and folders; of a folder that is the only one what is in it, so that the shell goes on without a space."""
    folder, _, start = incomplete.rpartition("/")
    try:
        place = Path(f"{folder}/" if folder or incomplete.startswith("/") else ".").expanduser()
        above = incomplete[: len(incomplete) - len(start)]
        paths = [f"{above}{path.name}{'/' * path.is_dir()}" for path in sorted(place.iterdir()) if _offered(path.name, start)]
    except (OSError, ValueError, RuntimeError):
        return []
    return files(paths[0]) or paths if len(paths) == 1 and paths[0].endswith("/") else paths


def _offered(name: str, start: str) -> bool:
    return name.startswith(start) and (start.startswith(".") or not name.startswith("."))


def _members(place: str) -> list[str]:
    module, _, registry = place.partition(":")
    return list(getattr(import_module(f"...{module}", __name__), registry))
