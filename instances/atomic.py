"""Files that are written whole or not at all."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import IO

from .errors import InputError


@contextlib.contextmanager
def atomic_file(path: str | PathLike[str]) -> Iterator[IO[bytes]]:
    """A binary file that takes the name ``path`` only when the block ends without an exception.

    The data go to a temporary file in the same folder, which is flushed to disk and then renamed. Whatever ends the
    block early, Ctrl-C included, removes the temporary file and leaves what stood at ``path`` as it was.

    Parameters
    ----------
    path : path-like
        Where the file shall stand; a symbolic link is followed, so that the link itself survives.

    Raises
    ------
    InputError
        If ``path`` is a directory, its folder is missing, or it cannot be written.
    """
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise InputError("is a directory, not a file to write to", file=path)
    if not target.parent.is_dir():
        raise InputError(f"cannot be written: there is no folder {target.parent}", file=path)
    temporary: str | None = None
    try:
        descriptor, temporary = tempfile.mkstemp(prefix=f".{target.name[:64]}.", suffix=".part", dir=target.parent)
        with os.fdopen(descriptor, "wb") as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        Path(temporary).chmod(_mode(target))
        Path(temporary).replace(target)
        temporary = None
    except OSError as error:
        raise InputError(f"cannot be written: {error.strerror or error}", file=path) from error
    finally:
        if temporary is not None:
            Path(temporary).unlink(missing_ok=True)


def atomic_write(path: str | PathLike[str], text: str | bytes) -> None:
    """Write ``text`` (as UTF-8, line ends as they are) to ``path``, whole or not at all; see ``atomic_file``."""
    data = text.encode("utf-8") if isinstance(text, str) else text
    with atomic_file(path) as stream:
        stream.write(data)


def _mode(target: Path) -> int:
    """Permissions of the file that is replaced, or those that a new file gets (mkstemp makes private ones)."""
    with contextlib.suppress(OSError):
        return target.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
