"""One run of a campaign: an instance is read, solved within its limits, and recorded as one row with its documents."""

import importlib
import json
import os
import platform
import resource
import time
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

from ..._version import __version__
from ...formulations.json_text import finite
from ...formulations.solution import Solution
from ...instances.errors import InputError, NoAnswerError, WayboundError, in_words
from .instance_list import hash_of
from .own_modules import import_modules
from .setting import Setting

COLUMNS = {
    "problem": "TEXT", "sense": "TEXT", "convention": "TEXT", "form": "TEXT", "instance_hash": "TEXT", "status": "TEXT", "limit": "TEXT",
    "objective": "REAL", "bound": "REAL", "bound_kind": "TEXT", "bound_source": "TEXT", "gap": "REAL", "verified_bound": "REAL",
    "levels": "TEXT", "checked": "INTEGER", "faults": "INTEGER", "reason": "TEXT", "error_code": "TEXT", "seconds": "REAL",
    "compile_seconds": "REAL", "bound_seconds": "REAL", "check_seconds": "REAL", "cpu_seconds": "REAL", "run_seconds": "REAL",
    "began": "TEXT",
}  # fmt: skip
"""Columns of a run, by name, and as what SQLite keeps it.

``objective`` and ``bound`` are those of the first level of priority; all levels are in ``levels``, as JSON, where there are several.
``checked`` is 1 where an answer passed every check and nothing about it contradicts itself. ``seconds`` are those of the search alone,
``run_seconds`` those of the whole run, ``cpu_seconds`` those of all its processors, from after reading on, child processes included.
"""

DOCUMENTS = ("solution", "certificate", "history")
"""Documents of a run, as JSON: the solution with its answer, the certificate with its evidence, the course of the search."""


@dataclass(frozen=True)
class Task:
    """A run, as it is sent to the process that does it.

    ``path`` is the instance's file, relative to ``folder``, or the name of a bundled one, and ``hash`` SHA-256 of that file when the run
    was planned ("" if anything goes). It is ended ``overtime`` seconds after all limits; ``modules`` are imported before it.
    """

    path: str
    setting: Setting
    seed: int
    folder: str
    overtime: float
    hash: str = ""
    modules: tuple[str, ...] = ()

    @property
    def deadline(self) -> float:
        """Seconds after which it is ended, if nothing is compiled meanwhile."""
        return self.setting.time_limit + self.setting.bound_budget + self.overtime


@dataclass(frozen=True)
class Outcome:
    """A run that has ended, however.

    Parameters
    ----------
    row : dict
        Values of ``COLUMNS``, as far as they are known.
    documents : dict
        JSON by the names of ``DOCUMENTS``.
    machine : dict
    """

    row: dict[str, Any]
    documents: dict[str, str]
    versions: dict[str, str]
    machine: dict[str, Any]


def run_task(task: Task) -> Outcome:
    """Do a run in this process, whose memory is limited from then on; any exception but an interrupt becomes its outcome."""
    from ...api import problem_of, read_source
    from ...solvers.isolation import limit_memory
    from ...solving.request import request_of
    from ...solving.solve import solve

    began, at = time.perf_counter(), datetime.now(UTC).isoformat(timespec="seconds")
    setting, row, documents = task.setting, dict[str, Any](), dict[str, str]()
    versions, kept = own_versions(), True
    try:
        import_modules(task.modules, task.folder)
        if setting.files:
            os.chdir(task.folder)
        if task.hash and Path(task.path).is_file() and hash_of(Path(task.path)) != task.hash:
            message = "is not the file that the campaign began with: it was changed, or is another one on this machine"
            raise InputError(message, "foreign", file=task.path)
        if setting.memory_limit is not None:
            _load(setting)
            kept = limit_memory(setting.memory_limit)
        changes = {**setting.changes}
        instance = read_source(task.path, setting.format, setting.problem, changes)
        problem = problem_of(instance, setting.problem, setting.convention, changes)
        row.update(problem=problem.problem, sense=problem.sense, convention=problem.convention)
        before = processor_seconds()
        solution = solve(problem, request_of(problem, seed=task.seed, **setting.keywords()))
        row.update(_told(solution), cpu_seconds=processor_seconds() - before)
        documents.update(_documents(solution))
        versions.update(solution.versions)
    except NoAnswerError as fault:
        row.update(failed(str(fault), fault.code), status="unknown")
    except Exception as fault:
        row.update(_of_fault(fault, setting))
    if not kept:
        row["reason"] = "; ".join(filter(None, (row.get("reason"), NOT_KEPT)))
    return Outcome({**row, "began": at, "run_seconds": time.perf_counter() - began}, documents, versions, machine())


def failed(reason: str, code: str, limit: str = "none") -> dict[str, Any]:
    """The row of a run without a result, and why."""
    return {"status": "error", "limit": limit, "checked": 0, "faults": 0, "reason": reason, "error_code": code}


def lost(task: Task, reason: str, limit: str = "none", seconds: float | None = None) -> Outcome:
    """The outcome of a run whose process died."""
    return Outcome({**failed(reason, "search-failed", limit), "run_seconds": seconds}, {}, own_versions(), machine())


def processor_seconds() -> float:
    """Seconds of the processor of this process, and of those children that have ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def own_versions() -> dict[str, str]:
    """Versions of waybound and Python."""
    return {"waybound": __version__, "python": platform.python_version()}


@cache
def machine() -> dict[str, Any]:
    """The machine that runs are done on."""
    model = platform.processor() or platform.machine()
    with suppress(OSError, StopIteration):
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        model = next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return {"name": platform.node(), "system": f"{platform.system()} {platform.release()}", "processor": model, "cores": os.cpu_count()}


def _told(s: Solution) -> dict[str, Any]:
    """The row of a solution."""
    from ...solving.recording import BOUNDING

    objective, bound = _first(s.objective), _first(s.bound)
    levels, seconds, reason = None, s.seconds, "; ".join(s.faults)
    if isinstance(s.objective, list) or isinstance(s.bound, list):
        levels = json.dumps(finite({"objective": s.objective, "bound": s.bound}))
    if s.answer is None or any(event.phase == "check" and event.found_by == BOUNDING for event in s.events):
        reason = reason or s.message
    return {
        "form": s.form, "instance_hash": s.certificate.instance_hash or None, "status": s.status, "limit": s.limit, "objective": objective,
        "bound": bound, "bound_kind": s.bound_kind, "bound_source": s.bound_source, "gap": s.gap, "verified_bound": s.certificate.bound,
        "levels": levels, "checked": int(s.evaluation is not None and not s.faults), "faults": len(s.faults), "reason": reason or None,
        "error_code": "check-failed" if s.faults else None, "seconds": seconds["solve"], "compile_seconds": seconds["compile"],
        "bound_seconds": seconds["bound"], "check_seconds": seconds["check"],
    }  # fmt: skip


def _first(value: Any) -> Any:
    return value[0] if isinstance(value, list) and value else None if isinstance(value, list) else value


def _documents(s: Solution) -> dict[str, str]:
    solution = {key: value for key, value in s.to_json().items() if key != "certificate"}
    events = [[e.seconds, e.phase, e.objective, e.bound, e.bound_kind, e.found_by] for e in s.events]
    documents = {"solution": solution, "certificate": s.certificate.to_json(with_evidence=True), "history": events}
    return {name: json.dumps(finite(data), ensure_ascii=False) for name, data in documents.items()}


def _load(setting: Setting) -> None:
    """Load what the method needs before memory is counted: a library's own size is nobody's choice."""
    from ...solvers.backend import BACKENDS

    names = ("numba", "scipy.sparse") if setting.heuristic else BACKENDS[setting.method.partition(":")[0]].modules
    for name in names:
        with suppress(ImportError):
            importlib.import_module(name)


def _of_fault(fault: BaseException, setting: Setting) -> dict[str, Any]:
    """The row of a run that ended in an error; under a limit on memory much that fails is a lack of it."""
    from ...solvers.isolation import lacked_memory

    said, limit = in_words(fault), setting.memory_limit
    if isinstance(fault, MemoryError) or (limit is not None and (lacked_memory(said) or _NO_STACK in said)):
        reason = "out of memory" if limit is None else f"the memory limit of {limit:g} MB was reached"
        return failed(reason, "too-large", "memory")
    return failed(said, fault.code if isinstance(fault, WayboundError) else "search-failed")


_NO_STACK = "can't start new thread"
NOT_KEPT = "the memory limit was not kept: this system has none"
