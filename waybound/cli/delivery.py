"""Handing over what a search brought: every output is tried, whatever becomes of the others, and what could not be written is said."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable
from pathlib import Path

from ..instances.errors import InputError, WayboundError, in_words
from .options import complain
from .output import write_out


class Delivery:
    """Writes files and standard output, one after the other.

    Attributes
    ----------
    code : int
        Exit code of the first output that could not be written, 0 if all could: 2 where the system refuses, 130 after an interrupt, 1 for
        a fault of ours.
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
