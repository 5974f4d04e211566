"""How straight ``problem`` goes through ``solve``: stays, rooms and climbs, counted in the syntax trees.

Whether a call takes the problem is read from annotations alone, so that a method counts as that of the class that is named, not of those
that override it; a class holds the problem where an attribute of it, or of what that holds, is annotated so.
"""

import ast
import importlib.util
import itertools
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import Annotated, Any, NamedTuple

from ._harness import Option, command

FLOORS = ("instances", "formulations", "solvers", "heuristics", "solving", "reports", "cli")


class Part(NamedTuple):
    """A function, a class, or the value or annotation of a variable; names of methods have a dot."""

    module: str
    name: str
    node: ast.AST


Kinds = tuple[Part, ...]
FUNCTION = Part("", "Callable", ast.Pass())
"""The kind of what is called later, and may hold the problem."""


def merged(kinds: Iterable[Kinds]) -> Kinds:
    """All of them, each once."""
    return tuple(dict.fromkeys(itertools.chain.from_iterable(kinds)))


def bindings(*nodes: ast.AST) -> Iterator[tuple[str, Any]]:
    """Names of variables, and ``self.`` ones of attributes, and the value or annotation that each is bound to."""
    for node in nodes:
        targets: list[Any] = getattr(node, "targets", [getattr(node, "target", getattr(node, "optional_vars", node))])
        value: Any = next((v for f in ("annotation", "iter", "context_expr", "value") if (v := getattr(node, f, None))), None)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "isinstance":
            targets, value = node.args[:1], node.args[1]
        elif not isinstance(node, ast.Assign | ast.AnnAssign | ast.For | ast.comprehension | ast.withitem | ast.arg):
            continue
        both = isinstance(targets[0], ast.Tuple) and isinstance(value, ast.Tuple)
        for target, bound in zip(targets[0].elts, value.elts, strict=True) if both else ((target, value) for target in targets):
            if bound and isinstance(target, ast.Name | ast.Attribute | ast.arg):
                yield getattr(target, "arg", "") or ast.unparse(target), bound


class Unquoted(ast.NodeTransformer):
    """Annotations as they read without quotes; values that they list, or tell beside the type, are none."""

    def visit_Subscript(self, node: ast.Subscript) -> Any:
        if isinstance(node.value, ast.Name) and node.value.id == "Literal":
            return node
        if isinstance(node.value, ast.Name) and node.value.id == "Annotated" and isinstance(node.slice, ast.Tuple):
            return self.visit(node.slice.elts[0])
        return self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        return ast.parse(node.value, mode="eval").body if isinstance(node.value, str) else node


@cache
def source(module: str) -> tuple[ast.Module, list[str]]:
    """The syntax tree of a module, and the names of the packages that it is in."""
    spec = importlib.util.find_spec(module)
    assert spec is not None and spec.origin is not None
    parts, tree = module.split("."), ast.parse(Path(spec.origin).read_text(encoding="utf-8"))
    for node, field in itertools.product(ast.walk(tree), ("annotation", "returns")):
        if getattr(node, field, None):
            setattr(node, field, Unquoted().visit(getattr(node, field)))
    return tree, parts if spec.submodule_search_locations else parts[:-1]


@cache
def find(module: str, name: str) -> Part | None:
    """The function, class, variable or module that a name in ``module`` refers to; None if it comes from another package."""
    tree, packages = source(module)
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and node.name == name:
            return Part(module, name, node)
        for bound, value in bindings(node):
            if bound == name:
                return Part(module, name, value)
    for statement in (node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)):
        for one in statement.names:
            if (one.asname or one.name) == name:
                above = packages[: len(packages) - statement.level + 1] if statement.level else []
                full = ".".join([*above, *([statement.module] if statement.module else [])])
                return find(full, one.name) if full.startswith(f"{packages[0]}.") else FUNCTION if name == "Callable" else None
    inner = f"{module}.{name}"
    return Part(inner, "", tree) if ".".join(packages) == module and importlib.util.find_spec(inner) else None


@cache
def member(owner: Part, name: str) -> tuple[Part | None, Kinds] | None:
    """The method of that name of a class, and the kinds of what it returns or of the attribute; None where there is none."""
    for node in owner.node.body if isinstance(owner.node, ast.ClassDef) else ():
        if isinstance(node, ast.FunctionDef) and node.name == name:
            return Part(owner.module, f"{owner.name}.{name}", node), kinds_in(owner.module, node.returns)
        made = isinstance(node, ast.FunctionDef) and node.name == "__init__"
        for bound, value in bindings(*(ast.walk(node) if made else [node])):
            if bound == (f"self.{name}" if made else name):
                return None, View(Part(owner.module, "", node if made else ast.Pass())).kinds(value)
    bases = owner.node.bases if isinstance(owner.node, ast.ClassDef) else []
    return next((found for base in bases for kind in kinds_in(owner.module, base) if (found := member(kind, name))), None)


def kinds_in(module: str, e: ast.AST | None) -> Kinds:
    """The kinds of an annotation or an expression that stands in no function."""
    return View(Part(module, "", ast.Pass())).kinds(e)


@cache
def carries(kind: Part, problem: Part, above: Kinds = ()) -> bool:
    """Whether objects of a class are the problem, or hold one."""
    if kind == problem or kind in above or not isinstance(kind.node, ast.ClassDef):
        return kind == problem
    names = [name.removeprefix("self.") for name, _ in bindings(*ast.walk(kind.node))]
    known = merged(found[1] for name in names if (found := member(kind, name)))
    return any(carries(one, problem, (*above, kind)) for one in known)


class View:
    """The kinds of what the names in a part stand for."""

    def __init__(self, part: Part) -> None:
        self.module, owner = part.module, find(part.module, part.name.partition(".")[0])
        self.known: dict[str, Kinds] = {"self": (owner,)} if owner and "." in part.name else {}
        nodes = list(ast.walk(part.node))
        self.inner = {node.name: node for node in nodes if isinstance(node, ast.FunctionDef) and node is not part.node}
        for name, value in [*bindings(*nodes)] * 2:  # a name may be bound after it is used, in the text
            self.known[name] = merged([self.known.get(name, ()), self.kinds(value)])

    def kinds(self, e: ast.AST | None) -> Kinds:
        """The classes that an expression may have, or an annotation names."""
        match e:
            case None | ast.Compare() | ast.JoinedStr():  # plain values
                return ()
            case ast.Name(name) if name in self.known:
                return self.known[name]
            case ast.Name(name):
                part = find(self.module, name)
                variable = part is not None and isinstance(part.node, ast.expr)
                return kinds_in(part.module, part.node) if part and variable else (part,) if part else ()
            case ast.Attribute(value, name):
                return next((found[1] for kind in self.kinds(value) if (found := member(kind, name))), ())
            case ast.Subscript(ast.Name("Callable")) | ast.Lambda():
                return (FUNCTION,)
            case ast.Call(func):
                part = self.callee(e)
                if part is None:
                    same = isinstance(func, ast.Name) and func.id in ("next", "replace")
                    return merged(map(self.kinds, e.args[:1])) if same else ()
                return kinds_in(part.module, part.node.returns) if isinstance(part.node, ast.FunctionDef) else (part,)
        return merged(map(self.kinds, ast.iter_child_nodes(e)))

    def callee(self, call: ast.Call) -> Part | None:
        """The function or class that is called; None for one that is not of the package, or not known before it runs."""
        part = None
        match call.func:
            case ast.Name(name) if name not in {*self.known, *self.inner}:
                part = find(self.module, name)
            case ast.Attribute(value, name):
                kinds = self.kinds(value)
                module = next((kind.module for kind in kinds if not kind.name), None)
                part = find(module, name) if module else next((found[0] for kind in kinds if (found := member(kind, name))), None)
        return part if part and isinstance(part.node, ast.FunctionDef | ast.ClassDef) else None

    def holds(self, e: ast.AST, problem: Part) -> bool:
        """Whether the value of an expression is the problem, an object that holds one, or a function that speaks of one."""
        function = self.inner.get(e.id) if isinstance(e, ast.Name) else e if FUNCTION in self.kinds(e) else None
        spoken: list[ast.AST] = [node for node in ast.walk(function) if isinstance(node, ast.Name)] if function else []
        if isinstance(e, ast.Attribute):
            methods = [found[0] for kind in self.kinds(e.value) if (found := member(kind, e.attr)) and found[0]]
            spoken += [e.value for method in methods if not getattr(method.node, "decorator_list", None)]  # a property is what it returns
        return any(carries(kind, problem) for kind in merged(map(self.kinds, [e, *spoken])))


def walk(part: Part, problem: Part, steps: list[Part]) -> list[Part]:
    """The functions and classes that the problem comes to from ``part`` on, each once, behind those of ``steps``."""
    if part in steps:
        return steps
    steps.append(part)
    made = (member(part, "__init__") or (None,))[0] if isinstance(part.node, ast.ClassDef) else part
    calls = [node for node in ast.walk(made.node) if isinstance(node, ast.Call)] if made else []
    view = View(made or part)
    for call in sorted(calls, key=lambda call: (call.func.end_lineno or 0, call.func.end_col_offset or 0)):
        receiver = [call.func.value] if isinstance(call.func, ast.Attribute) else []
        callee = view.callee(call)
        if callee and any(view.holds(e, problem) for e in [*receiver, *call.args, *(keyword.value for keyword in call.keywords)]):
            walk(callee, problem, steps)
    return steps


def stays(start: str, kind: str) -> list[tuple[str, list[str]]]:
    """Each stay of the problem: the module, and what it comes to there; ``start`` and ``kind`` are full names."""
    first, problem = (find(*name.rsplit(".", 1)) for name in (start, kind))
    assert first is not None and problem is not None
    return [
        (module, [step.name for step in steps]) for module, steps in itertools.groupby(walk(first, problem, []), lambda step: step.module)
    ]


def figures(stays: list[tuple[str, list[str]]]) -> tuple[int, int, int]:
    """Stays, rooms and climbs."""
    floors = [FLOORS.index(module.split(".")[1]) for module, _ in stays]
    return len(stays), len({module for module, _ in stays}), sum(one < other for one, other in itertools.pairwise(floors))


@command
def main(verbose: Annotated[bool, Option("-v", help="tell each stay too, in order")] = False) -> str:
    """Count the way of ``problem`` through ``waybound.solve``."""
    made = stays("waybound.solving.solve.solve", "waybound.formulations.problem.Problem")
    told = [f"{module.partition('.')[2]}: {', '.join(steps)}" for module, steps in made] if verbose else []
    return "\n".join([*told, "{} stays, {} rooms, {} climbs".format(*figures(made))])


if __name__ == "__main__":
    raise SystemExit(main())
