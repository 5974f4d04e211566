"""Processes and folders that must not outlive this one, however it ends.

Each child runs in a process group that a small shell leads. The shell waits at a pipe of which this process alone holds the other end:
when it closes, be it that we were killed, the shell ends the group and removes the child's folder.
"""

import atexit
import fcntl
import os
import shutil
import signal
import subprocess
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any

PREFIX = "waybound-"
"""How the names of our folders begin."""

LOCK = "in-use"
"""File in each of them, locked while its maker lives."""

UNLOCKED = "in-use.new"
"""The same file until it is locked: a sweep could lock it first, and remove the folder of a living maker."""

YOUNG = 60.0
"""Seconds within which a folder without a locked file may be one that is being made."""

_GUARD = """trap '' HUP INT QUIT TERM
read -r _
kill -TERM 0
test -n "$1" && rm -rf -- "$1"
kill -KILL 0"""
"""Ends its own group; TERM first, because it could not remove a folder after it has killed itself."""

_lock = threading.Lock()
_living: "dict[_Guard, subprocess.Popen[bytes] | None]" = {}
_folders: set[Path] = set()


class _Guard:
    """The leader of a process group, which ends the group when this process does."""

    def __init__(self, folder: Path | None) -> None:
        self.process = subprocess.Popen(
            ["/bin/sh", "-c", _GUARD, "waybound-guard", "" if folder is None else str(folder)],
            stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, process_group=0,
        )  # fmt: skip

    def end(self) -> None:
        """End the whole group."""
        if self.process.returncode is None:
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        assert self.process.stdin is not None
        with suppress(OSError):
            self.process.stdin.close()


@contextmanager
def child(command: Sequence[str], folder: Path | None = None, **given: Any) -> Iterator[subprocess.Popen[bytes]]:
    """A process that ends with this block, and with this process at the latest, together with all that it has started.

    Its process group is not the terminal's, so that Ctrl-C reaches the parent alone.

    ``folder``: removed when this process ends before the block does; see ``scratch``. ``given`` is for ``subprocess.Popen``.
    """
    guard = _Guard(folder)
    with _lock:
        _living[guard] = None
    process = None
    try:
        process = subprocess.Popen(command, process_group=guard.process.pid, **given)
        with _lock:
            _living[guard] = process
        yield process
    finally:
        with _lock:
            _living.pop(guard, None)
        guard.end()
        if process is not None:
            process.wait()


@contextmanager
def scratch() -> Iterator[Path]:
    """A folder for temporary files that is removed after the block; folders left by dead processes are removed first."""
    _sweep()
    folder = Path(tempfile.mkdtemp(prefix=PREFIX))
    with _lock:
        _folders.add(folder)
    try:
        with (folder / UNLOCKED).open("wb") as file:
            _locked(file)
            (folder / UNLOCKED).rename(folder / LOCK)
            yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        with _lock:
            _folders.discard(folder)


def _locked(file: IO[bytes]) -> bool:
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _sweep() -> None:
    """Remove folders of ours whose makers are dead."""
    for folder in Path(tempfile.gettempdir()).glob(f"{PREFIX}*"):
        with suppress(OSError):
            if not folder.is_dir() or folder.is_symlink() or folder.stat().st_uid != os.getuid():
                continue
            if not (folder / LOCK).exists():
                if time.time() - folder.stat().st_mtime > YOUNG and {path.name for path in folder.iterdir()} <= {UNLOCKED}:
                    shutil.rmtree(folder, ignore_errors=True)
                continue
            with (folder / LOCK).open("rb") as file:
                if _locked(file):
                    shutil.rmtree(folder, ignore_errors=True)


def end_all() -> None:
    """End every child and remove every folder; called when the interpreter ends."""
    with _lock:
        guards, folders = list(_living.items()), list(_folders)
        _living.clear()
        _folders.clear()
    for guard, process in guards:
        guard.end()
        if process is not None:
            with suppress(OSError, subprocess.TimeoutExpired):
                process.wait(1.0)
    for folder in folders:
        shutil.rmtree(folder, ignore_errors=True)


atexit.register(end_all)
