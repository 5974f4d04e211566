"""Files of every kind that is read, after accidents and attacks: read, or refused in one line, quickly and in little memory."""

import copy
import json
import os
import random
import re
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import waybound as wb
from waybound.formulations.answers import read_answer
from waybound.formulations.certificate import certificate_lines, certificate_title, certify, check_certificate
from waybound.formulations.certificate_files import read_certificate
from waybound.formulations.json_text import json_text
from waybound.formulations.problem import Problem, problem_from_instance
from waybound.formulations.rendering import as_text
from waybound.instances.document import parse_json
from waybound.instances.errors import CheckFailedError, InputError, UsageError, WayboundError
from waybound.instances.formats import waybound_json
from waybound.instances.reading import read_instance, recognise
from waybound.reports.tables.facts import facts, facts_table
from waybound.solving.bounding import find_bounds

from .. import risk_problems, risky_cases
from ..instances.test_reading_fuzz import BASES, TOKENS
from ..uncertain_graphs import WORKED, graph_of

SECONDS = 2.0
MEGABYTES = 500
EXTREMES = (
    "1e308", "-1e308", "1.7976931348623157e308", "5e-324", "-0", "-0.0", "nan", "NaN", "Infinity", "-inf", "1" + "0" * 400, "9" * 5000,
    "1e999", "1e-400", "1e200", "5e307", "-1", "0", "1", "2147483648", "4294967296", "9223372036854775808", "1e18", "999999999999999999",
    "1000000000", "0x10", "1_000", "\u0663", "null", "true", '"x"', "[]", "{}", "[[1]]", '"\\u001b[31m"', "\x1b[2J", "\u202e", "$x^$",
)  # fmt: skip
ENCODINGS = ("utf-16", "utf-16-le", "utf-8-sig", "latin-1", "cp1252", "utf-32", "utf-7")


FLEET = {
    "waybound": 1, "kind": "routing", "name": "fleet", "problem": "min-cost-vrp", "notes": ["seen"], "min_vehicles": 1,
    "sites": {"id": ["a", "b", "1", "2", "3"], "depot": [True, True, False, False, False], "x": [0, 9, 1, 2, 3], "y": [0, 9, 1, 2.5, 3],
              "demand": [0, 0, 3, 4, 5], "ready": [0, 0, 5, 0, 10], "due": [100, 100, 60, None, 80], "service": [0, 0, 1, 1, 1],
              "reward": [0, 0, 1, 2, 3], "required": [False, False, True, True, False]},
    "travel": {"metric": "euclidean"}, "objective": ["total-cost"],
    "fleet": [{"name": "truck", "count": 3, "capacity": 9, "start": "a", "end": "a", "fixed_cost": 2.5, "max_duration": 90},
              {"name": "van", "count": None, "capacity": 12, "start": "b", "end": "b", "unit_cost": 2, "max_distance": 80,
               "energy": {"capacity": 70, "rate": 2, "charge": "elapsed"}}],
}  # fmt: skip
LATE = {
    **{key: value for key, value in FLEET.items() if key not in ("fleet", "sites")}, "name": "late", "team_risk": 0.3,
    "sites": {"id": ["a", "1", "2", "3"], "depot": [True, False, False, False], "x": [0, 1, 2, 3], "y": [0, 1, 2.5, 3]},
    "travel": {"metric": "EXPLICIT", "matrix": [[0, 2, 3, 4], [2, 0, 1, 2], [3, 1, 0, 1], [4, 2, 1, 0]],
               "variances": [[0, 1, 1, 2], [1, 0, 0.5, 1], [1, 0.5, 0, 1], [2, 1, 1, 0]]},
    "fleet": [{"name": "van", "count": 3, "start": "a", "end": "a", "max_duration": 14, "risk": 0.1}],
}  # fmt: skip
PLAN = {
    "waybound": 1, "kind": "risk-allocation", "name": "plan", "problem": "risk-allocation", "lower": -1, "upper": [1, 1, 2],
    "dynamics": {"state": [[1, 1], [0, 1]], "input": [[0.5], [1]], "noise": [[0.04, 0.01], [0.01, 0.02]], "start": [3, 0], "steps": 3},
    "cost": {"decisions": [1, 0, 2], "constant": 1, "terms": [{"kind": "absolute", "weight": 0.5, "decisions": [[1, -1, 0]]}]},
    "constraints": {"quantities": [[0, 0, 0, 0, 0, 1]], "lower": -2, "upper": 2, "names": ["end"]},
    "cones": [{"decisions": [[1, 0, 0], [0, 1, 0]], "limit": {"constant": 1.5}}],
    "chance": {"quantities": {"rows": 3, "row": [0, 1, 2], "column": [0, 2, 4], "value": [-1, -1, -1]}, "limits": [-1, -0.5, 0],
               "names": ["a", "b", "c"], "constraint": [0, 1, 2]},
    "risk": {"kind": "allocated", "total": 0.1, "each": [0.1, 0.05, 0.1],
             "budgets": [{"name": "late", "constraints": ["b", "c"], "risk": 0.08}]},
}  # fmt: skip
AT_RISK: dict[str, str] = {
    "lanes": "# name: lanes\n# start: s\n# goal: g\nfrom,to,mean,variance,least\ns,m,1,0.5,0\nm,g,2,0,2\ns,g,3.5,0.25,1\n",
    "roads": waybound_json.write(graph_of(WORKED)),
    "yard": "# risk map\n# a yard\n# conditional: yes\n# cell: 0.5\n# clearance: 0.04 0.5 1.5\n# length: 0.1\n# turn: 0.02\n# mud: 0.3\n"
    "# tether: 0.25 0.25 0.01 0.03\n...@G\n.~~..\nS..@.\n",
    "states": "# conditional: yes\n# reach: 1.2\n# start: a\n# goals: d; c\n# length: 0.02 linear\n"
    "state,easting,northing,reward,risk-x\na,0,0,0,0.01\nb,1,0,2,0.04\nc,0,1,0,0\nd,1,1,0,0\n",
    "mud": waybound_json.write(risky_cases.mud().graph),
    "ways": waybound_json.write(risky_cases.two_ways().graph),
    "plan": json.dumps(PLAN, indent=1),
    "two": risk_problems.STALLING_TEXT,
    "late": json.dumps(LATE, indent=1),
}
"""Problems of risk in each of their formats."""

RIGHT = {**BASES, "fleet": json.dumps(FLEET, indent=1).split("\n"), **{name: text.split("\n") for name, text in AT_RISK.items()}}


# -- files that are right ---------------------------------------------------------------------------------------------------


@cache
def problems() -> dict[str, Problem]:
    """A small problem of each family, by the name of the base that it is read from."""
    made = {}
    for name, lines in RIGHT.items():
        path = Path(f"{name}.txt")
        text = "\n".join(lines)
        made[name] = problem_from_instance(recognise(text).read(text, path))
    return made


def an_answer(problem: Problem) -> Any:
    """Some answer, feasible or not."""
    if isinstance(problem, wb.RoutingProblem):
        return wb.Routes.of([[int(c)] for c in problem.customers])
    if problem.problem == "max-min-lp":
        return problem.answer_from_json({"kind": "values", "values": {}})
    if isinstance(problem, wb.RiskAllocation):
        return np.zeros(problem.size)
    if isinstance(problem, wb.UncertainPath | wb.RiskyPath):
        return problem.answer_at_hand()
    if isinstance(problem, wb.BottleneckSATA) and problem.fractional:
        return np.zeros(problem.graph.num_actions)
    return wb.Selection((0,))


@cache
def files() -> dict[str, list[tuple[str, str]]]:
    """What is read as an instance, a solution and a certificate: pairs of the base that it belongs to and its text."""
    instances = [(name, "\n".join(lines)) for name, lines in RIGHT.items()]
    solutions, certificates = [], []
    for name, problem in problems().items():
        answer = an_answer(problem)
        judged = problem.evaluate(answer)
        solutions.append(
            (name, json_text({"answer": problem.answer_to_json(answer), "objective": judged.objective, "problem": problem.problem}))
        )
        solutions.append((name, json.dumps(problem.answer_to_json(answer))))
        for piece in find_bounds(problem, 0.2):
            certificates.append((name, json_text(certify(problem, None, [piece]).to_json(with_evidence=True))))
            if judged.feasible:
                certificates.append((name, json_text(certify(problem, judged, [piece]).to_json(with_evidence=True))))
        certificates.append((name, json_text(certify(problem, judged).to_json(with_evidence=True))))
    routes = "\n".join(f"Route #{k}: {k}" for k in range(1, 7)) + "\nCost 12.5\nComment x\n"
    plan = json.dumps(
        {"code": 0, "summary": {"cost": 5}, "unassigned": [],
         "routes": [{"vehicle": 1, "cost": 5, "steps": [{"type": "start"}, {"type": "job", "id": 1}, {"type": "end"}]}]}
    )  # fmt: skip
    sequence = (
        "NAME : t\nTYPE : OP\nDIMENSION : 3\nROUTE_NODES : 2\nROUTE_SCORE : 8\nNODE_SEQUENCE_SECTION\n2\n1\n-1\nDEPOT_SECTION\n2\n-1\nEOF\n"
    )
    tour = "NAME : t\nTYPE : TOUR\nDIMENSION : 4\nTOUR_SECTION\n1\n2\n4\n3\n-1\nEOF\n"
    return {
        "instance": instances,
        "solution": [*solutions, ("csv", routes), ("vrplib-tsp", tour), ("vrplib-op", sequence), ("vroom", plan)],
        "certificate": certificates,
    }


# -- mutations -------------------------------------------------------------------------------------------------------------

_NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?")


def mutated(text: str, others: list[tuple[str, str]], rng: random.Random) -> bytes:
    """``text`` after one to four mutations."""
    for _ in range(rng.choice((1, 1, 1, 2, 2, 4))):
        way = rng.random()
        if way < 0.45:
            spans = [m.span() for m in _NUMBER.finditer(text[:20_000])]
            if spans:
                first, last = rng.choice(spans)
                text = text[:first] + rng.choice((rng.choice(EXTREMES), str(rng.randint(-1, 20)), f"{rng.uniform(0, 50)}")) + text[last:]
        elif way < 0.6:
            text = _lines_mutated(text, rng)
        elif way < 0.65:
            text = text[: rng.randrange(len(text) + 1)]
        elif way < 0.68:
            text += rng.choice(("", "\n")) + rng.choice(others)[1]
        elif way < 0.75 and text:
            at = rng.randrange(len(text))
            text = text[:at] + rng.choice(TOKENS + list(EXTREMES)) + text[at + rng.randint(0, 5) :]
        else:
            text = _document_mutated(text, rng)
    data = text.encode("utf-8", "surrogatepass")
    if rng.random() < 0.05:
        data = text.encode(rng.choice(ENCODINGS), "replace")
    for _ in range(rng.choice((0,) * 12 + (1, 3)) if data else 0):
        at = rng.randrange(len(data))
        data = data[:at] + bytes([data[at] ^ (1 << rng.randrange(8))]) + data[at + 1 :]
    if rng.random() < 0.03:
        at = rng.randrange(len(data) + 1)
        data = data[:at] + rng.choice((b"\0", b"\0" * 1000, b"\xff\xfe", b"\x1b[2J", b"\r", b"\x85")) + data[at:]
    return data


def _lines_mutated(text: str, rng: random.Random) -> str:
    """Lines dropped, doubled, swapped or replaced."""
    lines = text.split("\n")
    at, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    way = rng.randrange(4)
    if way == 0:
        del lines[at : at + rng.randint(1, 4)]
    elif way == 1:
        lines[at:at] = [lines[other]] * rng.choice((1, 1, 1000))
    elif way == 2:
        lines[at], lines[other] = lines[other], lines[at]
    else:
        lines[at] = rng.choice(TOKENS)
    return "\n".join(lines)


def _document_mutated(text: str, rng: random.Random) -> str:
    """JSON with another value, key or depth somewhere; other text as it is."""
    try:
        data = parse_json(text)
    except (InputError, ValueError):
        return text
    part = data
    while isinstance(part, dict | list) and part:
        key = rng.choice(list(part)) if isinstance(part, dict) else rng.randrange(len(part))
        if rng.random() < 0.4 or not isinstance(part[key], dict | list) or not part[key]:
            deep: Any = 0
            for _ in range(rng.choice((1, 30, 60, 400))):
                deep = [deep] if rng.random() < 0.5 else {"a": deep}
            odd = (
                None, True, "", "x" * 5000, -1, 0.5, 10**30, 1e308, [], {}, [part[key]], {"kind": part[key]}, deep, list(range(3000)),
                [[]] * 50,
            )  # fmt: skip
            part[key] = copy.deepcopy(rng.choice(odd))
            break
        part = part[key]
    return json.dumps(data)


# -- the judgement -----------------------------------------------------------------------------------------------------------


def read(kind: str, base: str, path: Path) -> None:
    """Read a file and show what it holds, as the commands do."""
    if kind == "instance":
        problem = problem_from_instance(read_instance(path))
        facts_table(facts(problem))
        return
    problem = problems()[base]
    if kind == "solution":
        made = certify(problem, problem.evaluate(read_answer(problem, path).answer))
    else:
        made = check_certificate(problem, read_certificate(path), problem.evaluate(an_answer(problem)))
    lines = certificate_lines(made)
    shown = as_text(certificate_title(made), lines).split("\n")
    assert len(shown) == 1 + len(lines) and all(line.isprintable() for line in shown)


@contextmanager
def bounded_memory() -> Iterator[None]:
    """Whatever takes more than ``MEGABYTES`` beyond what is taken now ends in a MemoryError."""
    resource = pytest.importorskip("resource")
    statm = Path("/proc/self/statm")
    if not statm.exists():
        yield
        return
    taken = int(statm.read_text().split()[0]) * resource.getpagesize()
    limits = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (taken + (MEGABYTES << 20), limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, limits)


@pytest.mark.share(4)
@pytest.mark.parametrize("part", range(4))
def test_no_mutated_file_does_harm(part: int, share: Callable[[int, int], int], tally: Any, tmp_path: Path) -> None:
    rng = random.Random(30 + part)
    kinds = files()
    for kind, right in kinds.items():
        for k, (base, text) in enumerate(right):  # compiles what is compiled on first use, and shows that the bases are right
            path = tmp_path / f"right-{kind}-{k}"
            path.write_text(text, encoding="utf-8")
            read(kind, base, path)
    path = tmp_path / "mutated"
    with bounded_memory():
        for number in range(share(40, 25_000)):
            kind = ("instance", "instance", "solution", "certificate")[number % 4]
            base, text = rng.choice(kinds[kind])
            path.write_bytes(mutated(text, kinds[rng.choice(list(kinds))], rng))
            tally[f"mutated {kind} files"] += 1
            began = time.thread_time()
            try:
                read(kind, base, path)
                tally[f"mutated {kind} files that are read"] += 1
            except (InputError, UsageError, CheckFailedError) as error:
                told = str(error)
                assert told.isprintable() and len(told) < 400, told
                assert isinstance(error, WayboundError) and error.exit_code in (2, 5)
            assert time.thread_time() - began < SECONDS, path.read_bytes()[:2000]


@pytest.mark.parametrize("name", ["/dev/stdin", "/dev/zero", "pipe", ".", "missing", "\x1b[2J"])
def test_a_matrix_is_read_from_a_plain_file_alone(name: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "a.csv").write_text(f"# matrix: {name}\nid,x,y\n0,0,0\n1,3,4\n")
    with pytest.raises(InputError, match="matrix"):
        read_instance(tmp_path / "a.csv")


@pytest.mark.parametrize("depth", [51, 900, 100_000])
@pytest.mark.parametrize("kind", ["instance", "solution", "certificate"])
def test_depth_is_refused_wherever_json_is_read(kind: str, depth: int, tmp_path: Path) -> None:
    path = tmp_path / "deep.json"
    path.write_text('{"waybound": 1, "kind": ' + "[" * depth + "]" * depth + "}")
    with pytest.raises(InputError, match="nested too deeply"):
        read(kind, "csv", path)


@pytest.mark.slow  # and not traced
@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("instance", '{"waybound": 1, "kind": %s}'), ("solution", '{"answer": %s}'), ("solution", '{"kind": "routes", "routes": %s}'),
        ("certificate", '{"kind": "certificate", "schema": 1, "evidence": %s}'),
    ],
)  # fmt: skip
def test_hundreds_of_thousands_of_entries_are_refused_quickly(kind: str, text: str, tmp_path: Path) -> None:
    path = tmp_path / "long.json"
    for entries in ("[" + "0," * 300_000 + "0]", "[" + "{}," * 300_000 + "{}]"):
        path.write_text(text % entries)
        with bounded_memory():
            began = time.thread_time()
            with pytest.raises(InputError) as caught:
                read(kind, "csv", path)
            assert time.thread_time() - began < SECONDS
        assert len(str(caught.value)) < 400
