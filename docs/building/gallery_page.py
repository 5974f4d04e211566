"""The gallery: scripts of ``docs/building/gallery``, run and told as cards of a picture, the code, and what is known of the answer.

A script begins with a docstring, its title and a sentence, and ends with an expression that draws ``solution``.
"""

import ast
import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from waybound.formulations.rendering import number, percent

if TYPE_CHECKING:
    from waybound.formulations.solution import Solution

FOLDER = Path(__file__).resolve().parent / "gallery"

ORDER = (
    "time_windows", "longest_route", "schedule", "orienteering", "tour", "tasks", "jobs", "orchard_day", "rooms", "bottleneck",
    "winner_takes_all", "coverage", "risk_allocation", "risky_path", "uncertain_path", "bare_program",
)  # fmt: skip
"""Cards, in the order of reading."""

HEAD = """---
hide: [navigation, toc]
---

# Gallery

One problem a card: the picture, all the code, what the answer is worth, and what no answer can beat. All of it is run when this site is
made.

<div class="grid cards gallery" markdown>

{cards}
</div>
"""

INCHES, DPI, COLOURS = (5.6, 4.2), 130, 48
"""Size of a thumbnail, and how many colours it is left with."""


@dataclass(frozen=True)
class Card:
    """A script by its parts; code without imports that Python's readers expect anyhow is ``lines``."""

    name: str
    title: str
    words: str
    code: str

    @property
    def lines(self) -> list[str]:
        """Lines of code, but for blank ones and imports of other packages."""
        return [line for line in self.code.splitlines() if line.strip() and not line.startswith(("import numpy", "import pandas"))]


def card(script: Path) -> Card:
    """The parts of a script."""
    text = script.read_text(encoding="utf-8")
    title, _, words = (ast.get_docstring(ast.parse(text)) or "").partition("\n")
    return Card(script.stem, title.rstrip("."), " ".join(words.split()), text.rpartition('"""')[2].strip())


def run(one: Card) -> "tuple[Solution, Any]":
    """The solution that a script ends with, and the axes that it is drawn on."""
    tree = ast.parse(one.code)
    drawn = tree.body.pop()
    if not isinstance(drawn, ast.Expr):
        raise ValueError(f"{one.name} does not end with a picture")
    names: dict[str, Any] = {}
    exec(compile(tree, one.name, "exec"), names)
    return names["solution"], eval(compile(ast.Expression(drawn.value), one.name, "eval"), names)


def thumbnail(axes: Any) -> bytes:
    """A picture as a small PNG file: without heading and legend, which the card tells, in few colours."""
    from PIL import Image

    for text in axes.texts:
        if text.get_position() == (0, 6):  # what stands below the heading
            text.remove()
    axes.set_title("", loc="left")
    if axes.get_legend() is not None:
        axes.get_legend().remove()
    figure = axes.figure
    for legend in list(figure.legends):
        legend.remove()
    figure.set_size_inches(*INCHES)
    held, small = io.BytesIO(), io.BytesIO()
    figure.savefig(held, format="png", dpi=DPI)
    with Image.open(held) as picture:
        picture.convert("RGB").quantize(COLOURS).save(small, format="png", optimize=True)
    return small.getvalue()


def figures(solution: "Solution") -> str:
    """Value, bound and gap in a line."""
    bound = "no bound" if solution.bound is None else f"bound {number(solution.bound)} ({solution.bound_kind})"
    gap = "" if solution.gap is None else f", gap {percent(solution.gap)}"
    told = f"value {number(solution.objective)}, {bound}{gap}; by `{solution.solver}`"
    return told.replace(" %", "\u00a0%")


def page(*, executed: bool = True) -> tuple[str, dict[str, bytes]]:
    """The page, and its pictures by file name; with ``executed=False`` texts and code alone."""
    told, pictures = [], {}
    for name in ORDER:
        one = card(FOLDER / f"{name}.py")
        parts = [f"**{one.title}**", one.words, f"```python\n{one.code}\n```"]
        if executed:
            solution, axes = run(one)
            pictures[f"{name}.png"] = thumbnail(axes)
            parts = [f"![{one.title}](gallery/{name}.png){{ loading=lazy }}", *parts, figures(solution)]
        first, *rest = "\n\n".join(parts).splitlines()
        told.append("\n".join([f"-   {first}", *(f"    {line}".rstrip() for line in rest), ""]))
    return HEAD.format(cards="\n".join(told)), pictures
