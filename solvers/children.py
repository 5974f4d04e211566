"""Processes and folders that must not outlive this one, however it ends."""

from __future__ import annotations

import atexit
import shutil
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_lock = threading.Lock()
_living: dict[subprocess.Popen[bytes], Path | None] = {}


@contextmanager
def watched(process: subprocess.Popen[bytes], folder: Path | None = None) -> Iterator[None]:
    """Within this block ``end_all`` ends ``process`` and removes ``folder``."""
    with _lock:
        _living[process] = folder
    try:
        yield
    finally:
        with _lock:
            _living.pop(process, None)


def end_all() -> None:
    """End every watched process; called when the interpreter ends."""
    with _lock:
        left = list(_living.items())
        _living.clear()
    for process, folder in left:
        with suppress(OSError):
            process.kill()
            process.wait(5)
        if folder is not None:
            shutil.rmtree(folder, ignore_errors=True)


atexit.register(end_all)
