"""Errors that a user can cause or meet, each with the exit code of the command line."""

from os import PathLike
from typing import Literal

from .printable import one_line

Code = Literal[
    "malformed", "missing", "duplicate", "unknown-name", "out-of-range", "wrong-shape", "contradiction", "ambiguous", "foreign",
    "unsupported", "too-large", "file", "missing-package", "no-answer", "search-failed", "check-failed", "internal",
]  # fmt: skip
"""Kinds of errors, for programs to branch on: a message may be reworded, its code stays. docs/errors.md explains each."""


class WayboundError(Exception):
    """Base of all waybound errors: one printable line that says what is wrong, where, and what to do.

    Attributes
    ----------
    code : str
        What is wrong, one of ``Code``.
    exit_code : int
        Exit code of the command line when this error ends a command.
    """

    code: Code = "internal"
    exit_code = 1

    def __init__(self, message: str = "", code: Code | None = None) -> None:
        super().__init__(one_line(message))
        if code is not None:
            self.code = code


class InputError(WayboundError):
    """Input that cannot be accepted.

    Parameters
    ----------
    message : str
        What is wrong, in the words of the input.
    code : str
        The same for programs.
    file : path-like, optional
        The file that was read.
    line : int, optional
        Its line, counted from 1.
    expected, found : str, optional
        What should stand there, and what stands there.
    """

    code = "malformed"
    exit_code = 2

    def __init__(
        self,
        message: str,
        code: Code | None = None,
        *,
        file: str | PathLike[str] | None = None,
        line: int | None = None,
        expected: str | None = None,
        found: str | None = None,
    ) -> None:
        self.message, self.file, self.line = message, file, line
        self.expected, self.found = expected, found
        where = ""
        if file is not None:
            where = f"{file}:{line}: " if line is not None else f"{file}: "
        elif line is not None:
            where = f"line {line}: "
        text = where + message
        if expected is not None:
            text += f"; expected {expected}"
        if found is not None:
            text += f"; found {found}"
        super().__init__(text, code)

    def at(self, file: str | PathLike[str] | None = None, line: int | None = None) -> "InputError":
        """The same error with the given file, line and so on, as far as it names none itself."""
        return InputError(
            self.message,
            self.code,
            file=self.file if self.file is not None else file,
            line=self.line if self.line is not None else line,
            expected=self.expected,
            found=self.found,
        )


class UsageError(WayboundError):
    """An option, a name or a combination of them that does not exist."""

    code: Code = "contradiction"
    exit_code = 2


class UnsupportedError(WayboundError):
    """A solver, form or heuristic was given a problem with features that it lacks.

    Parameters
    ----------
    who : str
        Name of the solver, form or heuristic.
    missing : collection of str
        The features it lacks, in the problem's words.
    others : sequence of str, optional
        Installed alternatives that have them all; heuristics, where ``nearest`` is given.
    nearest : str, optional
        Where ``who`` is none of several: the one that lacks the fewest.
    advice : str, optional
        What to do about it, where that is not to take another.
    """

    code = "unsupported"
    exit_code = 2

    def __init__(self, who: str, missing: object, others: object = (), nearest: str = "", advice: str = "") -> None:
        self.who = who
        self.missing = tuple(sorted(str(item) for item in missing))  # type: ignore[attr-defined]
        self.others = tuple(str(item) for item in others)  # type: ignore[attr-defined]
        lacking = ", ".join(self.missing)
        if nearest:
            approximated = f"; heuristics that can: {', '.join(self.others)}" if self.others else ""
            super().__init__(f"{who} can take this problem: the nearest, {nearest}, does not handle {lacking}{approximated}")
            return
        able = f"can take it: {', '.join(self.others)}" if self.others else "no installed alternative has them all"
        super().__init__(f"{who} cannot take this problem: it does not handle {lacking}; {advice or able}")


class MissingPackageError(WayboundError):
    """A package that an optional part needs is not installed."""

    code = "missing-package"
    exit_code = 2


class NoAnswerError(WayboundError):
    """The limit was reached before any verified answer was found."""

    code = "no-answer"
    exit_code = 4


class SearchFailedError(WayboundError):
    """A solver or a heuristic failed before it found any answer; its own error is the cause."""

    code = "search-failed"


class CheckFailedError(WayboundError):
    """A check failed: an answer, a bound or a solver's claim does not hold up."""

    code = "check-failed"
    exit_code = 5


def in_words(fault: BaseException) -> str:
    """One line on an exception: the message of one of ours, type and text of any other."""
    if isinstance(fault, WayboundError):
        return str(fault)
    if isinstance(fault, KeyboardInterrupt):
        return "interrupted"
    if isinstance(fault, MemoryError):
        return "out of memory"
    if isinstance(fault, OSError) and fault.strerror:
        return fault.strerror
    return " ".join(f"{type(fault).__name__}: {fault}".split())
