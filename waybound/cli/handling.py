"""The way from an error to one line on standard error and an exit code."""

import contextlib
import functools
import inspect
import sys
import warnings
from collections.abc import Callable
from typing import Any, TypeVar

import typer

from ..instances.errors import Code, InputError, SearchFailedError, WayboundError
from ..instances.printable import one_line, printable
from ..solvers import interrupts
from .options import Source

R = TypeVar("R")


def handled(command: Callable[..., R]) -> Callable[..., R]:
    """``command``, with errors as one line on standard error and the exit code that belongs to them, and a ``Source`` as its options."""
    signature = inspect.signature(command, eval_str=True)
    of_source = inspect.signature(Source, eval_str=True).parameters
    source = next((name for name, p in signature.parameters.items() if p.annotation is Source), None)
    shown = [p for name, own in signature.parameters.items() for p in (of_source.values() if name == source else [own])]

    def traced(cause: BaseException | None, verbose: bool) -> str:
        """Shows where an error of the program or of a solver comes from if that is asked for, and else says how to ask."""
        if cause is not None and verbose:
            import traceback

            lines = "".join(traceback.format_exception(cause)).splitlines()
            print("\n".join(printable(line) for line in lines), file=sys.stderr)
        return "" if cause is None or verbose else "; run again with -v for the traceback"

    @functools.wraps(command)
    def run(**options: Any) -> R:
        from . import output

        def interrupted() -> typer.Exit:
            complain("interrupted")
            return typer.Exit(interrupts.exit_code())

        def failed(error: BaseException, message: str, code: int) -> typer.Exit:
            complain(message)
            if options.get("json") and not output.begun:
                print_failure(message, code, error)
            return typer.Exit(code)

        output.begun = False
        if source is not None:
            options[source] = Source(**{name: options.pop(name) for name in of_source})
        try:
            with warnings.catch_warnings():
                warnings.showwarning = lambda message, *_, **__: remark(str(message))  # of whatever package: one line, and no source
                return command(**options)
        except WayboundError as error:
            cause = error.__cause__ if isinstance(error, SearchFailedError) else None
            raise failed(error, f"{error}{traced(cause, bool(options.get('verbose')))}", error.exit_code) from None
        except KeyboardInterrupt:
            raise interrupted() from None
        except (BrokenPipeError, typer.Exit, typer.Abort):
            raise
        except MemoryError as error:
            raise failed(error, f"not enough memory for this{f': {error}' if str(error) else ''}", 4) from None
        except Exception as error:
            if _from_an_interrupt(error):
                raise interrupted() from None
            traceback = traced(error, bool(options.get("verbose")))
            raise failed(error, f"internal error: {type(error).__name__}: {error}{traceback}", 1) from None

    run.__signature__ = signature.replace(parameters=[p.replace(kind=p.KEYWORD_ONLY) for p in shown])  # type: ignore[attr-defined]
    run.__annotations__ = {p.name: p.annotation for p in shown}
    return run


def _from_an_interrupt(error: BaseException | None) -> bool:
    """True if an interrupt began what ended as this error: Python itself makes others of one, where a class is being made."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None


def print_failure(message: str, code: int, error: BaseException | None = None) -> None:
    """The one object that ``--json`` promises where a command fails (docs/errors.md)."""
    from .output import print_json

    place = {"file": str(error.file), "line": error.line} if isinstance(error, InputError) and error.file is not None else {}
    failure = {"error": one_line(message), "code": code, "error_code": _error_code(error), **place}
    with contextlib.suppress(InputError):  # standard output cannot be written to
        print_json({key: value for key, value in failure.items() if value is not None})


_OF_THE_PARSER: dict[str, Code] = {"NoSuchOption": "unknown-name", "NoSuchCommand": "unknown-name", "MissingParameter": "missing"}


def _error_code(error: BaseException | None) -> Code:
    if isinstance(error, WayboundError):
        return error.code
    if isinstance(error, MemoryError):
        return "too-large"
    if hasattr(error, "format_message"):  # the parser's own
        return _OF_THE_PARSER.get(type(error).__name__, "malformed")
    return "internal"


def nothing_found() -> int:
    """The exit code where nothing was found out, within the limit or before a signal came."""
    return interrupts.exit_code() if interrupts.received else 4


def complain(message: str) -> None:
    """One line ``error: ...`` on standard error."""
    _say(f"error: {one_line(message)}")


def remark(message: str) -> None:
    """One line ``note: ...`` on standard error."""
    _say(f"note: {one_line(message)}")


def _say(line: str) -> None:
    try:
        typer.echo(line, err=True)
    except OSError:  # nobody can read it, which must not cost the answer
        from .output import silence

        silence(sys.stderr)
