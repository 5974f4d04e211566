"""A process that has everything loaded and forks a child for each run, which costs milliseconds instead of seconds.

It does nothing else: no run is done in it, and it has one thread. What a run had to load or to compile, it loads too before the next one.
A child that dies costs its run only, and one that does not end is killed. Where forking is unsafe, each run is a fresh interpreter instead.
"""

import gc
import importlib
import math
import os
import pickle
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, Pipe, wait
from pathlib import Path
from typing import Any

from .one_run import Outcome, Task, lost, run_task

PRELOADED = ("waybound.api", "waybound.solving.solve", "waybound.instances.reading", "waybound.formulations.kernels", "scipy.sparse")
"""Modules that every run needs."""

_INHERITED = {"waybound", "numpy", "scipy", "numba", "llvmlite", *sys.stdlib_module_names}
"""Packages that are loaded here once a run has loaded them; libraries of solvers, which may keep threads, are not."""

SHORT = 10.0
"""Seconds up to which a run that had to load what later ones have is done once more, so that its limits and times are the search's."""

STANDS = 600.0
"""Seconds for which a run may compile: one that stands longer hangs."""

LOADS = 2
"""How often that may be: what had no time to be loaded in the first one is in the second."""

FORKS = hasattr(os, "fork") and sys.platform != "darwin"
"""Whether children are forked: the system's libraries of macOS, those for linear algebra too, do not outlive it."""

_PICKED_UP = "outcome"
_SAID = "output"
_TASK = "task"


@dataclass
class _Running:
    """A run under way."""

    number: int
    pid: int
    task: Task
    news: Connection
    place: Path
    before: int = 0
    began: float = field(default_factory=time.monotonic)
    standing: int = 0
    since: float = 0.0
    stood: float = 0.0
    late: bool = False

    @property
    def left(self) -> float:
        """Seconds until it is to be ended; while something is compiled its own do not count."""
        if self.late:
            return math.inf
        ends = self.since + STANDS if self.standing else self.began + self.stood + self.task.deadline
        return ends - time.monotonic()

    def hear(self) -> bool:
        """Take one message on its clock, which stands still or runs on; False at the end of them."""
        try:
            stands = self.news.recv_bytes() == b"stands"
        except (EOFError, OSError):
            return False
        if stands and not self.standing:
            self.since = time.monotonic()
        self.standing += 1 if stands else -1
        if not self.standing:
            self.stood += time.monotonic() - self.since
        return True


class ForkServer:
    """The loop of that process.

    Tasks come in as ``(number, task)``, outcomes go out as ``(number, outcome)``; it ends when the other end of ``connection`` is closed.
    Runs write into ``folder``.
    """

    def __init__(self, connection: Connection, folder: Path) -> None:
        self.connection, self.folder = connection, folder
        os.set_inheritable(connection.fileno(), False)
        self.running: dict[int, _Running] = {}
        self._woken, mouth = os.pipe()
        for end in (self._woken, mouth):
            os.set_blocking(end, False)
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.set_wakeup_fd(mouth, warn_on_full_buffer=False)

    def serve(self) -> None:
        """Do runs until nobody asks for any."""
        if FORKS:
            _preload()
        gc.collect()
        gc.freeze()
        while self._step():
            pass
        for one in self.running.values():
            os.kill(one.pid, signal.SIGKILL)

    def _step(self) -> bool:
        """Wait for something to happen and see to it; False once there is nothing more to do."""
        soonest = min((one.left for one in self.running.values()), default=math.inf)
        news = {one.news: one for one in self.running.values() if not one.news.closed}
        ready = wait([self.connection, self._woken, *news], None if math.isinf(soonest) else max(0.0, soonest))
        with suppress(BlockingIOError):
            os.read(self._woken, 4096)
        for end in ready:
            if end in news and not news[end].hear():
                end.close()
        for one in list(self.running.values()):
            if one.left <= 0.0:
                one.late = True
                os.kill(one.pid, signal.SIGKILL)
            ended, status = os.waitpid(one.pid, os.WNOHANG)
            if ended:
                self._end(one, os.waitstatus_to_exitcode(status))
        if self.connection in ready:
            try:
                number, task = pickle.loads(self.connection.recv_bytes())
            except (EOFError, OSError):
                return False
            self._begin(number, task)
        return True

    def _begin(self, number: int, task: Task, before: int = 0) -> None:
        place = self.folder / f"run-{number}"
        mine, theirs = Pipe(duplex=False)
        place.mkdir()
        pid = os.fork() if FORKS else _spawn(task, place, theirs)
        if not pid:
            mine.close()
            self.connection.close()
            for other in self.running.values():
                other.news.close()
            _be_a_run(task, place, theirs)
        theirs.close()
        self.running[number] = _Running(number, pid, task, mine, place, before)

    def _end(self, one: _Running, code: int) -> None:
        del self.running[one.number]
        one.news.close()
        outcome: Outcome | None = None
        learned: tuple[list[str], list[tuple[str, str]]] = ([], [])
        if not code:
            with suppress(OSError, pickle.UnpicklingError, EOFError):
                outcome, learned = pickle.loads((one.place / _PICKED_UP).read_bytes())
        if outcome is None:
            outcome = _obituary(one, code)
        shutil.rmtree(one.place, ignore_errors=True)
        if FORKS and any(learned):
            _learn(*learned)
            if one.before < LOADS and time.monotonic() - one.began < SHORT:
                self._begin(one.number, one.task, one.before + 1)
                return
        self.connection.send_bytes(pickle.dumps((one.number, outcome)))


def _spawn(task: Task, place: Path, news: Connection) -> int:
    """Begin a run in a fresh interpreter; returns its process."""
    (place / _TASK).write_bytes(pickle.dumps(task))
    os.set_inheritable(news.fileno(), True)
    code = f"import sys; sys.path[:] = {sys.path!r}; from {__name__} import spawned; spawned({str(place)!r}, {news.fileno()})"
    return os.posix_spawn(sys.executable, [sys.executable, "-c", code], os.environ, setsigdef=[signal.SIGINT])


def spawned(place: str, news: int) -> None:
    """Do the run of a fresh interpreter."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _preload()
    _be_a_run(pickle.loads((Path(place) / _TASK).read_bytes()), Path(place), Connection(news))


def _be_a_run(task: Task, place: Path, news: Connection) -> None:
    """Do a run in this child and leave."""
    try:
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        os.environ["TMPDIR"], tempfile.tempdir = str(place), None
        said = os.open(place / _SAID, os.O_WRONLY | os.O_CREAT, 0o600)
        os.dup2(said, 1)
        os.dup2(said, 2)
        from ...formulations.stop import hearing

        before, ready = set(sys.modules), set(_ready())
        with hearing(lambda _, seconds: news.send_bytes(b"stands" if math.isnan(seconds) else b"runs on")):
            outcome = run_task(task)
        data = pickle.dumps((outcome, _loaded(before, ready)))
        (place / f"{_PICKED_UP}.part").write_bytes(data)
        (place / f"{_PICKED_UP}.part").rename(place / _PICKED_UP)
        os._exit(0)
    except BaseException as fault:
        with suppress(BaseException):
            print(f"{type(fault).__name__}: {fault}", file=sys.stderr, flush=True)
        os._exit(1)


def _obituary(one: _Running, code: int) -> Outcome:
    """The outcome of a run whose process left none."""
    from ...solvers.isolation import lacked_memory

    seconds, setting = time.monotonic() - one.began, one.task.setting
    try:
        said = (one.place / _SAID).read_bytes()[-2000:].decode(errors="replace").strip()
    except OSError:
        said = ""
    if one.late:
        return lost(one.task, f"had not ended {one.task.overtime:g} s after all its limits, and was killed", "time", seconds)
    if setting.memory_limit is not None and lacked_memory(said):
        return lost(one.task, f"the memory limit of {setting.memory_limit:g} MB was reached", "memory", seconds)
    how = f"was ended by {signal.Signals(-code).name}" if code < 0 else f"ended with code {code}"
    last = f": {said.splitlines()[-1]}" if said else ""
    return lost(one.task, f"the process of the run {how}{last}", seconds=seconds)


# -- what later runs need not load again --------------------------------------------------------------------------------------


def _preload() -> None:
    """Import what every run needs, and what the registries that it asks list."""
    for name in PRELOADED:
        importlib.import_module(name)
    from ...formulations.evidence import CHECKERS
    from ...formulations.problem import PROBLEMS
    from ...heuristics.heuristic import HEURISTICS
    from ...instances.formats import FORMATS
    from ...solvers.backend import BACKENDS

    for registry in (FORMATS, PROBLEMS, HEURISTICS, BACKENDS, CHECKERS):
        registry.names()


def _loaded(before: set[str], made: set[tuple[str, str]]) -> tuple[list[str], list[tuple[str, str]]]:
    """The modules that a run has loaded, and the compiled loops that it has prepared, beyond those given, which were there before."""
    modules = [name for name in sys.modules if name not in before and name.partition(".")[0] in _INHERITED]
    return modules, [loop for loop in _ready() if loop not in made]


def _ready() -> dict[tuple[str, str], Callable[[], Any]]:
    """The compiled loops that can be called at once, each with the function that prepares it."""
    modules = [name for name in sys.modules if name.startswith("waybound.") and name.endswith("_kernels")]
    if not modules:
        return {}
    from ...formulations.kernels import kernels

    return {(module, one.__name__): one.make for module in modules for one in kernels(module) if one.made}


def _learn(modules: list[str], loops: list[tuple[str, str]]) -> None:
    """Load a finished run's modules and compiled loops here, for later runs to inherit; none is compiled for that."""
    for name in modules:
        with suppress(Exception):
            importlib.import_module(name)
    known = _ready()
    for module, name in loops:
        if (module, name) not in known:
            with suppress(Exception):
                loop = getattr(importlib.import_module(module), name)
                if loop.kept():
                    loop.make()
    gc.freeze()


def main(descriptor: int, folder: str) -> None:
    """Serve until nobody asks for runs any more."""
    ForkServer(Connection(descriptor), Path(folder)).serve()
    os._exit(0)
