"""Files that a command writes: refused beforehand where they could not be written, and each tried, whatever becomes of the others."""

import os
import sys
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path

from ..instances.errors import InputError, MissingPackageError, UsageError, WayboundError, in_words
from .handling import complain
from .output import write_out

PLOT_SUFFIXES, PAGE_SUFFIXES = (".png", ".svg", ".pdf"), (".html", ".htm")


def output_path(option: str, path: Path | None, suffixes: Sequence[str] = (), *, unlike: Sequence[str] = ()) -> None:
    """Raise UsageError, before anything is run, if a file could not be written to ``path`` later.

    ``suffixes`` are those allowed, all if empty; ``unlike`` are inputs, which must not be overwritten.
    """
    if path is None:
        return
    if suffixes and path.suffix.lower() not in suffixes:
        raise UsageError(f"{option} {path}: the suffix must be one of {', '.join(suffixes)}", "unsupported")
    from ..instances.atomic import check_writable

    try:
        check_writable(path)
    except InputError as fault:
        raise UsageError(f"{option} {fault}", fault.code) from None
    if path.exists() and any(os.path.exists(file) and path.samefile(file) for file in unlike):  # noqa: PTH110 - a name may be too long
        raise UsageError(f"{option} {path} would overwrite the input")


def distinct_paths(**options: Path | None) -> None:
    """Raise UsageError if two outputs go to one file."""
    seen: dict[Path, str] = {}
    for name, path in options.items():
        if path is not None:
            real = Path(os.path.realpath(path))
            if real in seen:
                raise UsageError(f"--{seen[real]} and --{name} name the same file {path}")
            seen[real] = name


def check_outputs(unlike: Sequence[str], log: str | None = None, **outputs: tuple[Path | None, Sequence[str]]) -> None:
    """Raise UsageError if an output, by option with the suffixes it may have, or the log could not be written, over an input or another."""
    distinct_paths(**{name: path for name, (path, _) in outputs.items()})
    for name, (path, suffixes) in outputs.items():
        output_path(f"--{name}", path, suffixes, unlike=unlike)
    if log is not None and log != "-":
        output_path("--log", Path(log), unlike=unlike)
        if any(path is not None and os.path.realpath(path) == os.path.realpath(log) for path, _ in outputs.values()):
            raise UsageError(f"--log {log} names the file of another output")


def check_matplotlib(option: str = "--plot") -> None:
    """Raise MissingPackageError where pictures cannot be drawn."""
    from importlib.util import find_spec

    if find_spec("matplotlib") is None:
        raise MissingPackageError(f"{option} needs the package matplotlib: pip install matplotlib")


class Delivery:
    """Writes files and standard output, one after the other.

    ``code`` is the exit code of the first output that could not be written, 0 if all could: 2 where the system refuses, 130 after an
    interrupt, 1 for a fault of ours.
    """

    def __init__(self, verbose: bool = False) -> None:
        self.code = 0
        self._shown = False
        self._verbose = verbose

    def file(self, option: str, path: Path | None, write: Callable[[Path], None]) -> None:
        """Let ``write`` make the file ``path`` that ``option`` asks for, if it does."""
        if path is None:
            return

        def failed(fault: BaseException) -> None:
            named = isinstance(fault, InputError) and fault.file is not None
            self._failed(fault, f"{option} {fault}" if named else f"{option} {path}: cannot be written: {in_words(fault)}")

        self._attempt(lambda: write(path), failed)

    def show(self, render: Callable[[], str], otherwise: Callable[[], str]) -> None:
        """Put on standard output, once, what ``render`` makes, or else ``otherwise``, the least that must not be lost."""
        text: list[str] = []

        def failed(fault: BaseException) -> None:
            self._failed(fault, f"what is to be shown cannot be made, so the answer follows as it is: {in_words(fault)}")

        if not self._shown:
            self._attempt(lambda: text.append(render()), failed)
            self._print(text[0] if text else otherwise())

    def _print(self, text: str) -> None:
        try:
            self._shown = True
            write_out(text)
        except (Exception, KeyboardInterrupt) as fault:  # not begun anew: half of it may be out
            self._failed(fault, in_words(fault) if isinstance(fault, WayboundError) else f"printing failed: {in_words(fault)}")

    @staticmethod
    def _attempt(act: Callable[[], object], failed: Callable[[BaseException], None]) -> None:
        """Do it, once more after Ctrl-C, which asks for an end and not for the loss of an answer; a second one is heeded."""
        for last in (False, True):
            try:
                act()
                return
            except KeyboardInterrupt as fault:
                if last:
                    failed(fault)
            except Exception as fault:
                failed(fault)
                return

    def _failed(self, fault: BaseException, message: str) -> None:
        if self._verbose and not isinstance(fault, WayboundError):
            traceback.print_exception(fault, file=sys.stderr)
        complain(message)
        own = fault.exit_code if isinstance(fault, WayboundError) else 130 if isinstance(fault, KeyboardInterrupt) else 1
        self.code = self.code or own
