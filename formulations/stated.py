"""Certificate files compared field by field with recomputed values; nothing is taken over from a file unless it agrees."""

import math
from collections.abc import Mapping
from typing import Any

from ..instances.errors import CheckFailedError, InputError
from ..instances.printable import printable
from .evaluation import Evaluation
from .evidence import Evidence, Guarantee
from .tolerance import same

MOST_EVIDENCE = 100
"""More pieces of evidence than this are refused: each is multiplied out."""


def real(value: Any, what: str) -> float:
    """A finite number; raises InputError for anything else."""
    figure = _figure(value, what)
    if not math.isfinite(figure):
        raise InputError(f"the certificate's {what} is not a finite number", "out-of-range", found=str(figure))
    return figure


def _figure(value: Any, what: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"the certificate's {what} is not a finite number", found=printable(value, 80))
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def stated_evidence(data: Mapping[str, Any]) -> list[Evidence]:
    """The evidence in a certificate file; raises InputError where it is malformed."""
    entries = data.get("evidence", [])
    if isinstance(entries, Mapping):
        raise InputError("the certificate's evidence stands in a file beside it, so it must be read by its path", "missing")
    if not isinstance(entries, list):
        raise InputError("the certificate's evidence is not a list")
    if len(entries) > MOST_EVIDENCE:
        raise InputError(
            "the certificate holds too much evidence", "too-large", expected=f"at most {MOST_EVIDENCE} entries", found=str(len(entries))
        )
    pieces = []
    for entry in entries:
        if not isinstance(entry, Mapping) or not {"kind", "source", "value", "data"} <= entry.keys():
            raise InputError("the certificate's evidence is malformed", expected="objects with kind, source, value and data")
        kind, source, value, plain = (entry[key] for key in ("kind", "source", "value", "data"))
        if not isinstance(kind, str) or not isinstance(source, str) or not isinstance(plain, Mapping):
            raise InputError("the certificate's evidence is malformed", expected="texts as kind and source, an object as data")
        known = float(value) if value in ("inf", "-inf") else real(value, "value of evidence")
        pieces.append(Evidence(kind, source, known, dict(plain)))
    return pieces


def compare_answer(data: Mapping[str, Any], evaluation: Evaluation | None, *, infeasible: bool) -> None:
    """Compare verdict, checks, violations and objective with the answer's own.

    Each check and violation that is stated must be one of the answer's, in their order. The answer may have more: one that was written
    and read again names what the one in memory left open, such as who is credited with a target.

    ``data``: the certificate file. ``evaluation``: of the answer; without one only types are looked at. ``infeasible``: whether the
    evidence proves that there is no answer. Raises InputError for a field of a wrong type. Raises CheckFailedError for a field that is not
    so.
    """
    for key in ("feasible", "infeasible", "unbounded"):
        if data.get(key) is not None and not isinstance(data[key], bool):
            raise InputError(f"the certificate's {key} is neither true nor false", found=printable(data[key], 80))
    feasible = data.get("feasible")
    if feasible and infeasible:
        raise CheckFailedError("the certificate states a feasible answer, its evidence proves that there is none")
    if evaluation is not None and feasible is not None and feasible != evaluation.feasible:
        if feasible:
            raise CheckFailedError(f"the certificate states a feasible answer, this one is not: {evaluation.violations[0].message}")
        raise CheckFailedError("the certificate states an infeasible answer, this one passes every check")
    checks, violations = (_entries(data, key) for key in ("checks", "violations"))
    values = data.get("objective")
    stated = [None if v is None else _figure(v, "objective") for v in (values if isinstance(values, list) else [values])]
    if evaluation is None:
        return
    own_checks, own_violations = [c.to_json() for c in evaluation.checks], [v.to_json() for v in evaluation.violations]
    for name, entries, own in (("checks", checks, own_checks), ("violations", violations, own_violations)):
        ours = iter(own)
        for entry in entries or ():
            if not any(_same(entry, one, evaluation.size) for one in ours):
                raise CheckFailedError(f"the certificate states {name} that are not this answer's: {printable(dict(entry), 160)}")
        if name == "violations" and feasible is False and entries == []:
            raise CheckFailedError("the certificate states an infeasible answer without violations")
    if values is not None and (
        len(stated) != len(evaluation.values)
        or not all(_agree(a, b, size) for a, b, size in zip(stated, evaluation.values, evaluation.sizes or evaluation.values, strict=True))
    ):
        raise CheckFailedError(f"the certificate states the objective {printable(values, 80)}, the answer's is {evaluation.objective!r}")


def _agree(stated: float | None, own: float, size: float) -> bool:
    return not math.isfinite(own) if stated is None else same(stated, own, abs(size) if math.isfinite(size) else 0.0)


def _entries(data: Mapping[str, Any], key: str) -> list[Mapping[str, Any]] | None:
    entries = data.get(key)
    if entries is None:
        return None
    if not isinstance(entries, list) or not all(isinstance(entry, Mapping) for entry in entries):
        raise InputError(f"the certificate's {key} are not a list of objects", found=printable(entries, 80))
    return entries


def _same(stated: Mapping[str, Any], own: Mapping[str, Any], size: float) -> bool:
    """Whether two entries agree in every key but the message, whose last digits may differ from machine to machine."""
    if stated.keys() != own.keys():
        return False
    for key, value in own.items():
        stated_value = stated[key]
        if isinstance(value, float) and not isinstance(stated_value, bool) and isinstance(stated_value, int | float):
            if not same(_figure(stated_value, key), value, size if math.isfinite(size) else 0.0):
                return False
        elif key != "message" and (type(stated_value) is not type(value) or stated_value != value):
            return False
    return True


def stated_guarantee(data: Mapping[str, Any]) -> Guarantee | None:
    """The guarantee in a certificate file. It cannot be verified, since a certificate does not say how its answer was computed."""
    guarantee = data.get("guarantee")
    if guarantee is None:
        return None
    parts = guarantee if isinstance(guarantee, Mapping) else {}
    statement, source, assumptions = parts.get("statement"), parts.get("source"), parts.get("assumptions", [])
    if not isinstance(assumptions, list) or not all(isinstance(text, str) for text in (statement, source, *assumptions)):
        raise InputError("the certificate's guarantee is malformed", expected="an object with ratio, statement, assumptions and source")
    ratio = math.inf if parts.get("ratio") is None else real(parts["ratio"], "guarantee's ratio")
    if ratio < 1.0:
        raise InputError("the certificate's guarantee is malformed", "out-of-range", expected="a ratio of at least 1", found=f"{ratio:g}")
    return Guarantee(ratio, str(statement), tuple(assumptions), str(source))
