"""Any backend in a process of its own: hard limits on time and memory, and a crash that costs one solve only.

The child is a fresh interpreter that runs nothing of the caller's program, in a process group of its own, so that a terminal's
Ctrl-C reaches the parent alone. Incumbents come through a pipe as they are found, and outlive the child. What it starts and what it
writes to the folder for temporary files ends with it.
"""

import importlib
import math
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import nullcontext, suppress
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection, Pipe
from pathlib import Path
from typing import IO, Any

from ..formulations.evidence import Evidence
from ..formulations.problem import Problem
from ..formulations.programs.program import Program
from ..formulations.stop import hearing, off_the_clock, tell
from ..instances import errors
from ..instances.errors import UsageError, WayboundError
from .backend import Control, Options, RawResult, SolverWork
from .children import child, scratch
from .interrupts import CHILD_GRACE

OVERTIME = 0.5
"""Seconds past its time limit after which a child is asked to stop: with its start, and ``GRACE``, two seconds."""

GRACE = CHILD_GRACE
"""Seconds between asking a child to stop and ending it."""

STARTUP = 60.0
"""Seconds within which a child must have begun its search."""

_MEGABYTE = 2**20
_TICK = 0.05


def run_isolated(solver: str, target: Problem | Program, options: Options, control: Control) -> RawResult:
    """Run a solver in a process of its own; see ``run_in_process``."""
    return run_in_process(SolverWork(solver, target, options), options, control)


def run_in_process(work: Any, options: Options, control: Control, *, aside: bool = False) -> RawResult:
    """Run ``work(control)``, which can be pickled, in a process of its own.

    Returns the result of ``work``; after a crash, a kill or a lack of memory one made from the incumbents it had published, or of status
    ``error`` if there are none and nobody asked for its end. Raises what it raised about its input or options, and UsageError if the
    problem cannot be sent to another process.

    ``work`` may have ``modules``, names of what is loaded, and ``prepare()``, done before time and memory are counted, as a library's own
    size is nobody's choice; ``memory_limit`` counts megabytes on top of that, and is kept on Linux only. ``aside`` says that something else
    goes on meanwhile, whose deadlines come nearer while this process starts; else they do not.
    """
    payload = _payload(work, options)
    mine, theirs = Pipe()
    code = f"import sys; sys.path[:] = {sys.path!r}; from waybound.solvers.isolation import serve; serve({theirs.fileno()})"
    with mine, tempfile.TemporaryFile() as output, scratch() as folder, child(
        [sys.executable, "-c", code], folder, stdin=subprocess.DEVNULL, stdout=output, stderr=output, pass_fds=[theirs.fileno()],
        env={**os.environ, "TMPDIR": str(folder)},
    ) as process:  # fmt: skip
        theirs.close()
        return _Child(process, mine, payload, options, control, output).watch(aside)


def _payload(work: Any, options: Options) -> bytes:
    try:
        return pickle.dumps((work, options))
    except (pickle.PicklingError, TypeError, AttributeError) as fault:
        raise UsageError(f"this problem cannot be sent to a process of its own: {fault}", "unsupported") from None


class _Child:
    """The parent's end of a child process."""

    def __init__(
        self, process: subprocess.Popen[bytes], mine: Connection, payload: bytes, options: Options, control: Control, output: IO[bytes]
    ) -> None:
        self.process, self.mine, self.options, self.control, self.output = process, mine, options, control, output
        self.began = time.perf_counter()
        self.searching: float | None = None
        self.asked: float | None = None
        self.late = False
        self.standing = 0
        with suppress(BrokenPipeError, ConnectionResetError):  # it died at once; ``watch`` tells how
            self.mine.send_bytes(payload)

    def watch(self, aside: bool = False) -> RawResult:
        """Handle the child's messages until it is done or dead."""
        last: RawResult | None = None
        with nullcontext() if aside else off_the_clock():
            while last is None and self.searching is None:
                last = self._step()
        while last is None:
            last = self._step()
        return last

    def _step(self) -> RawResult | None:
        """Wait for a moment; the result, once there is one. A child that reports often is overdue like any other."""
        try:
            if self.mine.poll(_TICK) and (last := self._take(pickle.loads(self.mine.recv_bytes()))) is not None:
                return last
        except (EOFError, ConnectionResetError):
            return self._obituary()
        if self._overdue():
            return self._from_incumbents(f"the solver did not stop when asked and was ended{self.control.left}")
        return None

    def _take(self, message: "_Message") -> RawResult | None:
        if message.kind == "searching":
            self.searching = time.perf_counter()
        elif message.kind == "set-up":
            if message.value is None:
                self.control.begin_set_up()
            else:
                self.control.end_set_up(message.value)
        elif message.kind == "off the clock":
            self._stands(*message.value)
        elif message.kind == "incumbent":
            *found, nodes, counts = message.value
            if nodes is not None:
                self.control.count(nodes, **counts)
            self.control.publish(*found)
        elif message.kind == "done":
            result = message.value
            assert isinstance(result, RawResult)
            return result
        elif message.kind == "refused":
            name, text, code = message.value
            kind = getattr(errors, name, WayboundError)
            fault = kind.__new__(kind)
            fault.args, fault.code = (text,), code
            raise fault
        elif message.kind == "memory":
            return self._from_incumbents(f"the memory limit of {self.options.memory_limit:g} MB was reached", "memory")
        elif message.kind == "failed":
            return self._from_incumbents(f"the solver failed: {message.value}")
        return None

    def _stands(self, what: str, seconds: float) -> None:
        """Note that the child's clock stands still, or runs again after so many seconds."""
        tell(what, seconds)
        self.standing += 1 if math.isnan(seconds) else -1
        if not self.standing and self.searching is not None:
            self.searching += seconds

    def _overdue(self) -> bool:
        """Ask the child to stop when its time is over; whether its grace is over, too."""
        now = time.perf_counter()
        if self.asked is None:
            since = self.began + STARTUP if self.searching is None else self.searching + self.options.time_limit + OVERTIME
            self.late = now > since and not self.standing
            if self.control.stopped or self.late:
                self.asked = now
                try:
                    self.mine.send_bytes(b"stop")
                except (BrokenPipeError, ConnectionResetError):
                    return False
        return self.asked is not None and now > self.asked + GRACE

    def _obituary(self) -> RawResult:
        """Message about a child that ended without a result."""
        code = self.process.wait()
        self.output.seek(0)
        text = self.output.read()[-2000:].decode(errors="replace").strip()
        last = text.splitlines()[-1] if text else ""
        limit = self.options.memory_limit
        if limit is not None and lacked_memory(text):
            return self._from_incumbents(f"the memory limit of {limit:g} MB was reached: {last}", "memory")
        how = f"was ended by {signal.Signals(-code).name}" if code < 0 else f"ended with code {code}"
        return self._from_incumbents(f"the solver's process {how}" + (f": {last}" if last else ""))

    def _from_incumbents(self, message: str, limit: str = "none") -> RawResult:
        stopped, control = self.control.stopped, self.control
        if stopped:
            limit = "interrupt"
        elif self.late:
            limit = "time"
        status = "feasible" if control.answer is not None else "error" if limit == "none" else "unknown"
        return RawResult(status, limit, control.answer, control.objective, control.bound, message=message, evidence=control.evidence)


@dataclass(frozen=True)
class _Message:
    """A message of the child: ``searching, off the clock, set-up, incumbent, done, refused, memory`` or ``failed``."""

    kind: str
    value: Any = None


class _Relay(Control):
    """The child's ``Control``: what is published goes to the parent."""

    def __init__(self, connection: Connection) -> None:
        super().__init__()
        self._connection = connection
        self._sending = threading.Lock()

    def send(self, kind: str, value: Any = None) -> None:
        with self._sending:
            self._connection.send_bytes(pickle.dumps(_Message(kind, value)))

    def publish(
        self, answer: Any = None, objective: float | None = None, bound: float | None = None, evidence: tuple[Evidence, ...] = ()
    ) -> None:
        super().publish(answer, objective, bound, evidence)
        self.send("incumbent", (answer, objective, bound, evidence, self.nodes, self.counts))

    def begin_set_up(self) -> None:
        super().begin_set_up()
        self.send("set-up")

    def end_set_up(self, seconds: float) -> None:
        if self.setting_up:
            super().end_set_up(seconds)
            self.send("set-up", seconds)

    def listen(self) -> None:
        """Wait for the parent's wish to stop, or for its end."""
        try:
            self._connection.recv_bytes()
        except (EOFError, OSError):
            os._exit(1)
        self.stop()


def serve(descriptor: int) -> None:
    """Child: read a task from the pipe, run it, and leave without ceremony."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    connection = Connection(descriptor)
    relay = _Relay(connection)
    work, options = pickle.loads(connection.recv_bytes())
    threading.Thread(target=relay.listen, daemon=True).start()
    try:
        for module in work.modules:
            importlib.import_module(module)
        if hasattr(work, "prepare"):
            work.prepare()
        enforced = options.memory_limit is None or limit_memory(options.memory_limit)
        relay.send("searching")
        with hearing(lambda what, seconds: relay.send("off the clock", (what, seconds))):
            result = work(relay)
        if not enforced:
            result = replace(result, statistics={**result.statistics, "memory_limit": "not enforced on this system"})
        relay.send("done", result)
    except WayboundError as fault:
        relay.send("refused", (type(fault).__name__, str(fault), fault.code))
    except MemoryError:
        relay.send("memory")
    except Exception as fault:
        text = f"{type(fault).__name__}: {fault}"
        if options.memory_limit is not None and lacked_memory(text):
            relay.send("memory")
        else:
            relay.send("failed", text)
    sys.stdout.flush()
    os._exit(0)


def lacked_memory(said: str) -> bool:
    """Whether the last output is that of a process that ran out of memory, such as a library that could not be loaded."""
    return any(
        word in said for word in ("bad_alloc", "MemoryError", "annot allocate", "out of memory", "failed to map segment", "SystemError")
    )


def limit_memory(megabytes: float) -> bool:
    """Limit the address space of this process to what it is now plus ``megabytes``; whether the system keeps such a limit."""
    import resource

    pages = Path("/proc/self/statm")
    if not pages.exists():
        return False
    now = int(pages.read_text().split()[0]) * resource.getpagesize()
    most = now + int(megabytes * _MEGABYTE)
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    if hard != resource.RLIM_INFINITY:
        most = min(most, hard)
    resource.setrlimit(resource.RLIMIT_AS, (most, hard))
    return True
