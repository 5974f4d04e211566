"""Bundled instances: made by waybound's own generators, each from a recorded command, or small cases of the literature."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .errors import UsageError
from .generating import generate
from .instance import Instance
from .suggestions import did_you_mean


@dataclass(frozen=True)
class Recipe:
    """The origin of a bundled file: ``generate(kind, seed, **settings)``, written as ``file``, or the ``source`` of a small case."""

    file: str
    kind: str = ""
    seed: int = 1
    settings: Mapping[str, Any] = field(default_factory=dict)
    source: str = ""

    def command(self, name: str) -> str:
        """The command that makes the file; "" for a case of the literature."""
        if self.source:
            return ""
        options = "".join(f" --set {key}={value}" for key, value in {**self.settings, "name": name}.items())
        return f"waybound generate {self.kind}{options} --seed {self.seed} --out {self.file}"


RECIPES: dict[str, Recipe] = {
    "demo-c25": Recipe("demo-c25.txt", "solomon", 25, {"class": "C1", "customers": 25, "vehicles": 5, "width": 120}),
    "demo-r25": Recipe("demo-r25.txt", "solomon", 1, {"class": "R1", "customers": 25, "density": 0.75, "vehicles": 10, "width": 40}),
    "demo-rc50": Recipe("demo-rc50.txt", "solomon", 50, {"class": "RC1", "customers": 50, "density": 0.75, "width": 60}),
    "demo-x40": Recipe(
        "demo-x40.vrp", "uchoa", 40, {"customers": 40, "depot": "C", "positions": "RC", "demand": "1-100", "route-length": 6}
    ),
    "demo-tiny": Recipe("demo-tiny.json", "random", 7, {"customers": 7, "windows": True, "service": 10, "vehicles": 3}),
    "figure-3-3": Recipe("figure-3-3.csv", source="Sung (2019), Figure 3.3: the graph of Table 3.1"),
    "sata-s3": Recipe("sata-s3.json", source="a small weighted case: three robots with three actions each, four targets"),
    "cover-30": Recipe("cover-30.json", source="30 sets (7 i + j^2 (1 + i mod 3)) mod 61, item e weighs 1 + e^2 mod 5, six may be chosen"),
}


def bundled_names() -> list[str]:
    """Names of the bundled instances."""
    return list(RECIPES)


def bundled_path(name: str) -> Path:
    """File of a bundled instance; UsageError for a name that does not exist."""
    if name not in RECIPES:
        raise UsageError(
            f"no bundled instance is named {name!r}; choose from {', '.join(RECIPES)}{did_you_mean(name, RECIPES)}", "unknown-name"
        )
    return Path(__file__).parent / "data" / RECIPES[name].file


def regenerate(name: str) -> Instance:
    """A bundled instance out of its recipe, without its file; UsageError for a case of the literature."""
    bundled_path(name)
    recipe = RECIPES[name]
    if recipe.source:
        raise UsageError(f"{name} was not generated: {recipe.source}", "unsupported")
    return generate(recipe.kind, recipe.seed, **recipe.settings, name=name)
