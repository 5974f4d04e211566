"""Solution files of routes: CVRPLIB ``.sol``, TSPLIB ``.tour``, and OPLib's ``.sol``.

Numbering: a ``.sol`` counts customers from 1 in the order of the instance's file, depots left out, and 0 is the depot. Where
the depot comes first, as in all common benchmark files, that is the row number counted from 0; it is not the node number of a
``.vrp`` file, which is one more. A ``.tour`` and OPLib's sequences use node numbers: sites counted from 1 in the file's order, depots
included.
"""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ..errors import InputError, UsageError
from ..text import lines_of, number, plain, shown, whole
from .instance import Sites

_ROUTE = re.compile(r"route\s*#?\s*(\d*)\s*:(.*)\Z", re.I)
_COST = re.compile(r"cost\s*:?\s*(.*)\Z", re.I)
# What stands beside the routes in the files of CVRPLIB and SINTEF, and what common solvers add.
_REMARK = re.compile(r"(?:comment|time|date|authors?|reference|source|instance(?:\s+name)?|name|solution|vehicles|gap|status)\b|#", re.I)
_TOUR_HEADER = re.compile(r"(?:NAME|COMMENT|TYPE|DIMENSION)\b", re.I)
_SEQUENCE_HEADER = re.compile(r"(NAME|COMMENT|TYPE|DIMENSION|COST_LIMIT|ROUTE_NODES|ROUTE_SCORE|ROUTE_COST)\s*:\s*(.*)\Z", re.I)


@dataclass(frozen=True)
class SolutionFile:
    """Routes of a solution file, as site indices of the instance without depots, and the cost that the file claims."""

    routes: tuple[tuple[int, ...], ...]
    cost: float | None = None


def routes_from_text(text: str, sites: Sites) -> SolutionFile:
    """The routes in the text of a ``.sol`` or ``.tour`` file, or of OPLib's form, whose claim is the score; recognised by its content.

    Raises InputError with the line if it is none of them, or names a customer that does not exist.
    """
    if re.search(r"^[ \t]*TOUR_SECTION", text, re.I | re.M):
        return _read_tour(text, sites)
    if re.search(r"^[ \t]*NODE_SEQUENCE_SECTION", text, re.I | re.M):
        return _read_sequence(text, sites)
    if not re.search(r"^[ \t]*route\s*#?\s*\d*\s*:", text, re.I | re.M):
        found = text.split("\n")[0].strip()
        raise InputError("is no solution file", line=1, expected="Route #1: ..., TOUR_SECTION, or JSON", found=shown(found))
    return _read_sol(text, sites)


def _read_sol(text: str, sites: Sites) -> SolutionFile:
    customers = sites.customers.tolist()
    routes: list[tuple[int, ...]] = []
    cost: float | None = None
    for line, row in lines_of(text):
        if match := _ROUTE.match(row):
            visits = [whole(token, line, "customer", least=0) for token in match[2].replace(",", " ").split()]
            while visits and visits[0] == 0:  # some files write the depot at both ends
                del visits[0]
            while visits and visits[-1] == 0:
                del visits[-1]
            for visit in visits:
                if not 1 <= visit <= len(customers):
                    message = "route names a customer that does not exist"
                    raise InputError(message, "unknown-name", line=line, expected=f"1 to {len(customers)}", found=str(visit))
            routes.append(tuple(customers[visit - 1] for visit in visits))
        elif match := _COST.match(row):
            if cost is not None:
                raise InputError("Cost stands twice", "duplicate", line=line)
            cost = number(match[1], line, "Cost")
        elif not _REMARK.match(row):
            raise InputError("line is not understood", line=line, expected="Route #k: ..., Cost, or Comment", found=shown(row))
    return SolutionFile(tuple(route for route in routes if route), cost)


def _read_tour(text: str, sites: Sites) -> SolutionFile:
    nodes: list[int] = []
    inside = ended = False
    last = 1
    for line, row in lines_of(text):
        last = line
        if not inside:
            inside = row.upper().rstrip(" :") == "TOUR_SECTION"
            if not inside and not _TOUR_HEADER.match(row):
                raise InputError("line is not understood", line=line, expected="a header or TOUR_SECTION", found=shown(row))
            continue
        if row.upper() == "EOF":
            break
        for token in row.split():
            if ended:
                raise InputError("a second tour is not supported", "unsupported", line=line, expected="EOF", found=shown(token))
            if token == "-1":
                ended = True
                continue
            node = whole(token, line, "node", least=1)
            if node > len(sites):
                message = "tour names a node that does not exist"
                raise InputError(message, "unknown-name", line=line, expected=f"1 to {len(sites)}", found=token)
            nodes.append(node - 1)
    if not ended:
        raise InputError("TOUR_SECTION ends early", "missing", line=last, expected="-1", found="the end of the file")
    return SolutionFile(_turned(nodes, sites, last), None)


def _turned(nodes: list[int], sites: Sites, line: int) -> tuple[tuple[int, ...], ...]:
    """The route from the depot along a cycle."""
    at = [k for k, node in enumerate(nodes) if sites.depot[node]]
    if len(at) != 1:
        message = "a tour must visit the depot once"
        raise InputError(message, "duplicate" if at else "missing", line=line, expected="1", found=f"{len(at)} visits")
    rotated = nodes[at[0] + 1 :] + nodes[: at[0]]
    return (tuple(rotated),) if rotated else ()


def _read_sequence(text: str, sites: Sites) -> SolutionFile:
    """Routes of OPLib's form: ``NODE_SEQUENCE_SECTION``, ``DEPOT_SECTION``, and headers that say what the sequence collects."""
    claims: dict[str, tuple[int, str]] = {}
    lists: dict[str, list[int]] = {}
    inside, last = "", 1
    for line, row in lines_of(text):
        last, title = line, row.upper().rstrip(" :")
        if title == "EOF":
            break
        if inside:
            for token in row.split():
                if token == "-1":
                    inside = ""
                    continue
                node = whole(token, line, "node", least=1)
                if not inside or node > len(sites):
                    expected = f"1 to {len(sites)}" if inside else "a section or EOF"
                    raise InputError("sequence names a node that does not exist", "unknown-name", line=line, expected=expected, found=token)
                lists[inside].append(node - 1)
        elif title in ("NODE_SEQUENCE_SECTION", "DEPOT_SECTION"):
            if title in lists:
                raise InputError(f"{title} stands twice", "duplicate", line=line)
            inside = title
            lists[inside] = []
        elif match := _SEQUENCE_HEADER.match(row):
            claims[match[1].upper()] = line, match[2]
        else:
            raise InputError(
                "line is not understood", line=line, expected="a header, NODE_SEQUENCE_SECTION or DEPOT_SECTION", found=shown(row)
            )
    if inside:
        raise InputError(f"{inside} ends early", "missing", line=last, expected="-1", found="the end of the file")
    nodes = lists.get("NODE_SEQUENCE_SECTION", [])
    for key, count in (("DIMENSION", len(sites)), ("ROUTE_NODES", len(nodes))):
        if key in claims and whole(claims[key][1], claims[key][0], key, least=0) != count:
            message = f"{key} is another number"
            raise InputError(message, "wrong-shape", line=claims[key][0], expected=str(count), found=shown(claims[key][1]))
    if any(not sites.depot[node] for node in lists.get("DEPOT_SECTION", [])):
        raise InputError("DEPOT_SECTION names another node", "foreign", line=last, expected=", ".join(str(k + 1) for k in sites.depots))
    score = number(claims["ROUTE_SCORE"][1], claims["ROUTE_SCORE"][0], "ROUTE_SCORE") if "ROUTE_SCORE" in claims else None
    return SolutionFile(_turned(nodes, sites, last), score)


def sol_text(sites: Sites, routes: Iterable[Sequence[int]], cost: float | None = None) -> str:
    """Text of a CVRPLIB solution file; ``routes`` are site indices without depots, and empty ones are left out."""
    rank = {site: k for k, site in enumerate(sites.customers.tolist(), start=1)}
    kept = [route for route in routes if len(route)]
    out = [f"Route #{k}: {' '.join(str(rank[i]) for i in route)}" for k, route in enumerate(kept, start=1)]
    if cost is not None and math.isfinite(cost):
        out.append(f"Cost {plain(cost)}")
    return "\n".join(out) + "\n"


def tour_text(sites: Sites, routes: Iterable[Sequence[int]], cost: float | None = None, name: str = "") -> str:
    """Text of a TSPLIB tour file, from the depot on; UsageError if the routes are not one tour through one depot."""
    kept = [route for route in routes if len(route)]
    depots = sites.depots.tolist()
    if len(kept) > 1 or len(depots) != 1:
        raise UsageError(f"{name}: {len(kept)} routes from {len(depots)} depots are no tour; write a .sol file", "unsupported")
    nodes = [depots[0] + 1, *(i + 1 for i in (kept[0] if kept else ()))]
    head = [f"NAME : {name}", "TYPE : TOUR", f"DIMENSION : {len(nodes)}"]
    if cost is not None and math.isfinite(cost):
        head.append(f"COMMENT : length {plain(cost)}")
    return "\n".join([*head, "TOUR_SECTION", *map(str, nodes), "-1", "EOF"]) + "\n"
