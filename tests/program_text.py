"""Programs as text, in the words of docs/formulations: what a form writes, for a reader to compare with its mathematics."""

import math
import textwrap
from pathlib import Path
from typing import Any

import numpy as np

from waybound import Compiled, Program
from waybound.formulations.problem import problem_from_instance
from waybound.instances.reading import read_instance

TWO_SITES = """
    # vehicles: 2
    # capacity: 4
    # max-distance: 12
    id,x,y,demand,service,due
    o,0,0,0,0,16
    a,3,0,2,1,9
    b,3,4,1,2,10
"""


def compiled(text: str, form: str, folder: Path, suffix: str = ".csv", *, relax: bool = False) -> Compiled:
    """The instance that ``text`` is in a file, compiled to ``form``."""
    path = folder / f"tiny{suffix}"
    path.write_text(textwrap.dedent(text).lstrip(), encoding="utf-8")
    return problem_from_instance(read_instance(path)).compile(form, relax=relax)


def written(text: str, form: str, folder: Path, suffix: str = ".csv", *, relax: bool = False) -> str:
    """What ``form`` writes for the instance that ``text`` is in a file."""
    made = compiled(text, form, folder, suffix, relax=relax)
    return f"{made.form}, {made.exactness.value}\n{program_text(made.program)}"


def expected(text: str) -> str:
    """A literal of a test, without the indent of the code around it."""
    return textwrap.dedent(text).lstrip()


def lines_of(problem: Any, *starts: str) -> list[str]:
    """Those of the three-index form's lines for a problem that begin so."""
    return [line for line in program_text(problem.compile("three-index").program).splitlines() if line.startswith(starts)]


def program_text(program: Program) -> str:
    """Objective, rows, second-order cones, circuits and domains, one a line, less coefficients of 0 and bounds that are none."""
    names = [program.variable_name(k) for k in range(program.num_variables)]
    terms = [(v, n) for v, n in zip(program.cost.tolist(), names, strict=True) if v] + _products(program, names)
    lines = [f"{program.sense} {_sum(terms, program.offset)}"]
    matrix = program.matrix.tocsr()
    matrix.sum_duplicates()
    matrix.sort_indices()
    for row, (low, high) in enumerate(zip(program.row_lower.tolist(), program.row_upper.tolist(), strict=True)):
        entries = slice(matrix.indptr[row], matrix.indptr[row + 1])
        pairs = zip(matrix.data[entries].tolist(), matrix.indices[entries].tolist(), strict=True)
        lines.append(f"{program.row_name(row)}: {_between(_sum([(v, names[j]) for v, j in pairs if v], 0.0), low, high)}")
    for block in program.cones:
        assert (block.kind, block.size) == ("second-order", 1)
        image = block.matrix(program.num_variables).toarray()
        parts = [
            _sum([(v, n) for v, n in zip(row, names, strict=True) if v], b)
            for row, b in zip(image.tolist(), block.offset.tolist(), strict=True)
        ]
        lines.append(f"{block.name}: |({', '.join(parts[1:])})| <= {parts[0]}")
    for graph in program.circuits:
        arcs = zip(graph.tail.tolist(), graph.head.tolist(), graph.column.tolist(), strict=True)
        what = "circuits through node 0" if graph.several else "one circuit"
        used = ", ".join(f"{i}>{j} {names[column]}" for i, j, column in arcs)
        lines.append(f"{graph.name}: {what}, nodes 0 to {graph.nodes - 1}, {used}")
    domains: dict[str, list[str]] = {}
    for name, whole, low, high in zip(names, program.integer.tolist(), program.lower.tolist(), program.upper.tolist(), strict=True):
        if (low, high) == (0.0, 1.0) and whole:
            domains.setdefault("{} binary", []).append(name)
        elif whole or (low, high) != (-math.inf, math.inf):
            domains.setdefault(_between("{}", low, high) + (" integer" if whole else ""), []).append(name)
    lines += [domain.format(", ".join(members)) for domain, members in domains.items()]
    return "".join(f"{_filled(line)}\n" for line in lines)


def _products(program: Program, names: list[str]) -> list[tuple[float, str]]:
    """The terms of ``x' Q x / 2``."""
    if program.quadratic is None:
        return []
    full = program.quadratic.toarray()
    assert (full == full.T).all()
    pairs = np.argwhere(np.triu(full)).tolist()
    return [(full[i, j] / 2.0, f"{names[i]}^2") if i == j else (full[i, j], f"{names[i]} {names[j]}") for i, j in pairs]


def _sum(terms: list[tuple[float, str]], offset: float) -> str:
    parts = [f"{'-' if v < 0 else '+'} {'' if abs(v) == 1 else f'{abs(v):g} '}{name}" for v, name in terms]
    if offset or not parts:
        parts.append(f"{'-' if offset < 0 else '+'} {abs(offset):g}")
    return " ".join(parts).removeprefix("+ ")


def _between(middle: str, low: float, high: float) -> str:
    if low == high:
        return f"{middle} = {low:g}"
    if -math.inf < low and high < math.inf:
        return f"{low:g} <= {middle} <= {high:g}"
    return f"{middle} >= {low:g}" if high == math.inf else f"{middle} <= {high:g}"


def _filled(line: str) -> str:
    return textwrap.fill(line, 120, subsequent_indent="    ", break_long_words=False, break_on_hyphens=False)
