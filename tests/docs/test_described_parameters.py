"""Every parameter of the public interface is described: of functions, constructors and alternative constructors by an entry of its own."""

import inspect
import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import waybound as wb
from waybound.reports.tables.listing import list_heuristics, list_solvers

FUNCTIONS = {"solvers": list_solvers, "heuristics": list_heuristics}
"""Names of the face that are a package and, called, a function."""

LEFT_OUT = (BaseException, wb.Exactness)
"""Errors, which waybound raises, and an enumeration: users make none of them."""

SECTION = re.compile(r"^(?:Parameters|Attributes)\n-+\n(.*?)(?=^\w[\w ]*\n-+\n|\Z)", re.MULTILINE | re.DOTALL)
ENTRY = re.compile(r"^(\S[^\n]*?)(?: : [^\n]*)?\n((?: +[^\n]+\n|\n)*)", re.MULTILINE)
REFERENCE = re.compile(r"(?:[Ss]ee|[Aa]s (?:of|for|in)) ``([\w.]+)``")


def entries(thing: Any) -> dict[str, str]:
    """Descriptions by the name of the parameter, of a docstring in numpy's style."""
    text = inspect.cleandoc(thing.__doc__ or "") + "\n"
    told: dict[str, str] = {}
    for section in SECTION.findall(text):
        for names, words in ENTRY.findall(section):
            told |= {name.strip().lstrip("*"): " ".join(words.split()) for name in names.split(",")}
    return told


def target(name: str) -> Any:
    """What a docstring names by ``name``: a public name, a class's method, or a class of the package."""
    first, _, rest = name.rpartition(".waybound.")[2].partition(".")
    thing = FUNCTIONS.get(first) or getattr(wb, first, None)
    return getattr(thing, rest, None) if rest else thing


def undescribed(thing: Callable[..., Any], names: list[str]) -> list[str]:
    """Parameters that neither have a description nor are those of what the docstring refers to."""
    told = entries(thing)
    summary = (thing.__doc__ or "").partition("Parameters\n")[0]
    others = {key for other in REFERENCE.findall(summary) for key in entries(target(other))}
    return [name for name in names if not told.get(name) and name not in others]


def parameters(thing: Callable[..., Any]) -> list[str]:
    return [name for name in inspect.signature(thing).parameters if not name.startswith("_")]


def methods() -> Iterator[tuple[str, Callable[..., Any]]]:
    """Methods of public classes, own and inherited, whose docstrings have a section of parameters: it has to be whole."""
    for name in wb.__all__:
        thing = getattr(wb, name)
        for own, member in inspect.getmembers(thing, inspect.isfunction) if inspect.isclass(thing) else ():
            if not own.startswith("_") and re.search(r"^ *Parameters\n", member.__doc__ or "", flags=re.MULTILINE):
                yield f"{name}.{own}", member


def documented() -> Iterator[tuple[str, Callable[..., Any]]]:
    """Functions, classes and alternative constructors, as a user calls them."""
    for name in wb.__all__:
        thing = FUNCTIONS.get(name) or getattr(wb, name)
        if not callable(thing) or (inspect.isclass(thing) and issubclass(thing, LEFT_OUT)):
            continue
        yield name, thing
        if inspect.isclass(thing):
            made = [m for m in dir(thing) if re.match(r"(from|of)(_|$)|named$", m) and inspect.ismethod(getattr(thing, m))]
            yield from ((f"{name}.{m}", getattr(thing, m)) for m in made if m not in INSIDE)


INSIDE = ("from_document", "from_values", "from_json", "from_instance")
"""How files become instances: for readers, which alone call them."""


@pytest.mark.parametrize("name", [name for name, _ in documented()])
def test_every_parameter_is_described(name: str) -> None:
    thing = dict(documented())[name]
    assert undescribed(thing, parameters(thing)) == []


def test_no_section_of_parameters_of_a_method_has_gaps() -> None:
    gaps = {name: undescribed(method, [p for p in parameters(method) if p != "self"]) for name, method in methods()}
    assert len(gaps) > 30
    assert not {name: missing for name, missing in gaps.items() if missing}


def test_an_empty_description_is_none() -> None:
    def example(a: int, b: int, c: int) -> None:
        """Words.

        Parameters
        ----------
        a : int
        b : int
            Told.

        Returns
        -------
        int
        """

    assert undescribed(example, parameters(example)) == ["a", "c"]


def test_a_reference_describes_what_is_described_there() -> None:
    assert undescribed(wb.cvrp, ["capacity", "sites"]) == []
    assert undescribed(wb.cvrp, ["colour"]) == ["colour"]
