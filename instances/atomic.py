"""Files that are written whole or not at all."""

import contextlib
import os
import secrets
import stat
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import IO

from .errors import InputError

_BLOCK = 4096
"""Bytes that a disk must still take for a search to begin."""


@contextlib.contextmanager
def atomic_file(path: str | PathLike[str]) -> Iterator[IO[bytes]]:
    """A binary file that takes the name ``path`` only when the block ends without an exception.

    The data go to a temporary file in the same folder, which is flushed to disk and then renamed. Whatever ends the block early, Ctrl-C
    included, leaves what stood at ``path``. A symbolic link is followed and survives; a device or a pipe is written to as it is. Raises
    InputError for a directory, a missing folder, and a file that cannot be written.
    """
    target = _target(path)
    temporary = None if target is None else _beside(target)
    try:
        if temporary is None or target is None:
            with Path(path).open("wb") as stream:
                yield stream
            return
        with open(temporary, "xb", opener=_private) as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        temporary.chmod(_mode(target))
        temporary.replace(target)
    except OSError as error:
        raise _unwritable(path, error) from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def atomic_write(path: str | PathLike[str], text: str | bytes) -> None:
    """Write ``text`` (as UTF-8, line ends as they are) to ``path``, whole or not at all; see ``atomic_file``."""
    data = text.encode("utf-8") if isinstance(text, str) else text
    with atomic_file(path) as stream:
        stream.write(data)


def check_writable(path: str | PathLike[str]) -> None:
    """Raise InputError, before hours of work, if ``atomic_file`` could not write: it tries with a small file beside ``path``."""
    target = _target(path)
    if target is None:
        return
    temporary = _beside(target)
    try:
        try:
            with open(temporary, "xb", opener=_private) as stream:
                stream.write(bytes(_BLOCK))
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        raise _unwritable(path, error) from error


def _target(path: str | PathLike[str]) -> Path | None:
    """The file that ``path`` leads to; None where that is a device or a pipe, which no file must replace."""
    target = Path(os.path.realpath(path))
    try:
        mode = Path(path).stat().st_mode  # not of target: /dev/stdout leads to a pipe, which has no path
    except (FileNotFoundError, NotADirectoryError):
        if not target.parent.is_dir():
            raise InputError(f"cannot be written: there is no folder {target.parent}", "file", file=path) from None
        return target
    except OSError as error:
        raise _unwritable(path, error) from error
    if stat.S_ISDIR(mode):
        raise InputError("is a directory, not a file to write to", "file", file=path)
    return target if stat.S_ISREG(mode) else None


def _beside(target: Path) -> Path:
    """A name for a temporary file in the folder of ``target``, known before the file is there, so that an interrupt leaves none.

    Names may have 255 bytes, and a character four.
    """
    return target.with_name(f".{target.name[:48]}.{secrets.token_hex(8)}.part")


def _private(path: str, flags: int) -> int:
    return os.open(path, flags, 0o600)


def _unwritable(path: str | PathLike[str], error: OSError) -> InputError:
    return InputError(f"cannot be written: {error.strerror or error}", "file", file=path)


def _mode(target: Path) -> int:
    """Permissions of the file that is replaced, or those that a new file gets (a temporary one is private)."""
    with contextlib.suppress(OSError):
        return target.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
