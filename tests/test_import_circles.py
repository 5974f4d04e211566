"""No modules import each other in a circle, not inside functions either; imports for types alone do not count."""

from __future__ import annotations

import ast
import os
from collections.abc import Iterator
from pathlib import Path

import networkx as nx

import waybound

ROOT = Path(waybound.__file__).parent


def imported(module: str, is_package: bool, tree: ast.AST) -> Iterator[str]:
    """Full names of what a module imports, of a name also as if it were a module."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = module.split(".") if is_package else module.split(".")[:-1]
            base = above[: len(above) + 1 - node.level] if node.level else []
            place = ".".join([*base, *([node.module] if node.module else [])])
            yield place
            yield from (f"{place}.{alias.name}" for alias in node.names)
        else:
            yield from imported(module, is_package, node)


def arrows() -> nx.DiGraph:
    """The modules of waybound, and which imports which."""
    files = {}
    for file in (Path(folder) / name for folder, _, names in os.walk(ROOT, followlinks=True) for name in names if name.endswith(".py")):
        parts = file.relative_to(ROOT.parent).with_suffix("").parts
        files[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = file
    graph = nx.DiGraph()
    for module, file in files.items():
        tree = ast.parse(file.read_text(encoding="utf-8"))
        names = set(imported(module, file.name == "__init__.py", tree)) & files.keys()
        # `from .package import module` is no import of what the package holds itself
        graph.add_edges_from((module, name) for name in names if not (module.startswith(f"{name}.")))
    return graph


def test_no_modules_import_each_other_in_a_circle() -> None:
    circles = [sorted(circle) for circle in nx.strongly_connected_components(arrows()) if len(circle) > 1]
    assert circles == []
